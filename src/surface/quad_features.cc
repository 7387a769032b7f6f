// Extra columns at sharp edges open from the sides of patches, which are split for them along
// whole grid lines; and a face of a body is what its owner wants to see as a patch. So features are
// borders where that costs no border elsewhere: a line that ends within the surface would have to
// be led on through smooth wall, and stays inside a patch instead.

#include "surface/quad_features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

class Turns {
 public:
  explicit Turns(const QuadEdges& edges) : edges_(edges), turn_(at(edges.size()), 0.0F) {
    Vec3List normal;
    for (int f = 0; f < edges.size() / 4; ++f) normal.push_back(normal_of(f));
    for (int h = 0; h < edges.size(); ++h) {
      if (edges.twin_of(h) < 0) continue;
      const Vec3& a = normal[at(h / 4)];
      const Vec3& b = normal[at(edges.twin_of(h) / 4)];
      turn_[at(h)] = static_cast<float>(std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }
  bool is_sharp(int h, double limit) const {
    const float turn = turn_[at(h)];
    if (!(turn > limit)) return false;
    const float before = turn_[at(QuadEdges::opposite(h))];
    const float after = turn_[at(QuadEdges::opposite(edges_.twin_of(h)))];
    return std::min(before, after) < turn / 2;
  }

 private:
  Vec3 normal_of(int face) const {
    const auto corner = [&](int s) -> const Vec3& {
      return edges_.place(edges_.from(4 * face + s));
    };
    return (corner(2) - corner(0)).cross(corner(3) - corner(1));
  }
  const QuadEdges& edges_;
  std::vector<float> turn_;
};

/// A line of sharp edges, as half-edges one after another.
using Run = std::vector<int>;

class Features {
 public:
  Features(const QuadEdges& edges, QuadCuts& cuts, std::vector<char> sharp)
      : edges_(edges), cuts_(cuts), sharp_(std::move(sharp)) {}

  FeatureCount keep() {
    find_runs();
    drop_loose();
    FeatureCount count{0, loose_};
    for (const Run& run : runs_) count.kept += static_cast<int>(run.size());
    return count;
  }

 private:
  bool is_sharp(int h) const { return sharp_[at(h)] != 0; }

  /// The sharp half-edge that goes straight on where h ends, -1 for none.
  int follow(int h) const {
    if (!edges_.is_regular(edges_.to(h))) return -1;
    const int on = edges_.straight_on(h);
    return is_sharp(on) ? on : -1;
  }

  void find_runs() {
    std::vector<char> taken(sharp_.size(), 0);
    for (int h = 0; h < edges_.size(); ++h) {
      if (!is_sharp(h) || taken[at(h)] != 0) continue;
      int first = edges_.twin_of(h);
      for (int on = follow(first); on >= 0 && on != edges_.twin_of(h); on = follow(on)) first = on;
      first = edges_.twin_of(first);
      Run run;
      for (int on = first; on >= 0 && taken[at(on)] == 0; on = follow(on)) {
        taken[at(on)] = taken[at(edges_.twin_of(on))] = 1;
        run.push_back(on);
        cuts_.set(edges_, on, Cut::Kept);
      }
      runs_.push_back(std::move(run));
    }
  }

  /// Whether a line may end where h ends: there is more than a regular grid of one patch.
  bool may_end(int h) const {
    if (!edges_.is_regular(edges_.to(h))) return true;
    return cuts_.is_cut(QuadEdges::next(h)) ||
           cuts_.is_cut(QuadEdges::previous(edges_.twin_of(h))) ||
           cuts_.is_cut(edges_.straight_on(h));
  }

  /// Gives up lines that end within a patch; others that ended on them follow.
  void drop_loose() {
    for (bool again = true; again;) {
      again = false;
      std::erase_if(runs_, [&](const Run& run) {
        if (may_end(run.back()) && may_end(edges_.twin_of(run.front()))) return false;
        for (const int h : run) cuts_.set(edges_, h, Cut::None);
        loose_ += static_cast<int>(run.size());
        again = true;
        return true;
      });
    }
  }

  const QuadEdges& edges_;
  QuadCuts& cuts_;
  std::vector<char> sharp_;
  std::vector<Run> runs_;
  int loose_ = 0;
};

}  // namespace

FeatureCount keep_features(const QuadEdges& edges, double feature_turn, QuadCuts& cuts) {
  if (feature_turn >= std::numbers::pi) return {};
  const Turns turns(edges);
  std::vector<char> sharp(at(edges.size()), 0);
  for (int h = 0; h < edges.size(); ++h) {
    if (!cuts.is_cut(h) && turns.is_sharp(h, feature_turn)) sharp[at(h)] = 1;
  }
  return Features(edges, cuts, std::move(sharp)).keep();
}

}  // namespace vdb_offset
