#include <array>
#include <cmath>

#include "surface/draft_tube_shape.h"
#include "surface/example_grid.h"

// The paper's own case: a draft tube with two piers (Wang, Guibault and Camarero, Automatic
// Near-Body Domain Decomposition Using the Eikonal Equation, fig. 2).
//
// Floor and roof: across, columns run from the inlet to a line ahead of the piers; from there on
// each pier stands in a box of parallel sides, and a collar of three patches (front, left, right)
// fills the box round it. The box's corners lie on the grid of columns, so everything outside the
// boxes is a plain grid, and the collar's cells meet the pier at right angles.

namespace vdb_offset::example {

namespace {

using tube::Section;
using tube::WallSide;

constexpr double kBoxHalfWidth = 0.09;
constexpr double kBoxBegin = tube::kPierNose - 0.045;
constexpr double kNoseSplit = 0.25 * std::numbers::pi;  // the nose patch: this ellipse parameter
constexpr double kSettle = 0.5;

/// A pier: +1 left ("pier 1"), -1 right ("pier 2").
struct Pier {
  int sign;
  std::string name;
};
const std::array<Pier, 2>& piers() {
  static const std::array<Pier, 2> list{{{1, "pier 1"}, {-1, "pier 2"}}};
  return list;
}

/// The three passages between walls and piers, by their edges across.
enum class Passage { Right, Middle, Left };
constexpr const char* kPassageName[3] = {"right", "middle", "left"};

/// y of the boxes' sides that bound a passage at x.
std::pair<double, double> passage_edges(Passage passage, double x) {
  const double inner = tube::pier_middle(x) - kBoxHalfWidth;
  const double outer = tube::pier_middle(x) + kBoxHalfWidth;
  const double wall = tube::diffuser(x).half_width;
  if (passage == Passage::Middle) return {-inner, inner};
  return passage == Passage::Left ? std::pair{outer, wall} : std::pair{-wall, -outer};
}

/// Everything that the patches are built from.
struct Grid {
  int side = 0;                        ///< cells from floor to roof
  int collar = 0;                      ///< cells between pier and box
  int nose = 0;                        ///< cells across a box, and round a nose
  std::array<int, 3> passage{};        ///< cells across each passage
  std::vector<Section> upstream;       ///< cone, elbow and diffuser to the boxes
  int elbow_begin = 0, elbow_end = 0;  ///< among `upstream`
  std::vector<double> x;               ///< from the boxes' front to the outlet
  std::vector<double> columns;         ///< across floor and roof upstream, -1 to 1
};

std::vector<double> even(double from, double to, int count) {
  std::vector<double> values;
  for (int k = 0; k <= count; ++k) values.push_back((from * (count - k) + to * k) / count);
  values.front() = from;
  values.back() = to;
  return values;
}

/// `stretch` between two places on a line.
std::vector<double> graded(double from, double to, int count, std::pair<double, double> ends) {
  std::vector<double> values = stretch(count, ends.first / (to - from), ends.second / (to - from));
  for (double& v : values) v = (1 - v) * from + v * to;
  return values;
}

void append(std::vector<double>& values, const std::vector<double>& more) {
  values.insert(values.end(), more.begin() + (values.empty() ? 0 : 1), more.end());
}

/// Columns across floor and roof ahead of the piers: the grid of passages and boxes there.
std::vector<double> make_columns(const Grid& grid) {
  std::vector<double> columns;
  const double front_width = tube::diffuser(kBoxBegin).half_width;
  for (const Passage passage : {Passage::Right, Passage::Middle, Passage::Left}) {
    const auto [from, to] = passage_edges(passage, kBoxBegin);
    if (passage != Passage::Right) {
      append(columns, even(columns.back(), from / front_width, grid.nose));
    }
    const double begin = passage == Passage::Right ? -1 : from / front_width;
    const double end = passage == Passage::Left ? 1 : to / front_width;
    append(columns, even(begin, end, grid.passage[static_cast<std::size_t>(passage)]));
  }
  return columns;
}

Grid make_grid(const ExampleOptions& options) {
  Grid grid;
  const double step = 1.0 / (options.points - 1);  // a typical cell, metres
  grid.side = cells(options, 0.625);
  grid.collar = cells(options, 3.0 / 32);
  grid.nose = 2 * cells(options, 3.0 / 32);
  const int outer = cells(options, 7.0 / 32);
  grid.passage = {outer, cells(options, 6.0 / 32), outer};

  grid.columns = make_columns(grid);

  const int cone = cells(options, 0.5);
  const int bend = cells(options, 1);
  for (const double t : even(0, 1, cone)) grid.upstream.push_back(tube::cone(t));
  grid.elbow_begin = cone;
  grid.elbow_end = cone + bend;
  for (int k = 1; k <= bend; ++k) {
    grid.upstream.push_back(tube::elbow(static_cast<double>(k) / bend));
  }
  const auto ahead = graded(tube::kDiffuserBegin, kBoxBegin, bend, {0.75 * step, 0.65 * step});
  for (std::size_t k = 1; k < ahead.size(); ++k) grid.upstream.push_back(tube::diffuser(ahead[k]));
  grid.x = graded(kBoxBegin, tube::kOutlet, cells(options, 1.5), {0.65 * step, 1.5 * step});
  return grid;
}

/// The patch of one wall between two sections; normals inward.
Patch wall_strip(const std::string& name, const std::vector<Section>& sections, WallSide side,
                 const std::vector<double>& across) {
  Patch patch = tabulate(name, static_cast<int>(sections.size()), static_cast<int>(across.size()),
                         [&](int i, int j) {
                           return tube::on_wall(sections[static_cast<std::size_t>(i)], side,
                                                across[static_cast<std::size_t>(j)]);
                         });
  const bool inward = side == WallSide::Floor || side == WallSide::Left;
  return inward ? patch : turned(std::move(patch));
}

/// Cone, elbow and the diffuser: floor and roof as far as the boxes, the sides to the outlet.
void add_walls(Patches& patches, const Grid& grid) {
  static constexpr std::pair<WallSide, const char*> kSides[] = {{WallSide::Floor, "floor"},
                                                                {WallSide::Roof, "roof"},
                                                                {WallSide::Left, "left"},
                                                                {WallSide::Right, "right"}};
  const auto at = [&](int k) { return grid.upstream.begin() + k; };
  const std::vector<Section> cone(at(0), at(grid.elbow_begin + 1));
  const std::vector<Section> elbow(at(grid.elbow_begin), at(grid.elbow_end + 1));
  const std::vector<Section> ahead(at(grid.elbow_end), grid.upstream.end());
  std::vector<Section> whole = ahead;
  for (std::size_t k = 1; k < grid.x.size(); ++k) whole.push_back(tube::diffuser(grid.x[k]));
  const std::vector<double> upright = even(-1, 1, grid.side);
  for (const auto& [side, name] : kSides) {
    const bool level = side == WallSide::Floor || side == WallSide::Roof;
    const std::vector<double>& across = level ? grid.columns : upright;
    patches.push_back(wall_strip(std::string("cone ") + name, cone, side, across));
    patches.push_back(wall_strip(std::string("elbow ") + name, elbow, side, across));
    patches.push_back(
        wall_strip(std::string("diffuser ") + name, level ? ahead : whole, side, across));
  }
}

/// Lift a patch of (x, y) on to floor and roof: named "floor ..." and "roof ...".
void add_floor_and_roof(Patches& patches, const Patch& plan) {
  for (const double height : {-1.0, 1.0}) {
    Patch patch = moved(plan, [&](const Vec3& p) {
      return tube::in_section(tube::diffuser(p.x()), p.y(), height);
    });
    patch.name = (height < 0 ? "floor " : "roof ") + plan.name;
    patches.push_back(height < 0 ? std::move(patch) : turned(std::move(patch)));
  }
}

void add_passages(Patches& patches, const Grid& grid) {
  for (const Passage passage : {Passage::Right, Passage::Middle, Passage::Left}) {
    const int count = grid.passage[static_cast<std::size_t>(passage)];
    const int ni = static_cast<int>(grid.x.size());
    add_floor_and_roof(patches, tabulate(kPassageName[static_cast<int>(passage)], ni, count + 1,
                                         [&](int i, int j) -> Vec3 {
                                           const double x = grid.x[static_cast<std::size_t>(i)];
                                           const auto [from, to] = passage_edges(passage, x);
                                           return {x, (from * (count - j) + to * j) / count, 0};
                                         }));
  }
}

Curve mirrored(Curve curve) {
  for (Vec3& p : curve) p.y() = -p.y();
  return curve;
}

/// A pier's outline and its box in the plane, about the pier's middle line: y = 0.
struct Outline {
  Curve nose;       ///< from right to left
  Curve flank;      ///< left, from the nose patch to the outlet
  Curve box_flank;  ///< left
  Curve box_front;  ///< from right to left
};

Outline make_outline(const Grid& grid) {
  Outline outline;
  for (const double angle : even(-kNoseSplit, kNoseSplit, grid.nose)) {
    outline.nose.push_back({tube::kPierNose + tube::kPierNoseLength * (1 - std::cos(angle)),
                            tube::kPierHalfWidth * std::sin(angle), 0});
  }
  // The flank's points start behind the box's, but stand square to them soon after.
  const double behind = outline.nose.back().x() - kBoxBegin;
  for (const double x : grid.x) {
    const double rest = 1 - std::min(1.0, (x - kBoxBegin) / kSettle);
    const double place = x + behind * rest * rest * rest;
    outline.flank.push_back({place, tube::pier_half_width(place), 0});
  }
  for (const double x : grid.x) outline.box_flank.push_back({x, kBoxHalfWidth, 0});
  outline.box_front =
      line({kBoxBegin, -kBoxHalfWidth, 0}, {kBoxBegin, kBoxHalfWidth, 0}, grid.nose);
  return outline;
}

void add_collar(Patches& patches, const Grid& grid, const Pier& pier) {
  const Outline o = make_outline(grid);
  const Curve diagonal = line(o.flank.front(), o.box_flank.front(), grid.collar);
  const Curve tail = line(o.flank.back(), o.box_flank.back(), grid.collar);
  const std::array<Patch, 3> parts{
      transfinite(pier.name + " front",
                  {reversed(mirrored(diagonal)), o.nose, reversed(diagonal), o.box_front}),
      transfinite(pier.name + " left", {o.flank, tail, o.box_flank, diagonal}),
      transfinite(pier.name + " right", {mirrored(o.box_flank), reversed(mirrored(tail)),
                                         mirrored(o.flank), reversed(mirrored(diagonal))})};
  for (const Patch& part : parts) {
    add_floor_and_roof(patches, moved(part, [&](const Vec3& p) -> Vec3 {
                         return {p.x(), p.y() + pier.sign * tube::pier_middle(p.x()), 0};
                       }));
  }
}

/// The upright wall over a curve of the pier's outline; i along the curve.
Patch pier_wall(const Grid& grid, const Pier& pier, const Curve& curve) {
  const std::vector<double> upright = even(-1, 1, grid.side);
  const int ni = static_cast<int>(curve.size());
  return tabulate(pier.name, ni, grid.side + 1, [&](int i, int j) {
    const Vec3& p = curve[static_cast<std::size_t>(i)];
    return tube::in_section(tube::diffuser(p.x()), p.y() + pier.sign * tube::pier_middle(p.x()),
                            upright[static_cast<std::size_t>(j)]);
  });
}

void add_pier(Patches& patches, const Grid& grid, const Pier& pier) {
  const Outline o = make_outline(grid);
  std::array<Patch, 3> walls{turned(pier_wall(grid, pier, o.nose)),
                             turned(pier_wall(grid, pier, o.flank)),
                             pier_wall(grid, pier, mirrored(o.flank))};
  static constexpr const char* kPart[3] = {" nose", " left side", " right side"};
  for (std::size_t k = 0; k < 3; ++k) {
    walls[k].name += kPart[k];
    patches.push_back(std::move(walls[k]));
  }
}

/// The four sides of the inlet, or of its core; each between its chord (`chord` = 1) and its arc.
std::array<Curve, 4> inlet_sides(const Grid& grid, double size, double chord) {
  Section section = tube::cone(0);
  section.floor.x() *= size;
  section.roof.x() *= size;
  section.half_width *= size;
  const std::vector<double> upright = even(-1, 1, grid.side);
  std::array<Curve, 4> curves;
  for (const WallSide side : {WallSide::Floor, WallSide::Roof, WallSide::Left, WallSide::Right}) {
    const bool level = side == WallSide::Floor || side == WallSide::Roof;
    const Vec3 a = tube::on_wall(section, side, -1);
    const Vec3 b = tube::on_wall(section, side, 1);
    for (const double t : level ? grid.columns : upright) {
      const Vec3 straight = 0.5 * ((1 - t) * a + (1 + t) * b);
      const Vec3 round = tube::on_wall(section, side, t);
      curves[static_cast<std::size_t>(side)].push_back((1 - chord) * round + chord * straight);
    }
  }
  return curves;
}

/// The inlet: a core inside four rim patches; normals downward, into the tube.
void add_inlet(Patches& patches, const Grid& grid) {
  const int count = std::max(1, grid.side / 3);
  // A core between arc and chord: its corners stay well below straight.
  const auto [floor, roof, left, right] = inlet_sides(grid, 1, 0);
  const auto [core_floor, core_roof, core_left, core_right] = inlet_sides(grid, 0.6, 0.5);
  const Curve floor_right = line(floor.front(), core_floor.front(), count);
  const Curve floor_left = line(floor.back(), core_floor.back(), count);
  const Curve roof_right = line(core_roof.front(), roof.front(), count);
  const Curve roof_left = line(core_roof.back(), roof.back(), count);
  Patches inlet{transfinite("inlet core", {core_floor, core_left, core_roof, core_right}),
                transfinite("inlet floor", {floor, floor_left, core_floor, floor_right}),
                transfinite("inlet roof", {core_roof, roof_left, roof, roof_right}),
                transfinite("inlet left", {reversed(floor_left), left, roof_left, core_left}),
                transfinite("inlet right", {floor_right, core_right, reversed(roof_right), right})};
  for (Patch& patch : inlet) {
    patch = moved(std::move(patch), [](const Vec3& p) -> Vec3 {
      return {p.x(), p.y(), tube::kInletHeight};
    });
    patch.family = "inlet";
    patches.push_back(std::move(patch));
  }
}

/// The outlet's three openings; normals upstream, into the tube.
void add_outlet(Patches& patches, const Grid& grid) {
  const Section section = tube::diffuser(tube::kOutlet);
  const std::vector<double> upright = even(-1, 1, grid.side);
  const double middle = tube::pier_middle(tube::kOutlet);
  for (const Passage passage : {Passage::Right, Passage::Middle, Passage::Left}) {
    const auto [from, to] = passage_edges(passage, tube::kOutlet);
    std::vector<double> y;
    if (passage != Passage::Right) {
      const double pier = passage == Passage::Left ? middle : -middle;
      append(y, even(pier + tube::kPierHalfWidth, from, grid.collar));
    }
    append(y, even(from, to, grid.passage[static_cast<std::size_t>(passage)]));
    if (passage != Passage::Left) {
      const double pier = passage == Passage::Right ? -middle : middle;
      append(y, even(to, pier - tube::kPierHalfWidth, grid.collar));
    }
    Patch patch = turned(tabulate(std::string("outlet ") + kPassageName[static_cast<int>(passage)],
                                  static_cast<int>(y.size()), grid.side + 1, [&](int i, int j) {
                                    return tube::in_section(section, y[static_cast<std::size_t>(i)],
                                                            upright[static_cast<std::size_t>(j)]);
                                  }));
    patch.family = "outlet";
    patches.push_back(std::move(patch));
  }
}

}  // namespace

Patches draft_tube(const ExampleOptions& options) {
  const Grid grid = make_grid(options);
  Patches patches;
  add_walls(patches, grid);
  add_passages(patches, grid);
  for (const Pier& pier : piers()) add_collar(patches, grid, pier);
  set_family(patches, "wall");
  Patches bodies;
  for (const Pier& pier : piers()) add_pier(bodies, grid, pier);
  set_family(bodies, "pier");
  patches.insert(patches.end(), bodies.begin(), bodies.end());
  if (options.closed) {
    add_inlet(patches, grid);
    add_outlet(patches, grid);
  }
  stitch(patches);
  return patches;
}

}  // namespace vdb_offset::example
