// A patch may join what lies beyond one of its sides if that side is made up of whole sides of
// others: one, and the border goes; or several, and the lines between them run on through the
// patch. Either way there is one patch fewer. Points inside such a side are regular, or corners of
// what lies beyond: no irregular point comes inside a patch.

#include "surface/quad_merge.h"

#include <algorithm>
#include <queue>

namespace vdb_offset {

namespace {

class Merger {
 public:
  Merger(const QuadEdges& edges, QuadCuts& cuts)
      : edges_(edges), cuts_(cuts), name_(static_cast<std::size_t>(edges.size()), -1) {
    for (int h = 0; h < edges_.size(); ++h) {
      if (cuts_.is_corner(h) && name_of(h) < 0) name(h);
    }
  }

  /// Merges until nothing in the queue can be; returns whether anything was.
  bool round() {
    for (int h = 0; h < edges_.size(); ++h) {
      if (cuts_.is_corner(h)) push(h);
    }
    bool any = false;
    while (!queue_.empty()) {
      const Candidate best = queue_.top();
      queue_.pop();
      const std::vector<int> side = joinable(best.corner);
      if (side.empty()) continue;
      const Candidate now = candidate(side);
      if (now.lines != best.lines || now.length != best.length) {
        queue_.push(now);
        continue;
      }
      join(side);
      any = true;
    }
    return any;
  }

 private:
  struct Candidate {
    int corner;  // the half-edge that the side begins with
    int lines;   // that run on through the patch
    int length;
  };
  struct Worse {
    const QuadEdges& edges;
    bool operator()(const Candidate& a, const Candidate& b) const {
      if (a.lines != b.lines) return a.lines > b.lines;
      if (a.length != b.length) return a.length < b.length;
      const int p = edges.from(a.corner);
      const int q = edges.from(b.corner);
      if (p != q) return edges.before(q, p);
      return edges.before(edges.to(b.corner), edges.to(a.corner));
    }
  };

  /// Whether the patch beyond side half-edge h has a corner where h ends.
  bool is_met(int h) const { return cuts_.is_cut(QuadEdges::previous(edges_.twin_of(h))); }
  /// Whether it has one where h begins.
  bool begins_met(int h) const { return cuts_.is_cut(QuadEdges::next(edges_.twin_of(h))); }

  /// Whether within the side patches beyond end in corners, or go on in a regular grid.
  bool is_regular(const std::vector<int>& side) const {
    for (std::size_t n = 0; n + 1 < side.size(); ++n) {
      const bool met = is_met(side[n]);
      if (met != begins_met(side[n + 1])) return false;
      if (!met && !edges_.is_regular(edges_.to(side[n]))) return false;
    }
    return true;
  }

  Candidate candidate(const std::vector<int>& side) const {
    const auto lines =
        std::count_if(side.begin(), side.end() - 1, [&](int h) { return is_met(h); });
    return {side.front(), static_cast<int>(lines), static_cast<int>(side.size())};
  }

  void push(int corner) {
    const std::vector<int> side = joinable(corner);
    if (!side.empty()) queue_.push(candidate(side));
  }

  /// The side that begins with a corner half-edge; empty if its patch cannot join what is beyond.
  std::vector<int> joinable(int corner) const {
    if (!cuts_.is_corner(corner) || edges_.twin_of(corner) < 0) return {};
    if (!begins_met(corner)) return {};
    std::vector<int> side = side_from(edges_, cuts_, corner);
    if (std::ranges::any_of(side, [&](int h) { return cuts_.is_kept(h); })) return {};
    if (!is_met(side.back()) || !is_regular(side)) return {};
    std::vector<int> patches{name_of(corner)};
    for (const int h : side) {
      // Every patch beyond has one of its corners where h ends, or its side goes on.
      if (is_met(h)) patches.push_back(name_of(edges_.twin_of(h)));
    }
    std::sort(patches.begin(), patches.end());
    const bool distinct = std::adjacent_find(patches.begin(), patches.end()) == patches.end();
    return distinct ? side : std::vector<int>();
  }

  int name_of(int corner) const { return name_[static_cast<std::size_t>(corner)]; }

  /// Calls visit(h) for the corner half-edges of a patch, by any of them.
  template <typename Visit>
  void for_corners(int corner, const Visit& visit) const {
    int h = corner;
    do {
      visit(h);
      h = next_side(h);
    } while (h != corner);
  }

  void name(int corner) {
    for_corners(corner, [&](int h) { name_[static_cast<std::size_t>(h)] = corner; });
  }

  void join(const std::vector<int>& side) {
    // Corners of the patches to come, known by the far sides of those that there are beyond.
    std::vector<int> far;
    for (const int h : side) {
      if (is_met(h)) far.push_back(next_side(next_side(edges_.twin_of(h))));
    }
    for (std::size_t n = 0; n + 1 < side.size(); ++n) {
      if (is_met(side[n])) run_on(side[n]);
    }
    for (const int h : side) cuts_.set(edges_, h, Cut::None);
    for (const int corner : far) name(corner);
    for (const int corner : far) {
      for_corners(corner, [&](int h) { push(h); });
    }
  }

  int next_side(int corner) const {
    return QuadEdges::next(side_from(edges_, cuts_, corner).back());
  }

  /// Leads the line that ends where side half-edge h ends across the patch.
  void run_on(int h) {
    int on = QuadEdges::next(h);
    cuts_.set(edges_, on, Cut::Trace);
    while (!cuts_.is_cut(QuadEdges::next(on))) {
      on = edges_.straight_on(on);
      cuts_.set(edges_, on, Cut::Trace);
    }
  }

  const QuadEdges& edges_;
  QuadCuts& cuts_;
  std::vector<int> name_;  // of the patch that each corner half-edge belongs to: one of them
  std::priority_queue<Candidate, std::vector<Candidate>, Worse> queue_{Worse{edges_}};
};

}  // namespace

std::vector<int> side_from(const QuadEdges& edges, const QuadCuts& cuts, int corner) {
  std::vector<int> side{corner};
  while (!cuts.is_cut(QuadEdges::next(side.back()))) side.push_back(edges.straight_on(side.back()));
  return side;
}

void merge_patches(const QuadEdges& edges, QuadCuts& cuts) {
  Merger merger(edges, cuts);
  while (merger.round()) {
  }
}

}  // namespace vdb_offset
