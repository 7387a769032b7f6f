#include "surface/quad_edges.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::string of_file(const PolygonMesh& mesh) {
  return mesh.file.empty() ? std::string() : " of " + mesh.file;
}

std::string place_of(const PolygonMesh& mesh, int point) {
  const Vec3& x = mesh.points_world[at(point)];
  return fmt::format("({:g}, {:g}, {:g})", x.x(), x.y(), x.z());
}

/// "face 3 of part.obj at (0, 1, 2)": its first corner.
std::string face_name(const PolygonMesh& mesh, std::size_t face) {
  const std::string name = fmt::format("face {}{}", face + 1, of_file(mesh));
  const std::span<const int> points = mesh.face(face);
  const bool has_place =
      !points.empty() && points[0] >= 0 && at(points[0]) < mesh.points_world.size();
  return has_place ? name + " at " + place_of(mesh, points[0]) : name;
}

void check_faces(const PolygonMesh& mesh) {
  if (mesh.faces() == 0) throw InputError("the surface" + of_file(mesh) + " has no faces");
  if (mesh.faces() > at(std::numeric_limits<int>::max() / 4)) {
    throw InputError(fmt::format("the surface{} has {} faces; at most 500 million are supported",
                                 of_file(mesh), mesh.faces()));
  }
  for (std::size_t p = 0; p < mesh.points_world.size(); ++p) {
    if (mesh.points_world[p].allFinite()) continue;
    throw InputError(fmt::format("point {}{} at {} is not finite", p + 1, of_file(mesh),
                                 place_of(mesh, static_cast<int>(p))),
                     {static_cast<std::int64_t>(p)});
  }
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const std::span<const int> points = mesh.face(f);
    const auto index = static_cast<std::int64_t>(f);
    if (points.size() != 4) {
      throw InputError(fmt::format("{} has {} corners, but structured patches need quads alone",
                                   face_name(mesh, f), points.size()),
                       {index});
    }
    std::array<int, 4> sorted{points[0], points[1], points[2], points[3]};
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] < 0 || at(sorted[3]) >= mesh.points_world.size()) {
      throw InputError(fmt::format("{} uses a point that there is not", face_name(mesh, f)),
                       {index});
    }
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
      throw InputError(fmt::format("{} uses a point twice; clean the mesh", face_name(mesh, f)),
                       {index});
    }
  }
}

/// The half-edges that leave or reach each point, the other being higher.
struct ByLowPoint {
  std::vector<int> first;  // of each point, and the end
  std::vector<int> halves;
};

ByLowPoint sort_halves(const PolygonMesh& mesh) {
  const auto halves = static_cast<int>(4 * mesh.faces());
  const auto low = [&](int h) {
    return at(std::min(mesh.corners[at(h)], mesh.corners[at(QuadEdges::next(h))]));
  };
  ByLowPoint sorted{std::vector<int>(mesh.points_world.size() + 1, 0),
                    std::vector<int>(at(halves))};
  for (int h = 0; h < halves; ++h) ++sorted.first[low(h) + 1];
  std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
  std::vector<int> end = sorted.first;
  for (int h = 0; h < halves; ++h) sorted.halves[at(end[low(h)]++)] = h;
  return sorted;
}

/// Joins the halves from `first` to `last` of one edge.
void join(QuadEdges& edges, std::span<const int> halves) {
  if (halves.size() == 1) return;
  const PolygonMesh& mesh = edges.mesh;
  const int a = halves[0];
  const int b = halves[1];
  const auto edge_place = [&] {
    return fmt::format("from {} to {}{}", place_of(mesh, edges.from(a)),
                       place_of(mesh, edges.to(a)), of_file(mesh));
  };
  if (halves.size() > 2) {
    throw InputError(
        fmt::format("the surface is not a manifold: {} faces, {}, {} and {} among them, meet on "
                    "the edge {}; remove inner or doubled faces",
                    halves.size(), a / 4 + 1, b / 4 + 1, halves[2] / 4 + 1, edge_place()),
        {a / 4, b / 4, halves[2] / 4});
  }
  if (edges.from(a) == edges.from(b)) {
    throw InputError(
        fmt::format("faces {} and {} are turned against each other on the edge {}; orient the "
                    "mesh, if it has two sides (a Moebius strip has one)",
                    a / 4 + 1, b / 4 + 1, edge_place()),
        {a / 4, b / 4});
  }
  edges.twin[at(a)] = b;
  edges.twin[at(b)] = a;
}

void find_twins(QuadEdges& edges) {
  ByLowPoint sorted = sort_halves(edges.mesh);
  const auto high = [&](int h) { return std::max(edges.from(h), edges.to(h)); };
  for (std::size_t p = 0; p + 1 < sorted.first.size(); ++p) {
    const std::span<int> here(sorted.halves.data() + sorted.first[p],
                              at(sorted.first[p + 1] - sorted.first[p]));
    std::sort(here.begin(), here.end(),
              [&](int a, int b) { return high(a) != high(b) ? high(a) < high(b) : a < b; });
    for (std::size_t first = 0; first < here.size();) {
      std::size_t last = first + 1;
      while (last < here.size() && high(here[last]) == high(here[first])) ++last;
      join(edges, here.subspan(first, last - first));
      first = last;
    }
  }
}

/// Finds where each point's half-edges start, and whether turning left passes all of them.
void find_fans(QuadEdges& edges) {
  std::vector<int> quads(edges.mesh.points_world.size(), 0);
  for (int h = 0; h < edges.size(); ++h) {
    ++quads[at(edges.from(h))];
    int& start = edges.start[at(edges.from(h))];
    if (start < 0 || edges.twin_of(h) < 0) start = h;
  }
  for (std::size_t p = 0; p < quads.size(); ++p) {
    const int start = edges.start[p];
    if (start < 0) continue;
    int count = 1;
    int h = edges.turn_left(start);
    for (; h >= 0 && h != start; h = edges.turn_left(h)) ++count;
    if (count != quads[p]) {
      throw InputError(
          fmt::format("the surface is not a manifold: parts of it touch in a single point, "
                      "{}; move them apart or join them along an edge",
                      face_name(edges.mesh, at(start / 4)) + ", at " +
                          place_of(edges.mesh, static_cast<int>(p))),
          {start / 4});
    }
    edges.regular[p] = h == start && count == 4 ? 1 : 0;
  }
}

}  // namespace

bool QuadEdges::before(int a, int b) const {
  const Vec3& p = place(a);
  const Vec3& q = place(b);
  if (p.x() != q.x()) return p.x() < q.x();
  if (p.y() != q.y()) return p.y() < q.y();
  if (p.z() != q.z()) return p.z() < q.z();
  return a < b;
}

QuadEdges build_quad_edges(const PolygonMesh& mesh) {
  check_faces(mesh);
  QuadEdges edges{mesh, std::vector<int>(4 * mesh.faces(), -1),
                  std::vector<int>(mesh.points_world.size(), -1),
                  std::vector<char>(mesh.points_world.size(), 0)};
  find_twins(edges);
  find_fans(edges);
  return edges;
}

}  // namespace vdb_offset
