#include "vdb_offset/surface/clean_polygons.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <ranges>
#include <utility>

#include "core/parallel.h"
#include "surface/facing_sides.h"
#include "surface/flat_triangles.h"
#include "surface/polygon_edges.h"
#include "surface/single_edges.h"
#include "surface/split_polygon.h"
#include "surface/weld.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

std::size_t index(int n) { return static_cast<std::size_t>(n); }

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15U;
  return hash ^ hash >> 29;
}

std::uint64_t hash_of(const Vec3& p) {
  std::uint64_t hash = 0;
  for (int c = 0; c < 3; ++c) hash = mixed(hash, std::bit_cast<std::uint64_t>(p[c] + 0.0));
  return hash;
}

/// With the number in the file of each face.
struct NumberedMesh : PolygonMesh {
  std::vector<int> number;
};

int number_of(const PolygonMesh& /*mesh*/, std::size_t face) { return static_cast<int>(face); }
int number_of(const NumberedMesh& mesh, std::size_t face) { return mesh.number[face]; }

/// A mesh like `mesh`, without its faces.
NumberedMesh without_faces(const PolygonMesh& mesh) {
  NumberedMesh empty;
  empty.families = mesh.families;
  empty.file = mesh.file;
  empty.corners.reserve(mesh.corners.size());
  empty.first.reserve(mesh.first.size());
  empty.family.reserve(mesh.family.size());
  return empty;
}

/// Adds a face that came from face `from` of `mesh`.
template <typename Mesh>
void add_face(NumberedMesh& out, std::span<const int> points, const Mesh& mesh, std::size_t from) {
  out.corners.insert(out.corners.end(), points.begin(), points.end());
  out.first.push_back(out.corners.size());
  if (!mesh.family.empty()) out.family.push_back(mesh.family[from]);
  out.number.push_back(number_of(mesh, from));
}

/// For each point the lowest that is equal to it; -1 for those that no face uses.
std::vector<int> weld_equal(const PolygonMesh& mesh, CleanReport& report) {
  const std::size_t count = mesh.points_world.size();
  std::vector<int> to(count, -1);
  for (const int corner : mesh.corners) to[index(corner)] = corner;
  const std::size_t slots = std::bit_ceil(2 * count + 1);
  std::vector<int> table(slots, -1);
  for (std::size_t p = 0; p < count; ++p) {
    if (to[p] < 0) {
      ++report.unused_points;
      continue;
    }
    std::size_t slot = hash_of(mesh.points_world[p]) & (slots - 1);
    while (table[slot] >= 0 && mesh.points_world[index(table[slot])] != mesh.points_world[p]) {
      slot = (slot + 1) & (slots - 1);
    }
    if (table[slot] < 0) {
      table[slot] = static_cast<int>(p);
    } else {
      ++report.welded_equal;
    }
    to[p] = table[slot];
  }
  return to;
}

/// Points that remain of weld_equal, with the shortest edge at each.
struct Places {
  Vec3List position;
  std::vector<int> point;     // that each is
  std::vector<int> of_point;  // -1 where a point is another
  std::vector<double> edge;   // infinite where there is none
};

Places places_of(const PolygonMesh& mesh, const std::vector<int>& to) {
  Places places;
  std::vector<int>& place = places.of_point;
  place.assign(to.size(), -1);
  for (std::size_t p = 0; p < to.size(); ++p) {
    if (to[p] != static_cast<int>(p)) continue;
    place[p] = static_cast<int>(places.point.size());
    places.point.push_back(static_cast<int>(p));
    places.position.push_back(mesh.points_world[p]);
  }
  places.edge.assign(places.point.size(), std::numeric_limits<double>::infinity());
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t n = 0; n < face.size(); ++n) {
      const int a = place[index(to[index(face[n])])];
      const int b = place[index(to[index(face[(n + 1) % face.size()])])];
      if (a == b) continue;
      const double length = (places.position[index(a)] - places.position[index(b)]).norm();
      for (const int end : {a, b}) {
        places.edge[index(end)] = std::min(places.edge[index(end)], length);
      }
    }
  }
  return places;
}

/// Makes the edges at places that lie on none of one face alone 0, so that nothing is near them.
void keep_inner(const PolygonMesh& mesh, const std::vector<int>& to, Places& places) {
  CellEdges edges;
  std::vector<int> corners;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    corners.clear();
    for (const int corner : mesh.face(f))
      corners.push_back(places.of_point[index(to[index(corner)])]);
    edges.add(corners);
  }
  std::vector<bool> is_free(places.point.size(), false);
  for (const std::array<int, 2>& edge : std::move(edges).single()) {
    for (const int end : edge) is_free[index(end)] = true;
  }
  for (std::size_t p = 0; p < is_free.size(); ++p) {
    if (!is_free[p]) places.edge[p] = 0;
  }
}

/// Faces as fans of triangles between places.
std::vector<FacingSides::Cell> cells_of(const PolygonMesh& mesh, const std::vector<int>& to,
                                        const std::vector<int>& place) {
  std::vector<FacingSides::Cell> cells;
  const auto at = [&](int corner) { return place[index(to[index(corner)])]; };
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t n = 1; n + 1 < face.size(); ++n) {
      cells.push_back({at(face[0]), at(face[n]), at(face[n + 1]), at(face[n + 1])});
    }
  }
  return cells;
}

/// Whether a point becomes one with another: `lowest` is not itself.
bool joins_any(const std::vector<int>& lowest) {
  return !std::ranges::equal(lowest, std::views::iota(0, static_cast<int>(lowest.size())));
}

/// Makes each place one with the lowest that it becomes.
void join(const Places& places, const std::vector<int>& lowest, std::vector<int>& to,
          CleanReport& report) {
  for (std::size_t n = 0; n < lowest.size(); ++n) {
    if (lowest[n] == static_cast<int>(n)) continue;
    const Vec3& from = places.position[n];
    const double moved = (from - places.position[index(lowest[n])]).norm();
    if (moved > report.moved_max_world) {
      report.moved_max_world = moved;
      report.moved_farthest_world = {from, places.position[index(lowest[n])]};
    }
    ++report.welded_near;
    to[index(places.point[n])] = places.point[index(lowest[n])];
  }
  for (int& point : to) {
    if (point >= 0) point = to[index(point)];
  }
}

void weld_near(const PolygonMesh& mesh, const CleanOptions& options, const Progress& progress,
               std::pair<std::vector<int>&, CleanReport&> out) {
  auto& [to, report] = out;
  Places places = places_of(mesh, to);
  const auto find = [&](double part, const KeepApart& keeps_apart = {}) {
    return weld_points(places.position, places.edge, part, keeps_apart, progress);
  };
  if (!joins_any(find(options.weld))) return;
  // First what the numbers of the file are off by: it would hide on which side a point is.
  if (options.weld_free_alone) keep_inner(mesh, to, places);
  join(places, find(kWeldNoise * options.weld), to, report);
  places = places_of(mesh, to);
  if (options.weld_free_alone) keep_inner(mesh, to, places);
  const FacingSides sides(cells_of(mesh, to, places.of_point), places.position,
                          FacingSides::Oriented::Yes);
  join(places, find(options.weld, [&](int a, int b) { return sides.face_each_other(a, b); }), to,
       report);
}

/// Takes out corners that repeat the one before; false if fewer than three points remain.
bool tidy(std::vector<int>& face, std::vector<int>& sorted) {
  face.erase(std::unique(face.begin(), face.end()), face.end());
  while (face.size() > 1 && face.front() == face.back()) face.pop_back();
  if (face.size() < 3) return false;
  if (face.size() == 3) return face[0] != face[2];
  sorted = face;
  std::sort(sorted.begin(), sorted.end());
  return std::unique(sorted.begin(), sorted.end()) - sorted.begin() >= 3;
}

NumberedMesh welded_faces(const PolygonMesh& mesh, const std::vector<int>& to,
                          CleanReport& report) {
  NumberedMesh out = without_faces(mesh);
  out.points_world = mesh.points_world;
  std::vector<int> face;
  std::vector<int> sorted;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    face.clear();
    for (const int corner : mesh.face(f)) face.push_back(to[index(corner)]);
    if (tidy(face, sorted)) {
      add_face(out, face, mesh, f);
      if (const auto edge = crossed_edge(mesh.points_world, face)) {
        const auto point = [&](std::size_t n) {
          return mesh.points_world[index(face[n % face.size()])];
        };
        report.crossed_faces.push_back({point(*edge), point(*edge + 1), 0, f + 1});
      }
    } else {
      ++report.degenerate_faces;
    }
  }
  return out;
}

/// From its lowest corner on, towards the lower of that one's neighbours.
void make_canonical(std::span<int> face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  if (face[1] > face.back()) std::reverse(face.begin() + 1, face.end());
}

/// Whether each face has the same corners as one before it, in either sense.
std::vector<bool> find_duplicates(const PolygonMesh& mesh) {
  std::vector<int> canonical = mesh.corners;
  std::vector<std::pair<std::uint64_t, std::size_t>> order(mesh.faces());
  const auto face = [&](std::size_t f) {
    return std::span(canonical).subspan(mesh.first[f], mesh.first[f + 1] - mesh.first[f]);
  };
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    make_canonical(face(f));
    std::uint64_t hash = 0;
    for (const int corner : face(f)) hash = mixed(hash, static_cast<std::uint64_t>(corner));
    order[f] = {hash, f};
  }
  parallel::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a < b; });
  std::vector<bool> duplicate(mesh.faces(), false);
  std::size_t kept = 0;  // of equal hashes the first: others of that hash are no matter
  for (std::size_t n = 1; n < order.size(); ++n) {
    if (order[n].first == order[kept].first &&
        std::ranges::equal(face(order[n].second), face(order[kept].second))) {
      duplicate[order[n].second] = true;
    } else {
      kept = n;
    }
  }
  return duplicate;
}

NumberedMesh without_duplicates(NumberedMesh mesh, CleanReport& report) {
  const std::vector<bool> duplicate = find_duplicates(mesh);
  const auto count = std::count(duplicate.begin(), duplicate.end(), true);
  if (count == 0) return mesh;
  report.duplicate_faces += static_cast<std::size_t>(count);
  NumberedMesh out = without_faces(mesh);
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    if (!duplicate[f]) add_face(out, mesh.face(f), mesh, f);
  }
  out.points_world = std::move(mesh.points_world);
  return out;
}

void check_corners(const PolygonMesh& mesh, std::size_t face) {
  const auto corners = mesh.face(face);
  if (corners.size() <= kMostCorners) return;
  const Vec3& p = mesh.points_world[index(corners[0])];
  throw InputError(fmt::format("{}: a face of {} corners, one at ({:.6g}, {:.6g}, {:.6g}); {} are "
                               "the most; split it into smaller ones",
                               mesh.file.empty() ? "the surface" : mesh.file, corners.size(), p.x(),
                               p.y(), p.z(), kMostCorners),
                   {static_cast<std::int64_t>(face)});
}

NumberedMesh split_faces(NumberedMesh mesh, bool concave_quads, CleanReport& report) {
  NumberedMesh out = without_faces(mesh);
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    const bool large = face.size() > 4;
    const bool crossed = face.size() == 4 && (face[0] == face[2] || face[1] == face[3]);
    const bool split =
        large || crossed ||
        (face.size() == 4 && concave_quads && is_concave_quad(mesh.points_world, face));
    if (!split) {
      add_face(out, face, mesh, f);
      continue;
    }
    check_corners(mesh, f);
    triangles.clear();
    ++report.split_polygons;
    if (!split_polygon(mesh.points_world, face, triangles)) ++report.crossed_polygons;
    for (const auto& t : triangles) {
      const bool real = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
      if (real) add_face(out, t, mesh, f);
    }
  }
  out.points_world = std::move(mesh.points_world);
  return out;
}

/// Points that faces use alone, in their order.
void drop_unused(PolygonMesh& mesh) {
  std::vector<int> to(mesh.points_world.size(), -1);
  for (const int corner : mesh.corners) to[index(corner)] = 0;
  int count = 0;
  for (std::size_t p = 0; p < to.size(); ++p) {
    if (to[p] < 0) continue;
    mesh.points_world[index(count)] = mesh.points_world[p];
    to[p] = count++;
  }
  mesh.points_world.resize(index(count));
  for (int& corner : mesh.corners) corner = to[index(corner)];
}

}  // namespace

void CleanOptions::validate() const {
  if (weld >= 0 && weld < 0.5) return;
  throw InputError(fmt::format("CleanOptions::weld = {}, but must be in [0, 0.5)", weld));
}

CleanedPolygons clean_polygons(const PolygonMesh& mesh, const CleanOptions& options,
                               const Progress& progress) {
  options.validate();
  CleanedPolygons cleaned;
  CleanReport& report = cleaned.report;
  std::vector<int> to = weld_equal(mesh, report);
  progress.check();
  if (options.weld > 0) weld_near(mesh, options, progress, {to, report});
  progress.check();
  NumberedMesh faces = without_duplicates(welded_faces(mesh, to, report), report);
  progress.check();
  faces = split_faces(std::move(faces), options.split_concave_quads, report);
  if (report.split_polygons > 0) faces = without_duplicates(std::move(faces), report);
  flip_flat_triangles(faces, faces.number, report);
  if (faces.faces() == 0) {
    throw InputError(
        fmt::format("{}: none of its {} faces has three different points and an area; "
                    "check the file, and its unit if its points are close",
                    mesh.file.empty() ? "the surface" : mesh.file, mesh.faces()));
  }
  drop_unused(faces);
  progress.check();
  orient_polygons(faces, options.turn_outward, report);
  cleaned.numbers = std::move(faces.number);
  cleaned.mesh = std::move(faces);
  return cleaned;
}

}  // namespace vdb_offset
