#include "surface/flat_overlaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/parallel.h"
#include "surface/joined_cells.h"

namespace vdb_offset {
namespace {

constexpr double kBeside = 1e-4;  // in parts of an edge: nearer than walls of a mesh lie

std::size_t at(int n) { return static_cast<std::size_t>(n); }

constexpr int kUnseen = -1;
constexpr int kOpen = -2;

/// Of a curve, layers on its right.
struct FlatEdge {
  int from, to;  // nodes of the near plane
  int patch;
  int part = kUnseen;
};

/// One edge a cell, seen from the far plane.
std::vector<FlatEdge> edges_of(const Surface& surface) {
  std::vector<FlatEdge> edges;
  for_joined_cells(surface, [&](int patch, const std::array<int, 4>& c) {
    const auto z = [&](std::size_t n) { return surface.nodes_world[at(c[n])].z(); };
    // Two corners in a row lie in the near plane.
    for (std::size_t n = 0; n < 4; ++n) {
      if (z(n) == z((n + 1) % 4) && z(n) < z((n + 2) % 4) && c[n] != c[(n + 1) % 4]) {
        edges.push_back({c[n], c[(n + 1) % 4], patch});
      }
    }
  });
  return edges;
}

/// Numbers closed curves from 0, and drops the edges of others; returns how many there are.
int keep_closed(std::vector<FlatEdge>& edges) {
  std::map<int, std::vector<std::size_t>> starting;
  for (std::size_t e = 0; e < edges.size(); ++e) starting[edges[e].from].push_back(e);
  int parts = 0;
  for (std::size_t first = 0; first < edges.size(); ++first) {
    if (edges[first].part != kUnseen) continue;
    std::vector<std::size_t> way{first};
    while (edges[way.back()].to != edges[first].from && way.size() <= edges.size()) {
      const auto next = starting.find(edges[way.back()].to);
      if (next == starting.end() || next->second.size() != 1) break;
      if (edges[next->second.front()].part != kUnseen) break;
      way.push_back(next->second.front());
    }
    const bool is_closed = edges[way.back()].to == edges[first].from;
    for (const std::size_t e : way) edges[e].part = is_closed ? parts : kOpen;
    parts += is_closed ? 1 : 0;
  }
  std::erase_if(edges, [](const FlatEdge& edge) { return edge.part < 0; });
  return parts;
}

class FlatFinder {
 public:
  FlatFinder(const Vec3List& nodes, std::vector<FlatEdge> edges, int parts)
      : nodes_(nodes), edges_(std::move(edges)), boxes_(at(parts)) {
    for (const FlatEdge& edge : edges_) boxes_[at(edge.part)].add(nodes_[at(edge.from)]);
  }

  std::vector<Overlap> find() const {
    std::vector<int> other(edges_.size(), -1);
    parallel::for_ranges(edges_.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e) other[e] = other_around(edges_[e]);
    });
    std::map<int, Overlap> found;  // of each part
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (other[e] < 0) continue;
      const auto first = std::ranges::find(edges_, other[e], &FlatEdge::part);
      const Overlap one{edges_[e].patch, first->patch, beside(edges_[e]), 0};
      ++found.try_emplace(edges_[e].part, one).first->second.faces;
    }
    std::vector<Overlap> out;
    for (const auto& [part, overlap] : found) out.push_back(overlap);
    return out;
  }

 private:
  /// A point on an edge's right.
  Vec3 beside(const FlatEdge& edge) const {
    const Vec3& a = nodes_[at(edge.from)];
    const Vec3 along = nodes_[at(edge.to)] - a;
    return a + 0.5 * along + kBeside * Vec3(along.y(), -along.x(), 0);
  }

  bool is_in_other_box(const Vec3& place, int own) const {
    for (std::size_t b = 0; b < boxes_.size(); ++b) {
      const Box& box = boxes_[b];
      if (static_cast<int>(b) == own) continue;
      if (place.x() >= box.lo.x() && place.y() >= box.lo.y() && place.x() <= box.hi.x() &&
          place.y() <= box.hi.y()) {
        return true;
      }
    }
    return false;
  }

  /// The curve whose solid, or outside, an edge's layers lie in; -1 for none.
  int other_around(const FlatEdge& edge) const {
    const Vec3 place = beside(edge);
    if (!is_in_other_box(place, edge.part)) return -1;
    std::vector<double> turns(boxes_.size(), 0);
    double sum = 0;
    for (const FlatEdge& one : edges_) {
      const Vec3 a = nodes_[at(one.from)] - place;
      const Vec3 b = nodes_[at(one.to)] - place;
      const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
      turns[at(one.part)] += angle / (2 * std::numbers::pi);
      sum += angle / (2 * std::numbers::pi);
    }
    if (sum <= 0.5 && sum >= -1.5) return -1;
    turns[at(edge.part)] = 0;
    const auto most = std::ranges::max_element(turns, {}, [](double a) { return std::abs(a); });
    return std::abs(*most) > 0.5 ? static_cast<int>(most - turns.begin()) : -1;
  }

  const Vec3List& nodes_;
  std::vector<FlatEdge> edges_;
  std::vector<Box> boxes_;  // of parts
};

}  // namespace

std::vector<Overlap> find_flat_overlaps(const Surface& surface) {
  std::vector<FlatEdge> edges = edges_of(surface);
  const int parts = keep_closed(edges);
  if (parts < 2) return {};
  return FlatFinder(surface.nodes_world, std::move(edges), parts).find();
}

}  // namespace vdb_offset
