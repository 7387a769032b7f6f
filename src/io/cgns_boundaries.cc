// BC_t nodes, and the ranges of points that they and connectivity are written as.

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "io/cgns_zones.h"
#include "vdb_offset/blocks/conditions.h"

namespace vdb_offset {
namespace {

/// Along which directions a range at this location counts points; those of a face counts cells
/// along two.
std::array<bool, 3> counts_cells(const std::string& location) {
  if (location == "IFaceCenter") return {false, true, true};
  if (location == "JFaceCenter") return {true, false, true};
  if (location == "KFaceCenter") return {true, true, false};
  return {false, false, false};
}

/// A location says of what the numbers are. "FaceCenter" does not say of which faces: that which
/// the range is constant along, at an end of the zone.
void to_points(CgnsRange& range, const CgnsZone& zone, const std::string& location) {
  std::array<bool, 3> cells = counts_cells(location);
  if (location == "FaceCenter") {
    const auto face = face_of(range, zone);
    cells = {true, true, true};
    if (face) cells[axis_of(*face)] = false;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (cells[a] && zone.size[a] > 1) ++range.end[a];
  }
}

/// A list of points that is just all points of a range is that range.
std::optional<CgnsRange> range_of_list(const CgnsNode& node, const CgnsZone& zone) {
  const auto list = node.child("IndexArray_t", "PointList");
  if (!list) return {};
  const std::vector<std::int64_t> values = list->integers();
  const std::size_t n = zone.dimension;
  if (values.empty() || values.size() % n != 0) return {};
  CgnsRange range;
  std::size_t count = 1;
  for (std::size_t a = 0; a < n; ++a) {
    std::int64_t low = std::numeric_limits<std::int64_t>::max();
    std::int64_t high = 0;
    for (std::size_t v = a; v < values.size(); v += n) {
      low = std::min(low, values[v]);
      high = std::max(high, values[v]);
    }
    if (low < 1 || high > zone.size[a]) return {};
    range.begin[a] = static_cast<int>(low) - 1;
    range.end[a] = static_cast<int>(high) - 1;
    count *= static_cast<std::size_t>(high - low + 1);
  }
  return count == values.size() / n ? std::optional(range) : std::nullopt;
}

}  // namespace

Condition condition_of(const CgnsBase& base, const CgnsNode& node, const std::string& family) {
  std::string type = node.text();
  bool is_overset = node.child("UserDefinedData_t", "BCOverset").has_value();
  const auto found = std::ranges::find(base.families, family, &CgnsFamily::name);
  if (type == "FamilySpecified" && found != base.families.end()) {
    type = found->type;
    is_overset = is_overset || found->is_overset;
  }
  if (type == "UserDefined" && is_overset) return {ConditionKind::Overset};
  return condition_of_cgns(type);
}

std::optional<CgnsRange> read_range(const CgnsNode& node, const CgnsZone& zone, const char* name) {
  auto found = node.child("IndexRange_t", name);
  if (!found) return {};
  const std::vector<std::int64_t> values = found->integers();
  const std::size_t n = zone.dimension;
  if (values.size() != 2 * n) return {};
  CgnsRange range;
  for (std::size_t a = 0; a < n; ++a) {
    constexpr std::int64_t kMost = std::numeric_limits<int>::max();
    // Numbers that no zone has are as good as others outside of it.
    range.begin[a] = static_cast<int>(std::clamp<std::int64_t>(values[a], 0, kMost) - 1);
    range.end[a] = static_cast<int>(std::clamp<std::int64_t>(values[a + n], 0, kMost) - 1);
  }
  return range;
}

std::optional<BlockFace> face_of(const CgnsRange& range, const CgnsZone& zone) {
  std::optional<BlockFace> face;
  for (std::size_t a = 0; a < 3; ++a) {
    if (range.begin[a] != range.end[a]) continue;
    const bool at_max = range.begin[a] == zone.size[a] - 1;
    if (face || (range.begin[a] != 0 && !at_max)) return {};
    face = static_cast<BlockFace>(2 * a + (at_max ? 1 : 0));
  }
  return face;
}

std::vector<CgnsBoundary> read_boundaries(const CgnsBase& base, std::size_t index) {
  const CgnsZone& zone = base.zones[index];
  const auto all = zone.node.child("ZoneBC_t");
  std::vector<CgnsBoundary> out;
  if (!all) return out;
  for (const CgnsNode& node : all->children("BC_t")) {
    CgnsBoundary boundary{node.name(), family_of(node), {}, {}, {}};
    boundary.condition = condition_of(base, node, boundary.family);
    auto range = read_range(node, zone);
    if (!range) range = read_range(node, zone, "ElementRange");
    if (!range) range = range_of_list(node, zone);
    const auto location = node.child("GridLocation_t");
    if (range && location) to_points(*range, zone, location->text());
    if (!range) {
      boundary.fault = "is no range of points";
    } else if (!range->within(zone)) {
      boundary.fault = "lies outside of its zone";
    } else {
      boundary.range = ascending(BlockRange{static_cast<int>(index),
                                            face_of(*range, zone).value_or(BlockFace::IMin),
                                            range->begin, range->end});
      if (!face_of(*range, zone)) boundary.fault = "covers no part of a face";
    }
    out.push_back(std::move(boundary));
  }
  return out;
}

}  // namespace vdb_offset
