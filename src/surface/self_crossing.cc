#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "surface/crossing.h"
#include "surface/edge_crossings.h"
#include "vdb_offset/surface/overlaps.h"

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Triangles in a row, which lie near each other, are looked at together.
constexpr std::size_t kTogether = 8;

Box box_of(const TriangleGeometry& t) {
  Box box;
  box.add(t.a);
  box.add(Vec3(t.a + t.ab));
  box.add(Vec3(t.a + t.ac));
  return box;
}

bool apart(const Box& a, const Box& b) {
  return (a.lo.array() > b.hi.array()).any() || (b.lo.array() > a.hi.array()).any();
}

/// Crossings of the edges of some triangles, first to last - 1, with any of the wall.
class Search {
 public:
  Search(const Wall& wall, std::span<const int> part)
      : wall_(wall), triangles_(wall.triangles()), part_(part) {}

  std::vector<EdgeCrossing> run(std::size_t first, std::size_t last) {
    gather(first, last);
    std::vector<EdgeCrossing> found;
    for (std::size_t t = first; t < last; ++t) {
      narrow(box_of(wall_.geometry()[t]));
      for (std::size_t c = 0; c < 3; ++c) {
        const int from = triangles_[t][c];
        const int to = triangles_[t][(c + 1) % 3];
        if (from > to) continue;  // the triangle across has it the other way round
        const std::optional<EdgeCrossing> one = crossing(from, to, t);
        if (one) found.push_back(*one);
      }
    }
    return found;
  }

 private:
  /// Triangles whose boxes meet the box around those that are asked for.
  void gather(std::size_t first, std::size_t last) {
    Box box;
    for (std::size_t t = first; t < last; ++t) {
      for (const int v : triangles_[t]) box.add(wall_.vertices()[at(v)]);
    }
    runs_.clear();
    wall_.near_box(box, 0, runs_);
    near_.clear();
    boxes_.clear();
    for (const TriangleRun& run : runs_) {
      for (std::uint32_t t = run.first; t < run.last; ++t) {
        const Box own = box_of(wall_.geometry()[t]);
        if (apart(own, box)) continue;
        near_.push_back(static_cast<int>(t));
        boxes_.push_back(own);
      }
    }
  }

  /// Those of them whose boxes meet the box of one triangle; without branches, which would be
  /// foretold badly.
  void narrow(const Box& box) {
    meeting_.resize(near_.size());
    std::size_t count = 0;
    for (std::size_t n = 0; n < near_.size(); ++n) {
      const Box& own = boxes_[n];
      bool meets = true;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        meets &= (own.lo[axis] <= box.hi[axis]) & (box.lo[axis] <= own.hi[axis]);
      }
      meeting_[count] = near_[n];
      count += meets ? 1 : 0;
    }
    meeting_.resize(count);
  }

  std::optional<EdgeCrossing> crossing(int from, int to, std::size_t own) const {
    const Segment edge{wall_.vertices()[at(from)], wall_.vertices()[at(to)]};
    for (const int n : meeting_) {
      const Wall::Triangle& t = triangles_[at(n)];
      const bool is_joined = std::ranges::any_of(t, [&](int v) { return v == from || v == to; });
      const bool is_own = !part_.empty() && part_[at(t[0])] == part_[at(from)];
      if (is_joined || is_own || !parts(wall_.geometry()[at(n)], edge)) continue;
      const std::optional<double> after = crossing_of(wall_, edge, n);
      if (!after) continue;
      return EdgeCrossing{
          {from, to}, static_cast<int>(own), n, edge.from + *after * (edge.to - edge.from)};
    }
    return {};
  }

  /// Whether a triangle's plane lies between the ends of an edge, which costs little to see.
  static bool parts(const TriangleGeometry& t, const Segment& edge) {
    const Vec3 normal = t.ab.cross(t.ac);
    return (normal.dot(edge.from - t.a) < 0) != (normal.dot(edge.to - t.a) < 0);
  }

  const Wall& wall_;
  std::span<const Wall::Triangle> triangles_;
  std::span<const int> part_;
  std::vector<TriangleRun> runs_;
  std::vector<int> near_;
  std::vector<int> meeting_;
  std::vector<Box> boxes_;
};

}  // namespace

std::vector<EdgeCrossing> edge_crossings(const Wall& wall, std::span<const int> part) {
  const std::size_t count = wall.triangles().size();
  std::vector<std::vector<EdgeCrossing>> found((count + kTogether - 1) / kTogether);
  parallel::for_ranges(found.size(), 16, [&](std::size_t begin, std::size_t end) {
    Search search(wall, part);
    for (std::size_t n = begin; n < end; ++n) {
      found[n] = search.run(n * kTogether, std::min(count, (n + 1) * kTogether));
    }
  });
  std::vector<EdgeCrossing> all;
  for (const auto& here : found) all.insert(all.end(), here.begin(), here.end());
  return all;
}

SelfCrossing find_self_crossing(const Wall& wall) {
  const std::vector<EdgeCrossing> found = edge_crossings(wall);
  if (found.empty()) return {};
  return {found.size(), found.front().place_world};
}

}  // namespace vdb_offset
