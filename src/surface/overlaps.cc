#include "vdb_offset/surface/overlaps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "core/parallel.h"
#include "core/sets.h"
#include "surface/edge_crossings.h"
#include "surface/flat_overlaps.h"
#include "surface/joined_cells.h"
#include "surface/solid_angle.h"
#include "vdb_offset/surface/winding.h"

namespace vdb_offset {
namespace {

std::size_t at(int n) { return static_cast<std::size_t>(n); }

/// Beside a triangle, in parts of the root of its area: nearer than walls of a mesh lie; and nearer
/// still, to be sure that there is no gap.
constexpr double kBeside = 1e-4;
constexpr double kNearBeside = 1e-7;
constexpr int kTries = 8;  // places of a part that crosses itself, or of two that may only touch

struct Face {
  Wall::Triangle nodes;
  int patch;
  int part = -1;
};

std::vector<Face> faces_of(const Surface& surface) {
  std::vector<Face> faces;
  for_joined_triangles(surface, [&](int patch, const Wall::Triangle& nodes) {
    faces.push_back({nodes, patch});
  });
  return faces;
}

/// Numbers closed parts from 0, and drops the faces of others; returns how many there are.
int keep_closed(const Surface& surface, std::vector<Face>& faces) {
  Sets parts(surface.nodes_world.size());
  std::vector<std::array<int, 2>> edges;
  for (const Face& face : faces) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = face.nodes[c];
      const int b = face.nodes[(c + 1) % 3];
      parts.join(a, b);
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  parallel::sort(edges.begin(), edges.end(), std::less<>());
  std::vector<char> is_open(surface.nodes_world.size(), 0);
  for (std::size_t e = 0; e < edges.size();) {
    const std::size_t first = e;
    while (e < edges.size() && edges[e] == edges[first]) ++e;
    if (e != first + 2) is_open[at(parts.root(edges[first][0]))] = 1;
  }
  std::map<int, int> number;
  for (Face& face : faces) {
    const int root = parts.root(face.nodes[0]);
    if (is_open[at(root)] != 0) continue;
    face.part = number.try_emplace(root, static_cast<int>(number.size())).first->second;
  }
  std::erase_if(faces, [](const Face& face) { return face.part < 0; });
  return static_cast<int>(number.size());
}

class Finder {
 public:
  Finder(const Surface& surface, std::vector<Face> faces, int parts)
      : nodes_(surface.nodes_world), faces_(std::move(faces)), boxes_(at(parts)) {
    for (const Face& face : faces_) {
      for (const int n : face.nodes) boxes_[at(face.part)].add(nodes_[at(n)]);
    }
  }

  std::vector<Overlap> find() const {
    Found found;
    find_faces(found);
    find_edges(found);
    std::vector<Overlap> out;
    for (const auto& [part, named] : found) out.push_back(named.overlap);
    return out;
  }

 private:
  struct Named {
    Overlap overlap;
    int other;  // part
  };
  using Found = std::map<int, Named>;  // of each part

  /// Whether nothing is left to be said of two parts.
  static bool is_known(const Found& found, int a, int b) {
    const auto of_a = found.find(a);
    const auto of_b = found.find(b);
    if (of_a != found.end() && of_b != found.end()) return true;
    return (of_a != found.end() && of_a->second.other == b) ||
           (of_b != found.end() && of_b->second.other == a);
  }

  /// Parts by faces whose middles lie in others.
  void find_faces(Found& found) const {
    std::vector<std::size_t> asked;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (is_in_other_box(faces_[f])) asked.push_back(f);
    }
    if (asked.empty()) return;
    std::vector<char> is_wrong(asked.size(), 0);
    const Winding winding(wall_of(faces_));
    parallel::for_ranges(asked.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        is_wrong[n] = overlaps(winding, faces_[asked[n]]) ? 1 : 0;
      }
    });
    std::map<int, int> tried;
    for (std::size_t n = 0; n < asked.size(); ++n) {
      if (is_wrong[n] != 0) add(faces_[asked[n]], found, tried);
    }
  }

  /// Those that go through others by edges alone.
  void find_edges(Found& found) const {
    std::vector<char> meets(boxes_.size(), 0);
    for (std::size_t a = 0; a < boxes_.size(); ++a) {
      for (std::size_t b = 0; b < boxes_.size(); ++b) {
        const bool apart = (boxes_[a].lo.array() > boxes_[b].hi.array()).any() ||
                           (boxes_[b].lo.array() > boxes_[a].hi.array()).any();
        if (a != b && !apart) meets[a] = 1;
      }
    }
    std::vector<Face> faces;
    std::vector<int> part(nodes_.size(), -1);
    for (const Face& face : faces_) {
      if (meets[at(face.part)] == 0) continue;
      faces.push_back(face);
      for (const int n : face.nodes) part[at(n)] = face.part;
    }
    if (faces.empty()) return;
    const Wall wall = wall_of(faces);
    const auto face_of = [&](int triangle) {
      return *std::ranges::find(faces, wall.triangles()[at(triangle)], &Face::nodes);
    };
    std::map<std::array<int, 2>, int> tried;  // of each pair
    for (const EdgeCrossing& crossing : edge_crossings(wall, part)) {
      const int own_part = part[at(crossing.vertices[0])];
      const int other_part = part[at(wall.triangles()[at(crossing.through)][0])];
      if (is_known(found, own_part, other_part)) continue;
      if (++tried[{own_part, other_part}] > kTries || !goes_through(crossing, other_part)) continue;
      const Face own = face_of(crossing.triangle);
      const Face other = face_of(crossing.through);
      const bool is_named = found.contains(own_part);
      const Face& first = is_named ? other : own;
      const Face& second = is_named ? own : other;
      found[first.part] = {{first.patch, second.patch, crossing.place_world, 1}, second.part};
    }
  }

  /// Whether an edge is in another part on one side of a place and out of it on the other, and not
  /// for slipping along it: the same a little inward and outward of the edge.
  bool goes_through(const EdgeCrossing& crossing, int other) const {
    const Vec3& from = nodes_[at(crossing.vertices[0])];
    const Vec3& to = nodes_[at(crossing.vertices[1])];
    const Vec3 step = kBeside * (to - from);
    Vec3 out = Vec3::Zero();
    for (const Face& face : faces_) {
      const auto has = [&](int node) {
        return std::ranges::find(face.nodes, node) != face.nodes.end();
      };
      if (!has(crossing.vertices[0]) || !has(crossing.vertices[1])) continue;
      const TriangleGeometry t = geometry(face);
      out += t.ab.cross(t.ac).normalized();
    }
    if (!(out.norm() > kBeside)) return false;  // the sides of a plate
    out = step.norm() * out.normalized();
    const auto number = [&](const Vec3& place) {
      double angle = 0;
      for (const Face& face : faces_) {
        if (face.part == other) angle += solid_angle(geometry(face), place);
      }
      return std::lround(angle / (4 * std::numbers::pi));
    };
    std::array<long, 2> numbers{};
    for (std::size_t n = 0; n < 2; ++n) {
      const Vec3 place = crossing.place_world + (n == 0 ? -1 : 1) * step;
      numbers[n] = number(place - out);
      if (number(place + out) != numbers[n]) return false;
    }
    return numbers[0] != numbers[1];
  }

  Wall wall_of(const std::vector<Face>& faces) const {
    std::vector<Wall::Triangle> triangles;
    for (const Face& face : faces) triangles.push_back(face.nodes);
    return {nodes_, std::move(triangles)};
  }

  TriangleGeometry geometry(const Face& face) const {
    const Vec3& a = nodes_[at(face.nodes[0])];
    return {a, nodes_[at(face.nodes[1])] - a, nodes_[at(face.nodes[2])] - a};
  }

  /// Whether there is solid in front of a face, or two behind it, where another lies on it.
  bool overlaps(const Winding& winding, const Face& face) const {
    const auto is_solid = [&](double parts) {
      const double number = winding.number(beside(face, parts));
      return number > 0.5 || number < -1.5;
    };
    if (is_solid(kBeside)) return is_solid(kNearBeside);
    return winding.number(beside(face, -kBeside)) > 1.5 &&
           winding.number(beside(face, -kNearBeside)) > 1.5;
  }

  /// A point in front of a face.
  Vec3 beside(const Face& face, double parts = kBeside) const {
    const TriangleGeometry t = geometry(face);
    const Vec3 normal = t.ab.cross(t.ac);
    const double twice = normal.norm();
    const Vec3 middle = t.a + (t.ab + t.ac) / 3;
    return twice > 0 ? Vec3(middle + (parts * std::sqrt(twice) / twice) * normal) : middle;
  }

  bool is_in_other_box(const Face& face) const {
    const auto is_in = [](const Box& box, const Vec3& place) {
      return (place.array() >= box.lo.array()).all() && (place.array() <= box.hi.array()).all();
    };
    const Vec3 front = beside(face);
    const Vec3 back = beside(face, -kBeside);
    for (std::size_t b = 0; b < boxes_.size(); ++b) {
      if (static_cast<int>(b) == face.part) continue;
      if (is_in(boxes_[b], front) || is_in(boxes_[b], back)) return true;
    }
    return false;
  }

  /// The part that goes round a place as its own does not; -1 for none.
  int other_around(const Vec3& place, int own) const {
    std::vector<double> angles(boxes_.size(), 0);
    for (const Face& face : faces_) angles[at(face.part)] += solid_angle(geometry(face), place);
    angles[at(own)] = 0;
    const auto most = std::ranges::max_element(angles, {}, [](double a) { return std::abs(a); });
    return std::abs(*most) > 2 * std::numbers::pi ? static_cast<int>(most - angles.begin()) : -1;
  }

  void add(const Face& face, Found& found, std::map<int, int>& tried) const {
    if (const auto known = found.find(face.part); known != found.end()) {
      ++known->second.overlap.faces;
      return;
    }
    if (++tried[face.part] > kTries) return;
    Vec3 place = beside(face);
    int other = other_around(place, face.part);
    if (other < 0) {  // on it
      place = beside(face, -kBeside);
      other = other_around(place, face.part);
    }
    if (other < 0) return;
    const auto first = std::ranges::find(faces_, other, &Face::part);
    found[face.part] = {{face.patch, first->patch, place, 1}, other};
  }

  const Vec3List& nodes_;
  std::vector<Face> faces_;
  std::vector<Box> boxes_;  // of parts
};

}  // namespace

std::vector<Overlap> find_overlaps(const Surface& surface) {
  if (surface.both_sides || surface.winding) return {};
  if (surface.flat) return find_flat_overlaps(surface);
  std::vector<Face> faces = faces_of(surface);
  const int parts = keep_closed(surface, faces);
  if (parts < 2) return {};
  return Finder(surface, std::move(faces), parts).find();
}

}  // namespace vdb_offset
