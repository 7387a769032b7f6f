// Transfinite interpolation with blending by arc length (W. J. Gordon and C. A. Hall,
// "Construction of curvilinear co-ordinate systems", 1973; B. K. Soni, "Two- and three-dimensional
// grid generation for internal flow applications", 1985), in the plane of a face.

#include "io/cad/face_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace vdb_offset::cad {
namespace {

bool is_one_point(const Border& border) {
  return std::ranges::all_of(border.world,
                             [&](const Vec3& p) { return p == border.world.front(); });
}

/// Parts of the way along two lines across from each other; a point takes the other's.
std::array<std::vector<double>, 2> paired_parts(const Border& a, const Border& b) {
  if (is_one_point(a)) return {b.parts(), b.parts()};
  if (is_one_point(b)) return {a.parts(), a.parts()};
  return {a.parts(), b.parts()};
}

struct Weights {
  double along_i, along_j;
};

/// Where straight lines between the sides' parts cross.
Weights crossing(double bottom, double top, double left, double right) {
  const double below = 1 - (top - bottom) * (right - left);
  return {(bottom + left * (top - bottom)) / below, (left + bottom * (right - left)) / below};
}

struct Around {
  Vec2 bottom, right, top, left;
};

Vec2 mix(const Borders& borders, const Around& at, const Weights& w) {
  const double i = w.along_i;
  const double j = w.along_j;
  const Vec2 corners = (1 - i) * (1 - j) * borders.bottom.flat.front() +
                       i * (1 - j) * borders.bottom.flat.back() +
                       (1 - i) * j * borders.top.flat.front() + i * j * borders.top.flat.back();
  return (1 - j) * at.bottom + j * at.top + (1 - i) * at.left + i * at.right - corners;
}

/// A grid and where its points lie in the plane.
struct Grid {
  Patch patch;
  std::vector<Vec2> flat;
};

/// The points of a side's poles become those of the lines that end there.
void close_corners(Borders& b) {
  const auto fill = [](Border& line, const Vec3& point) {
    if (is_one_point(line)) std::ranges::fill(line.world, point);
  };
  fill(b.left, b.bottom.world.front());
  fill(b.right, b.bottom.world.back());
  fill(b.bottom, b.left.world.front());
  fill(b.top, b.left.world.back());
}

Grid fill(const Face& face, Borders b) {
  close_corners(b);
  const auto ni = b.bottom.flat.size();
  const auto nj = b.left.flat.size();
  Grid grid;
  grid.patch.ni = static_cast<int>(ni);
  grid.patch.nj = static_cast<int>(nj);
  const auto along_i = paired_parts(b.bottom, b.top);
  const auto along_j = paired_parts(b.left, b.right);
  for (std::size_t j = 0; j < nj; ++j) {
    for (std::size_t i = 0; i < ni; ++i) {
      const Weights w = crossing(along_i[0][i], along_i[1][i], along_j[0][j], along_j[1][j]);
      grid.flat.push_back(
          mix(b, {b.bottom.flat[i], b.right.flat[j], b.top.flat[i], b.left.flat[j]}, w));
      grid.patch.points_world.push_back(j == 0        ? b.bottom.world[i]
                                        : j + 1 == nj ? b.top.world[i]
                                        : i == 0      ? b.left.world[j]
                                        : i + 1 == ni ? b.right.world[j]
                                                      : face.plane.point_world(grid.flat.back()));
    }
  }
  return grid;
}

/// Whether a cell's corners all face where its diagonals say, and that where the face does.
bool is_sound(const Face& face, const Grid& grid, const std::array<int, 4>& cell) {
  std::array<Vec3, 4> at;
  Vec2 middle = Vec2::Zero();
  for (std::size_t c = 0; c < 4; ++c) {
    at[c] = grid.patch.points_world[static_cast<std::size_t>(cell[c])];
    middle += grid.flat[static_cast<std::size_t>(cell[c])] / 4;
  }
  const Vec3 up = (at[2] - at[0]).cross(at[3] - at[1]);
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 next = at[(c + 1) % 4] - at[c];
    const Vec3 last = at[(c + 3) % 4] - at[c];
    if (next.isZero(0) || last.isZero(0)) continue;  // beside a pole
    if (!(next.cross(last).dot(up) > 0)) return false;
  }
  return up.dot(face.plane.normal(middle)) > 0;
}

bool is_sound(const Face& face, const Grid& grid) {
  bool sound = true;
  for_cells(grid.patch,
            [&](const std::array<int, 4>& cell) { sound = sound && is_sound(face, grid, cell); });
  return sound;
}

/// Where Winslow's equations (A. M. Winslow, "Numerical solution of the quasilinear Poisson
/// equation in a nonuniform triangle mesh", 1966) put a point, given its neighbours.
Vec3 winslow(const Patch& p, int i, int j) {
  const Vec3 along_i = (p.at(i + 1, j) - p.at(i - 1, j)) / 2;
  const Vec3 along_j = (p.at(i, j + 1) - p.at(i, j - 1)) / 2;
  const Vec3 cross =
      (p.at(i + 1, j + 1) - p.at(i - 1, j + 1) - p.at(i + 1, j - 1) + p.at(i - 1, j - 1)) / 4;
  const double alpha = along_j.squaredNorm();
  const double gamma = along_i.squaredNorm();
  const Vec3 sum = alpha * (p.at(i + 1, j) + p.at(i - 1, j)) +
                   gamma * (p.at(i, j + 1) + p.at(i, j - 1)) - 2 * along_i.dot(along_j) * cross;
  return sum / std::max(2 * (alpha + gamma), 1e-300);
}

/// Moves the points within, along the surface, until grid lines bend round re-entrant sides.
void relax(const Face& face, Grid& grid) {
  constexpr int kRounds = 200;
  Patch& patch = grid.patch;
  for (int round = 0; round < kRounds; ++round) {
    for (int j = 1; j + 1 < patch.nj; ++j) {
      for (int i = 1; i + 1 < patch.ni; ++i) {
        Vec2& flat = grid.flat[static_cast<std::size_t>(j * patch.ni + i)];
        flat = face.plane.step_towards(winslow(patch, i, j), flat);
        patch.at(i, j) = face.plane.point_world(flat);
      }
    }
  }
}

/// i and j change places.
Patch turned(const Patch& patch) {
  Patch out;
  out.ni = patch.nj;
  out.nj = patch.ni;
  for (int j = 0; j < out.nj; ++j) {
    for (int i = 0; i < out.ni; ++i) out.points_world.push_back(patch.at(j, i));
  }
  return out;
}

Borders quad_borders(const Face& face, const Plan& plan, const SharedEdges& edges) {
  const auto& sides = plan.sides;
  const auto cells = [&](std::size_t a, std::size_t b) {
    const int most = std::max(cells_of(sides[a], edges), cells_of(sides[b], edges));
    return static_cast<std::size_t>(most > 0 ? most : plan.pole_cells);
  };
  return {face.nodes(sides[0], edges, cells(0, 2)), face.nodes(sides[1], edges, cells(1, 3)),
          face.nodes(sides[2], edges, cells(0, 2)).reversed(),
          face.nodes(sides[3], edges, cells(1, 3)).reversed()};
}

Borders wedge_borders(const Face& face, const Plan& plan, const SharedEdges& edges) {
  const Border bottom = face.nodes(plan.sides[0], edges);
  const Border right = face.nodes(plan.sides[1], edges);
  const Border top = face.nodes(plan.sides[2], edges).reversed();
  Border left = face.straight(bottom, 0, top, 0, right.cells());
  std::ranges::fill(left.world, bottom.world.front());
  return {bottom, right, top, left};
}

/// The inner loop of a ring begins where it is nearest to the outer one's first point.
Borders ring_borders(const Face& face, const Plan& plan, const SharedEdges& edges) {
  const Border outer = face.nodes(plan.sides[0], edges);
  Border inner = face.nodes(plan.sides[1], edges).reversed();
  const auto nearest = std::ranges::min_element(
      inner.flat, {}, [&](const Vec2& p) { return (p - outer.flat.front()).norm(); });
  const auto start = static_cast<std::size_t>(nearest - inner.flat.begin());
  if (start > 0 && start + 1 < inner.flat.size()) {
    Border turned_round = inner.part(start, inner.cells());
    turned_round.append(inner.part(0, start));
    inner = turned_round;
  }
  double step = 0;
  for (std::size_t k = 1; k < outer.world.size(); ++k) {
    step += (outer.world[k] - outer.world[k - 1]).norm() / double(outer.cells());
  }
  const double way = (inner.flat.front() - outer.flat.front()).norm();
  const auto cells = static_cast<std::size_t>(std::clamp(std::ceil(way / step), 1.0, 1e4));
  const Border cut = face.straight(outer, 0, inner, 0, cells);
  return {outer, cut, inner, cut};
}

Border point_at(const Face& face, const Vec2& flat) {
  return {{flat}, {face.plane.point_world(flat)}};
}

std::vector<Borders> midpoint_borders(const Face& face, const Plan& plan,
                                      const SharedEdges& edges) {
  const std::size_t count = plan.sides.size();
  std::vector<Border> sides;
  std::vector<std::size_t> cut;
  Vec2 middle = Vec2::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    sides.push_back(face.nodes(plan.sides[k], edges));
    cut.push_back(static_cast<std::size_t>(cells_before_cut(plan, k, edges)));
    middle += sides[k].flat[cut[k]] / double(count);
  }
  const Border centre = point_at(face, middle);
  // From each cut to the middle: as many cells as the next side has before its cut.
  std::vector<Border> spokes;
  for (std::size_t k = 0; k < count; ++k) {
    spokes.push_back(face.straight(sides[k], cut[k], centre, 0, cut[(k + 1) % count]));
  }
  std::vector<Borders> all;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    all.push_back({sides[k].part(cut[k], sides[k].cells()), sides[next].part(0, cut[next]),
                   spokes[next].reversed(), spokes[k]});
  }
  return all;
}

std::vector<Borders> disc_borders(const Face& face, const Plan& plan, const SharedEdges& edges) {
  const Border loop = face.nodes(plan.sides[0], edges);
  const std::size_t cells = loop.cells();
  const std::size_t quarter = (cells + 2) / 4;
  const std::array<std::size_t, 5> corner{0, quarter, cells / 2, cells / 2 + quarter, cells};
  Vec2 middle = Vec2::Zero();
  double step = 0;
  for (std::size_t k = 0; k < cells; ++k) {
    middle += loop.flat[k] / double(cells);
    step += (loop.world[k + 1] - loop.world[k]).norm() / double(cells);
  }
  double radius = 0;
  std::vector<Border> inner;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 out = loop.flat[corner[k]] - middle;
    radius += out.norm() / 4;
    inner.push_back(point_at(face, middle + 0.5 * out));
  }
  const auto rows = static_cast<std::size_t>(std::clamp(std::ceil(0.4 * radius / step), 1.0, 1e4));
  std::vector<Border> spokes, square;
  for (std::size_t k = 0; k < 4; ++k) {
    spokes.push_back(face.straight(loop, corner[k], inner[k], 0, rows));
    square.push_back(face.straight(inner[k], 0, inner[(k + 1) % 4], 0, corner[k + 1] - corner[k]));
  }
  std::vector<Borders> all{{square[0], square[1], square[2].reversed(), square[3].reversed()}};
  for (std::size_t k = 0; k < 4; ++k) {
    all.push_back({loop.part(corner[k], corner[k + 1]), spokes[(k + 1) % 4], square[k], spokes[k]});
  }
  return all;
}

std::vector<Borders> borders_of(const Face& face, const Plan& plan, const SharedEdges& edges) {
  switch (plan.shape) {
    case Shape::Quad:
      return {quad_borders(face, plan, edges)};
    case Shape::Wedge:
      return {wedge_borders(face, plan, edges)};
    case Shape::Ring:
      return {ring_borders(face, plan, edges)};
    case Shape::Midpoint:
      return midpoint_borders(face, plan, edges);
    case Shape::Disc:
      return disc_borders(face, plan, edges);
    case Shape::Triangles:
      break;
  }
  return {};
}

}  // namespace

Vec2 Parted::at(double part) const {
  const auto above = std::ranges::upper_bound(parts_, part) - parts_.begin();
  const auto k =
      static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(parts_) - 2));
  const double step = parts_[k + 1] - parts_[k];
  const double t = step > 0 ? std::clamp((part - parts_[k]) / step, 0.0, 1.0) : 0;
  return border_.flat[k] + t * (border_.flat[k + 1] - border_.flat[k]);
}

Vec2 Blend::at(double along_i, double along_j) const {
  return mix(borders_,
             {bottom_.at(along_i), right_.at(along_j), top_.at(along_i), left_.at(along_j)},
             {along_i, along_j});
}

std::vector<Patch> grids_of(const Face& face, const Plan& plan, const SharedEdges& edges) {
  std::vector<Patch> patches;
  for (const Borders& borders : borders_of(face, plan, edges)) {
    Grid grid = fill(face, borders);
    if (!is_sound(face, grid)) relax(face, grid);
    if (!is_sound(face, grid)) return {};
    patches.push_back(face.plane.is_turned() ? turned(grid.patch) : std::move(grid.patch));
  }
  return patches;
}

}  // namespace vdb_offset::cad
