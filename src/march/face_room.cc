// Columns end before the medial axis, but cells between them may not: where a face is wide beside a
// gap, what faces it may stand between its nodes, or its outer level, flat from node to node, go
// through a medial axis that bends.
//
// Which faces to look at. Of a column that met nothing the ball about its end that touches its foot
// is empty (the gradient line goes on to its end: its own wall is the nearest all along). With
// columns of height R a width 2 w apart the balls leave no more than a gap of w^2 / (2 R) over the
// wall between them: nothing stands there that is no smaller than that. Faces are looked at if a
// column of theirs met something, or if w is more than kWide R: that gap is then kWide^2 / 2 = 2 %
// of R.
//
// Where outer levels first meet as layers grow, they go against each other: the way from a point of
// the one is in the cone of normals around the other's. So it is enough to look at faces whose
// columns do not go the same way, and neighbours on one wall are passed over at once.

#include "vdb_offset/march/face_room.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/box_tree.h"
#include "core/hulls.h"
#include "core/parallel.h"
#include "march/ridge.h"
#include "march/stacks.h"
#include "march/wall_search.h"

namespace vdb_offset {
namespace {

constexpr double kWide = 0.2;
constexpr double kSameWay = 0.5;  // cosine between columns of faces that do not face each other
constexpr double kUpper = 0.8;    // of columns that met something only their ends come near others
constexpr double kRounding = 1e-3;  // of heights, that layers without a margin keep from each other
constexpr double kLeast = 0.02;     // part of the margin that columns have to leave
constexpr double kTolerance = 1e-2;  // of a height
constexpr double kOwn = 0.5;         // of a height, that no other wall is nearer than
constexpr double kNoRoom = 1e-6;     // of a height: walls meet
constexpr std::size_t kGrain = 64;   // faces

std::size_t at(int index) { return static_cast<std::size_t>(index); }

bool meet(const Box& a, const Box& b) {
  return (a.lo.array() <= b.hi.array()).all() && (b.lo.array() <= a.hi.array()).all();
}

enum class Look : char { No, AtEnds, Whole };

Look look_at(const Stacks& stacks, const Layers& layers, const WallFace& face) {
  double reach = std::numeric_limits<double>::infinity();
  bool met = false;
  for (const int node : face.node) {
    const Stop stop = layers.stop[at(node)];
    reach = std::min(reach, layers.asked_world[at(node)]);
    met = met || !(stop == Stop::Reached || stop == Stop::Limited || stop == Stop::Internal);
  }
  if (stacks.width(face) > kWide * reach) return Look::Whole;
  return met ? Look::AtEnds : Look::No;
}

std::vector<Look> looks_at(const Stacks& stacks, const Layers& layers) {
  std::vector<Look> looks(stacks.faces().size());
  parallel::for_ranges(looks.size(), 16 * kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      looks[f] = look_at(stacks, layers, stacks.faces()[f]);
    }
  });
  return looks;
}

/// Faces of one kind and what they are looked for among: boxes of those that are near any.
class Finder {
 public:
  Finder(const Stacks& stacks, const std::vector<Look>& looks, Look kind)
      : stacks_(stacks), looks_(looks), kind_(kind), from_(kind == Look::Whole ? 0 : kUpper) {
    Box around;
    for (std::size_t f = 0; f < looks.size(); ++f) {
      if (looks[f] != kind) continue;
      from_faces_.push_back(f);
      around.add(box(f));
    }
    if (from_faces_.empty()) return;
    for (std::size_t f = 0; f < looks.size(); ++f) {
      if (kind == Look::AtEnds && looks[f] == Look::Whole) continue;
      const Box own = box(f);
      if (!meet(own, around)) continue;
      boxes_.push_back(own);
      among_.push_back(f);
    }
    tree_.emplace(boxes_, order_);
  }

  /// Pairs that meet, in the order of their faces.
  void find(std::vector<FacePair>& found) const {
    std::vector<std::vector<FacePair>> pairs(from_faces_.size());
    parallel::for_ranges(pairs.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) find_of(from_faces_[n], pairs[n]);
    });
    for (const auto& some : pairs) found.insert(found.end(), some.begin(), some.end());
  }

 private:
  Box box(std::size_t face) const { return stacks_.box(stacks_.faces()[face], from_); }

  /// visit(face) for all whose boxes do.
  template <typename Visit>
  void for_boxes_meeting(const Box& own, const Visit& visit) const {
    tree_->near_box(own, 0, [&](std::uint32_t first, std::uint32_t last, const Box&) {
      for (std::uint32_t position = first; position < last; ++position) {
        const std::size_t n = at(order_[position]);
        if (meet(boxes_[n], own)) visit(among_[n]);
      }
      return false;
    });
  }

  void find_of(std::size_t f, std::vector<FacePair>& found) const {
    constexpr double kAll = std::numeric_limits<double>::infinity();
    const WallFace& face = stacks_.faces()[f];
    const Vec3 direction = stacks_.direction(face);
    const StackPoints points = stacks_.points(face, kAll);
    for_boxes_meeting(box(f), [&](std::size_t g) {
      const WallFace& other = stacks_.faces()[g];
      if (g == f || (looks_[g] == kind_ && g < f)) return;
      if (direction.dot(stacks_.direction(other)) > kSameWay) return;
      if (stacks_.are_joined(face, other)) return;
      if (are_apart(points.span(), stacks_.points(other, kAll).span())) return;
      found.push_back({face, other});
    });
  }

  const Stacks& stacks_;
  const std::vector<Look>& looks_;
  Look kind_;
  double from_;
  std::vector<std::size_t> from_faces_, among_;
  LargeVector<Box> boxes_;  // of those among which
  LargeVector<int> order_;  // of the tree's leaves
  std::optional<BoxTree> tree_;
};

std::vector<FacePair> find_pairs(const Stacks& stacks, const Layers& layers) {
  const std::vector<Look> looks = looks_at(stacks, layers);
  std::vector<FacePair> pairs;
  for (const Look kind : {Look::Whole, Look::AtEnds}) {
    Finder(stacks, looks, kind).find(pairs);
  }
  return pairs;
}

/// The most height up to which two stacks do not meet; none where their walls do.
std::optional<double> room_between(const Stacks& stacks, const FacePair& pair) {
  double hi = std::max(stacks.top(pair.first), stacks.top(pair.second));
  const double least = kNoRoom * hi;
  double lo = 0;
  while (hi > least && hi - lo > kTolerance * lo) {
    const double height = 0.5 * (lo + hi);
    (stacks.are_apart(pair, height) ? lo : hi) = height;
  }
  return lo > least ? std::optional(lo) : std::nullopt;
}

/// Whether two stacks that nearly meet at a height do not so over the bisector of a corner.
bool face_each_other(const Stacks& stacks, const FacePair& pair, double height_world,
                     WallSearch& search) {
  const HullGap gap = hull_gap(stacks.points(pair.first, height_world).span(),
                               stacks.points(pair.second, height_world).span());
  const Vec3 between = 0.5 * (gap.first + gap.second);
  const auto way_from = [&](const WallFace& face) {
    return Vec3(between - hull_gap({&between, 1}, stacks.feet(face).span()).second);
  };
  const Vec3 near = way_from(pair.first);
  const Vec3 far = way_from(pair.second);
  const double height = std::min(near.norm(), far.norm());
  const double nearest = height > 0 ? search.nearest(between).distance_world : 0;
  if (!(nearest > kOwn * height)) return false;  // what is between is another wall's
  const Ridge ridge{0, height, between, near.normalized(), far.normalized()};
  return ridge.away_near.dot(ridge.away_far) <= kSameFront && faces(search, ridge);
}

}  // namespace

std::vector<FacePair> facing_stacks(const Surface& surface, const Layers& layers, double stretch) {
  return find_pairs(Stacks(surface, layers, stretch), layers);
}

std::vector<double> face_room(const Surface& surface, const Layers& layers, double gap_margin) {
  const Stacks bent(surface, layers, (1 - kRounding) / (1 - kLeast * gap_margin));
  const std::vector<FacePair> pairs = find_pairs(bent, layers);
  if (pairs.empty()) return {};
  const Stacks stacks(surface, layers, (1 - kRounding) / (1 - gap_margin));
  std::vector<double> room(pairs.size(), std::numeric_limits<double>::infinity());
  parallel::for_ranges(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      WallSearch search(*surface.wall, surface.boundaries.get());  // one that remembers nothing
      if (!stacks.is_upright(pairs[n].first) || !stacks.is_upright(pairs[n].second)) continue;
      const auto most = room_between(stacks, pairs[n]);
      if (most && face_each_other(stacks, pairs[n], *most, search)) room[n] = *most;
    }
  });
  std::vector<double> heights;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    const double most = (1 - gap_margin) * room[n];
    for (const WallFace& face : {pairs[n].first, pairs[n].second}) {
      for (const int node : face.node) {
        if (!(most < layers.height_world[at(node)])) continue;
        if (heights.empty()) {
          heights.resize(layers.height_world.size(), std::numeric_limits<double>::infinity());
        }
        heights[at(node)] = std::min(heights[at(node)], most);
      }
    }
  }
  return heights;
}

}  // namespace vdb_offset
