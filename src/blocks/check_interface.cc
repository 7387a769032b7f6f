#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "blocks/check_faces.h"

namespace vdb_offset {
namespace {

using Index = std::array<int, 3>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Why a transform does not take the one range to the other and through the face; empty: it does.
std::string transform_fault(const Interface& interface) {
  std::array<bool, 3> used{};
  for (std::size_t n = 0; n < 3; ++n) {
    const int direction = interface.transform[n];
    const auto m = static_cast<std::size_t>(std::abs(direction)) - 1;
    if (direction == 0 || std::abs(direction) > 3 || used[m]) {
      return "is no signed permutation of 1, 2, 3";
    }
    used[m] = true;
    const int length = interface.first.end[n] - interface.first.begin[n];
    const int donor = interface.second.end[m] - interface.second.begin[m];
    if (donor != (direction > 0 ? length : -length)) {
      return fmt::format(
          "does not take the one range to the other: {} steps along {} to {} along {}", length,
          "ijk"[n], donor, "ijk"[m]);
    }
  }
  const bool is_opposite = is_max(interface.first.face) != is_max(interface.second.face);
  const int through = static_cast<int>(axis_of(interface.second.face)) + 1;
  if (interface.transform[axis_of(interface.first.face)] == (is_opposite ? through : -through)) {
    return {};
  }
  return "does not lead through the face from inside to inside";
}

/// The shortest edge that has a length, of those that end in a point.
double shortest_edge(const Zone& zone, const Index& at) {
  double shortest = kInfinity;
  const Index sizes = sizes_of(zone);
  for (std::size_t a = 0; a < 3; ++a) {
    for (const int step : {-1, 1}) {
      Index next = at;
      next[a] += step;
      if (next[a] < 0 || next[a] >= sizes[a]) continue;
      const Vec3 along = zone.at(next[0], next[1], next[2]) - zone.at(at[0], at[1], at[2]);
      const double length = along.norm();
      if (length > 0) shortest = std::min(shortest, length);
    }
  }
  return shortest;
}

/// Walks over the points of an interface, begin to begin and end to end.
class Walk {
 public:
  Walk(const ZoneMesh& mesh, const Interface& interface)
      : interface_(interface),
        first_(mesh.zones[static_cast<std::size_t>(interface.first.block)]),
        second_(mesh.zones[static_cast<std::size_t>(interface.second.block)]) {}

  void run() {
    const BlockRange range = ascending(interface_.first);
    Index p{};
    for (p[2] = range.begin[2]; p[2] <= range.end[2]; ++p[2]) {
      for (p[1] = range.begin[1]; p[1] <= range.end[1]; ++p[1]) {
        for (p[0] = range.begin[0]; p[0] <= range.end[0]; ++p[0]) compare(p, donor_of(p));
      }
    }
  }

  std::uint64_t points = 0;
  std::uint64_t apart = 0;
  double match_distance = 0;
  double distance = -1;  ///< of those apart, the largest
  Index at{0, 0, 0};

 private:
  Index donor_of(const Index& p) const {
    Index donor = interface_.second.begin;
    for (std::size_t n = 0; n < 3; ++n) {
      const int a = interface_.transform[n];
      donor[static_cast<std::size_t>(std::abs(a)) - 1] +=
          (a > 0 ? 1 : -1) * (p[n] - interface_.first.begin[n]);
    }
    return donor;
  }

  void compare(const Index& p, const Index& q) {
    ++points;
    const Vec3& a = first_.at(p[0], p[1], p[2]);
    const Vec3& b = second_.at(q[0], q[1], q[2]);
    if (a == b) return;
    const double gap = (a - b).norm();
    const double edge = std::min(shortest_edge(first_, p), shortest_edge(second_, q));
    if (gap <= kMatchTolerance * edge) {
      match_distance = std::max(match_distance, gap);
      return;
    }
    ++apart;
    const double size = std::isfinite(gap) ? gap : kInfinity;
    if (size <= distance) return;
    distance = size;
    at = p;
  }

  const Interface& interface_;
  const Zone& first_;
  const Zone& second_;
};

std::string named(const Interface& interface) {
  return interface.name.empty() ? "interface" : "interface '" + interface.name + "'";
}

}  // namespace

InterfaceCheck check_interface(const ZoneMesh& mesh, const Interface& interface) {
  InterfaceCheck found;
  const std::string both =
      fmt::format("{} of {} and {}", named(interface), place_in_words(mesh, interface.first),
                  place_in_words(mesh, interface.second));
  const std::string why = transform_fault(interface);
  if (!why.empty()) {
    found.faults.push_back(
        {FaultKind::Transform,
         fmt::format("{}: transform ({}) {}", both, fmt::join(interface.transform, ", "), why),
         {interface.first, interface.second}});
    return found;
  }
  Walk walk(mesh, interface);
  walk.run();
  found.points = walk.points;
  found.distance_world = walk.match_distance;
  if (walk.apart == 0) return found;
  MeshFault fault{FaultKind::Mismatch,
                  fmt::format("{}: {} of {} points apart, by {:.6g} at i = {}, j = {}, k = {} of "
                              "the first",
                              both, walk.apart, walk.points, walk.distance, walk.at[0] + 1,
                              walk.at[1] + 1, walk.at[2] + 1),
                  {interface.first, interface.second}};
  fault.count = walk.apart;
  fault.distance_world = walk.distance;
  fault.at = walk.at;
  found.faults.push_back(std::move(fault));
  return found;
}

}  // namespace vdb_offset
