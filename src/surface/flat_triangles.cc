#include "surface/flat_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace vdb_offset {
namespace {

constexpr double kFlat = 1e-6;  // of the longest edge

std::size_t index(int n) { return static_cast<std::size_t>(n); }

/// The corner of a flat triangle that its longest edge does not have; -1: it is not flat.
int flat_corner(const Vec3List& points, std::span<const int> face) {
  if (face.size() != 3) return -1;
  double longest2 = 0;
  int corner = -1;
  for (int n = 0; n < 3; ++n) {
    const Vec3 edge =
        points[index(face[index((n + 2) % 3)])] - points[index(face[index((n + 1) % 3)])];
    if (edge.squaredNorm() <= longest2) continue;
    longest2 = edge.squaredNorm();
    corner = n;
  }
  if (corner < 0) return -1;
  const Vec3& tip = points[index(face[index(corner)])];
  const Vec3 area = (points[index(face[index((corner + 1) % 3)])] - tip)
                        .cross(points[index(face[index((corner + 2) % 3)])] - tip);
  return area.norm() <= kFlat * longest2 ? corner : -1;
}

class Flips {
 public:
  Flips(PolygonMesh& mesh, std::vector<int>& numbers) : mesh_(mesh), numbers_(numbers) {
    for (std::size_t f = 0; f < mesh.faces(); ++f) {
      faces_.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
      add(static_cast<int>(f));
    }
  }

  void run(std::vector<int> flat, CleanReport& report) {
    // A flip may leave another flat triangle, with a shorter edge.
    for (std::size_t most = 16 * flat.size(); !flat.empty() && most > 0; --most) {
      const int face = flat.back();
      flat.pop_back();
      const int corner = flat_corner(mesh_.points_world, faces_[index(face)]);
      if (corner < 0) continue;
      if (!flip(face, corner, flat)) {
        left_.push_back(face);
      } else {
        ++report.flipped_triangles;
      }
    }
    left_.insert(left_.end(), flat.begin(), flat.end());
    std::ranges::sort(left_);
    left_.erase(std::unique(left_.begin(), left_.end()), left_.end());
    for (const int face : left_) leave(face, report);
    put_back();
  }

 private:
  void leave(int face, CleanReport& report) const {
    const std::vector<int>& ring = faces_[index(face)];
    const int corner = flat_corner(mesh_.points_world, ring);
    if (corner < 0) return;
    const auto point = [&](int n) { return mesh_.points_world[index(ring[index(n % 3)])]; };
    if (report.flat_triangles == 0) report.first_flat = {point(corner + 1), point(corner + 2)};
    ++report.flat_triangles;
  }

  static std::pair<int, int> key(int a, int b) { return std::minmax(a, b); }

  template <typename Visit>
  void for_edges(int face, const Visit& visit) {
    const std::vector<int>& ring = faces_[index(face)];
    for (std::size_t n = 0; n < ring.size(); ++n) {
      visit(key(ring[n], ring[(n + 1) % ring.size()]));
    }
  }
  void add(int face) {
    for_edges(face, [&](const std::pair<int, int>& edge) { users_[edge].push_back(face); });
  }
  void remove(int face) {
    for_edges(face, [&](const std::pair<int, int>& edge) { std::erase(users_[edge], face); });
  }

  double longest2(const std::array<int, 3>& face) const {
    double longest = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3& from = mesh_.points_world[index(face[n])];
      longest =
          std::max(longest, (mesh_.points_world[index(face[(n + 1) % 3])] - from).squaredNorm());
    }
    return longest;
  }

  bool flip(int face, int corner, std::vector<int>& flat) {
    const std::vector<int> ring = faces_[index(face)];
    const int tip = ring[index(corner)];
    const int a = ring[index((corner + 1) % 3)];
    const int b = ring[index((corner + 2) % 3)];
    const std::vector<int> users = users_[key(a, b)];
    if (users.size() != 2) return false;
    const int other = users[0] == face ? users[1] : users[0];
    std::vector<int> rest = faces_[index(other)];
    if (std::ranges::count(rest, tip) > 0) return false;
    // Begins with the end of the edge, and ends with its start: what lies between is across.
    while (key(rest.back(), rest.front()) != key(a, b)) std::ranges::rotate(rest, rest.begin() + 1);
    for (std::size_t n = 1; n + 1 < rest.size(); ++n) {
      const auto diagonal = users_.find(key(tip, rest[n]));
      if (diagonal != users_.end() && !diagonal->second.empty()) return false;
    }
    const double edge2 =
        (mesh_.points_world[index(a)] - mesh_.points_world[index(b)]).squaredNorm();
    for (std::size_t n = 0; n + 1 < rest.size(); ++n) {
      const std::array<int, 3> piece{tip, rest[n], rest[n + 1]};
      // The two halves of a sliver would be flipped to and fro.
      if (flat_corner(mesh_.points_world, piece) >= 0 && longest2(piece) >= edge2) return false;
    }
    remove(face);
    remove(other);
    std::vector<int> slots{other, face};
    for (std::size_t n = 0; n + 1 < rest.size(); ++n) {
      if (n >= slots.size()) {
        slots.push_back(static_cast<int>(faces_.size()));
        faces_.emplace_back();
        if (!mesh_.family.empty()) mesh_.family.push_back({});
        numbers_.push_back({});
      }
      const std::size_t slot = index(slots[n]);
      faces_[slot] = {tip, rest[n], rest[n + 1]};
      if (!mesh_.family.empty()) mesh_.family[slot] = mesh_.family[index(other)];
      numbers_[slot] = numbers_[index(other)];
      add(slots[n]);
      flat.push_back(slots[n]);
    }
    return true;
  }

  void put_back() {
    mesh_.corners.clear();
    mesh_.first.assign(1, 0);
    for (const std::vector<int>& ring : faces_) {
      mesh_.corners.insert(mesh_.corners.end(), ring.begin(), ring.end());
      mesh_.first.push_back(mesh_.corners.size());
    }
  }

  PolygonMesh& mesh_;
  std::vector<int>& numbers_;
  std::vector<int> left_;
  std::vector<std::vector<int>> faces_;
  std::map<std::pair<int, int>, std::vector<int>> users_;
};

}  // namespace

void flip_flat_triangles(PolygonMesh& mesh, std::vector<int>& numbers, CleanReport& report) {
  std::vector<int> flat;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    if (flat_corner(mesh.points_world, mesh.face(f)) >= 0) flat.push_back(static_cast<int>(f));
  }
  if (!flat.empty()) Flips(mesh, numbers).run(std::move(flat), report);
}

}  // namespace vdb_offset
