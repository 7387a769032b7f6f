#include "surface/share_plane.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

/// "0,0,0/0,1,0": as it is given.
std::string point_and_normal(const Vec3& p, const Vec3& n, bool is_flat) {
  // Sums that miss 0 by rounding.
  const auto tidy = [](double x) { return std::abs(x) < 1e-12 ? 0.0 : x; };
  if (is_flat)
    return fmt::format("{:.6g},{:.6g}/{:.6g},{:.6g}", tidy(p.x()), tidy(p.y()), tidy(n.x()),
                       tidy(n.y()));
  return fmt::format("{:.6g},{:.6g},{:.6g}/{:.6g},{:.6g},{:.6g}", tidy(p.x()), tidy(p.y()),
                     tidy(p.z()), tidy(n.x()), tidy(n.y()), tidy(n.z()));
}

std::string quoted(const std::vector<NamedPlane>& names) {
  std::vector<std::string> words;
  for (const NamedPlane& named : names) words.push_back("'" + named.name + "'");
  return fmt::format("{}", fmt::join(words, ", "));
}

[[noreturn]] void refuse(const PlaneFinder& finder, const Plane& plane,
                         const std::vector<NamedPlane>& names, const std::vector<PlanePart>& parts,
                         const std::string& why) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> places;
  for (std::size_t p = 0; p < std::min(parts.size(), kShown); ++p) {
    places.push_back(point_and_normal(parts[p].centre_world, plane.normal, finder.is_flat()));
  }
  throw InputError(fmt::format(
      "the plane {} is given for {}, and {}; it has {} parts: tell them apart by a point of each, "
      "as {}{}",
      describe(plane, finder.is_flat()), quoted(names), why, parts.size(),
      fmt::join(places, " or "), parts.size() > kShown ? " and so on" : ""));
}

std::size_t nearest_part(const PlaneFinder& finder, const Plane& plane,
                         const std::vector<PlanePart>& parts, const Vec3& point) {
  const auto rank = [&](const PlanePart& part) { return distance_to(finder, plane, part, point); };
  return static_cast<std::size_t>(std::ranges::min_element(parts, {}, rank) - parts.begin());
}

}  // namespace

std::vector<int> share_plane(const PlaneFinder& finder, const Plane& plane,
                             const std::vector<NamedPlane>& names,
                             const std::vector<PlanePart>& parts) {
  std::vector<int> owner(parts.size(), -1);
  int rest = -1;
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (names[n].rest) {
      if (rest >= 0) refuse(finder, plane, names, parts, "nothing says which is which");
      rest = static_cast<int>(n);
      continue;
    }
    int& of = owner[nearest_part(finder, plane, parts, names[n].plane.point_world)];
    if (of >= 0) {
      refuse(finder, plane, names, parts,
             fmt::format("the points of '{}' and '{}' are nearest to the same part",
                         names[static_cast<std::size_t>(of)].name, names[n].name));
    }
    of = static_cast<int>(n);
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (owner[p] >= 0 || (rest < 0 && parts[p].is_opening)) continue;
    const auto rank = [&](const NamedPlane& named) {
      return distance_to(finder, plane, parts[p], named.plane.point_world);
    };
    owner[p] = rest >= 0
                   ? rest
                   : static_cast<int>(std::ranges::min_element(names, {}, rank) - names.begin());
  }
  if (rest >= 0 && std::ranges::count(owner, rest) == 0) {
    refuse(finder, plane, names, parts,
           fmt::format("nothing is left for '{}'", names[static_cast<std::size_t>(rest)].name));
  }
  return owner;
}

}  // namespace vdb_offset
