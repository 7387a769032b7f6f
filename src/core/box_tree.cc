// Wald, On fast construction of SAH-based bounding volume hierarchies, 2007.

#include "core/box_tree.h"

#include <algorithm>

namespace vdb_offset {

namespace {

constexpr std::size_t kMostBins = 16;
// Below this depth splits fall back to the median, which bounds the depth by the number's bits.
constexpr int kMedianDepth = 64;

/// x, y, z of a coordinate scaled to [0, 1], and one unused. Where to split needs no more digits:
/// the nodes' boxes are found in double afterwards.
using Four = float __attribute__((vector_size(16)));

Four least(const Four& a, const Four& b) { return a < b ? a : b; }
Four most(const Four& a, const Four& b) { return a > b ? a : b; }

struct SmallBox {
  Four lo{2, 2, 2, 2};
  Four hi{-2, -2, -2, -2};

  void add(const SmallBox& other) {
    lo = least(lo, other.lo);
    hi = most(hi, other.hi);
  }
  float half_area() const {
    const Four e = hi - lo;
    return e[0] < 0 ? 0 : e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }
};

struct Item {
  SmallBox box;
  int primitive;

  Four twice_centre() const { return box.lo + box.hi; }
};

struct Bin {
  SmallBox box;
  std::size_t count = 0;
};
using Bins = std::array<Bin, kMostBins>;

/// The first bin of the right part, by the surface areas of both.
std::size_t best_plane(const Bins& bins, std::size_t used) {
  std::array<float, kMostBins> right{};
  SmallBox box;
  std::size_t count = 0;
  for (std::size_t b = used - 1; b > 0; --b) {
    box.add(bins[b].box);
    count += bins[b].count;
    right[b] = box.half_area() * static_cast<float>(count);
  }
  box = SmallBox();
  count = 0;
  std::size_t best = 1;
  float best_cost = 1e30F;
  for (std::size_t b = 1; b < used; ++b) {
    box.add(bins[b - 1].box);
    count += bins[b - 1].count;
    const float cost = box.half_area() * static_cast<float>(count) + right[b];
    if (cost < best_cost) {
      best_cost = cost;
      best = b;
    }
  }
  return best;
}

/// As std::partition does, which leaves the same order; where the left part ends is known here. The
/// misplaced are looked for without branches, which would be guessed wrong every other time
/// (Edelkamp and Weiss, BlockQuicksort, 2016).
template <typename IsLeft>
void partition(Item* first, Item* middle, Item* last, const IsLeft& is_left) {
  constexpr std::ptrdiff_t kBlock = 64;
  std::array<Item*, kBlock> from_left, from_right;
  std::size_t lefts = 0, rights = 0, l = 0, r = 0;
  Item* left = first;
  Item* right = last;
  while (true) {
    if (l == lefts) {
      l = lefts = 0;
      for (Item* const end = left + std::min(kBlock, middle - left); left < end; ++left) {
        from_left[lefts] = left;
        lefts += is_left(*left) ? 0 : 1;
      }
    }
    if (r == rights) {
      r = rights = 0;
      for (Item* const end = right - std::min(kBlock, right - middle); right > end;) {
        from_right[rights] = --right;
        rights += is_left(*right) ? 1 : 0;
      }
    }
    for (; l < lefts && r < rights; ++l, ++r) std::swap(*from_left[l], *from_right[r]);
    if ((l == lefts && left == middle) || (r == rights && right == middle)) return;
  }
}

/// Where the right part of the items begins, after putting them in order.
Item* split(Item* first, Item* last, int depth) {
  SmallBox centres{Four{4, 4, 4, 4}, Four{-4, -4, -4, -4}};
  for (const Item* item = first; item < last; ++item) {
    centres.lo = least(centres.lo, item->twice_centre());
    centres.hi = most(centres.hi, item->twice_centre());
  }
  const Four extent = centres.hi - centres.lo;
  const int long_of_two = extent[0] >= extent[1] ? 0 : 1;
  const int axis = extent[long_of_two] >= extent[2] ? long_of_two : 2;
  const auto count = static_cast<std::size_t>(last - first);
  if (depth < kMedianDepth && extent[axis] > 0) {
    const std::size_t used = std::clamp<std::size_t>(count / 4, 4, kMostBins);
    const float factor = static_cast<float>(used) * 0.9999F / extent[axis];
    const float lo = centres.lo[axis];
    const auto bin_of = [&](const Item& item) {
      return static_cast<std::size_t>((item.twice_centre()[axis] - lo) * factor);
    };
    Bins bins;
    for (const Item* item = first; item < last; ++item) {
      Bin& bin = bins[bin_of(*item)];
      bin.box.add(item->box);
      ++bin.count;
    }
    const std::size_t plane = best_plane(bins, used);
    Item* middle = first;
    for (std::size_t b = 0; b < plane; ++b) middle += bins[b].count;
    partition(first, middle, last, [&](const Item& item) { return bin_of(item) < plane; });
    if (middle > first && middle < last) return middle;
  }
  Item* const middle = first + count / 2;
  std::nth_element(first, middle, last, [&](const Item& a, const Item& b) {
    const float ca = a.twice_centre()[axis];
    const float cb = b.twice_centre()[axis];
    return ca < cb || (ca == cb && a.primitive < b.primitive);
  });
  return middle;
}

LargeVector<Item> items_of(const LargeVector<Box>& boxes) {
  Box all;
  for (const Box& box : boxes) all.add(box);
  const double size = (all.hi - all.lo).maxCoeff();
  const double scale = size > 0 ? 1 / size : 0.0;
  const auto small = [&](const Vec3& p) {
    const Vec3 q = scale * (p - all.lo);
    return Four{static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), 0};
  };
  LargeVector<Item> items(boxes.size());
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    items[n] = {{small(boxes[n].lo), small(boxes[n].hi)}, static_cast<int>(n)};
  }
  return items;
}

}  // namespace

void BoxTree::build(void* items, std::size_t first, std::size_t last, int depth) {
  const std::size_t at = nodes_.size();
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), static_cast<std::uint32_t>(first),
                    static_cast<std::uint32_t>(last - first)});
  if (last - first <= kLeaf) return;
  auto* const all = static_cast<Item*>(items);
  const auto middle = static_cast<std::size_t>(split(all + first, all + last, depth) - all);
  build(items, first, middle, depth + 1);
  nodes_[at].link = static_cast<std::uint32_t>(nodes_.size());
  nodes_[at].count = 0;
  build(items, middle, last, depth + 1);
}

/// Children stand after their parent. Nearest points are rounded, and may leave the exact box.
void BoxTree::find_boxes(const LargeVector<Box>& boxes, const LargeVector<int>& order) {
  Box all;
  for (const Box& box : boxes) all.add(box);
  pad_ = kCoordinateRounding * all.lo.cwiseAbs().cwiseMax(all.hi.cwiseAbs()).maxCoeff();
  for (std::size_t at = nodes_.size(); at-- > 0;) {
    Node& node = nodes_[at];
    Box box;
    for (std::uint32_t p = 0; p < node.count; ++p) {
      box.add(boxes[static_cast<std::size_t>(order[node.link + p])]);
    }
    if (node.count > 0) {
      box.lo.array() -= pad_;
      box.hi.array() += pad_;
    } else {
      box.add(Box{nodes_[at + 1].lo, nodes_[at + 1].hi});
      box.add(Box{nodes_[node.link].lo, nodes_[node.link].hi});
    }
    node.lo = box.lo;
    node.hi = box.hi;
  }
}

BoxTree::BoxTree(const LargeVector<Box>& boxes, LargeVector<int>& order) {
  order.clear();
  if (boxes.empty()) return;
  LargeVector<Item> items = items_of(boxes);
  nodes_.reserve(boxes.size());
  build(items.data(), 0, items.size(), 0);
  order.reserve(items.size());
  for (const Item& item : items) order.push_back(item.primitive);
  find_boxes(boxes, order);
}

}  // namespace vdb_offset
