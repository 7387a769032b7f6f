// A volume mesh and its connectivity, as the file has it.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "io/cgns_zones.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {
namespace {

using Key = std::array<int, 17>;

/// The same for two interfaces that say the same.
Key key_of(const Interface& given) {
  const Interface one = ascending(given);
  Key key{one.first.block, one.second.block};
  std::size_t at = 2;
  for (const auto& part :
       {one.first.begin, one.first.end, one.second.begin, one.second.end, one.transform}) {
    for (const int value : part) key[at++] = value;
  }
  return key;
}

/// A signed permutation that takes the one range to the other.
bool fits(const Interface& interface) {
  std::array<bool, 3> used{};
  for (std::size_t n = 0; n < 3; ++n) {
    const int direction = interface.transform[n];
    if (direction == 0 || std::abs(direction) > 3) return false;
    const auto m = static_cast<std::size_t>(std::abs(direction)) - 1;
    if (used[m]) return false;
    used[m] = true;
    const int length = interface.first.end[n] - interface.first.begin[n];
    const int donor = interface.second.end[m] - interface.second.begin[m];
    if (donor != (direction > 0 ? length : -length)) return false;
  }
  return true;
}

class MeshReader {
 public:
  explicit MeshReader(const CgnsBase& base) : base_(base) {
    for (std::size_t z = 0; z < base.zones.size(); ++z) {
      zones_.try_emplace(base.zones[z].name, static_cast<int>(z));
    }
  }

  ZoneMesh read() {
    mesh_.length_unit = base_.length_unit;
    for (std::size_t z = 0; z < base_.zones.size(); ++z) {
      const CgnsZone& zone = base_.zones[z];
      mesh_.zones.push_back(
          {zone.name, zone.family, zone.size[0], zone.size[1], zone.size[2], zone.read_points()});
      for (const auto& all : zone.node.children("ZoneGridConnectivity_t")) {
        for (const CgnsNode& node : all.children()) read_connectivity(z, node);
      }
      for (const CgnsBoundary& boundary : read_boundaries(base_, z)) add(z, boundary);
    }
    pair_up();
    return std::move(mesh_);
  }

 private:
  void fault(std::size_t zone, const std::string& name, const std::string& why) {
    mesh_.faults.push_back(fmt::format("zone '{}': '{}' {}", base_.zones[zone].name, name, why));
  }

  void add(std::size_t zone, const CgnsBoundary& boundary) {
    if (!boundary.fault.empty()) return fault(zone, boundary.name, boundary.fault);
    mesh_.boundary_faces.push_back({boundary_kind(boundary.condition.kind), boundary.called(),
                                    *boundary.range, boundary.condition});
  }

  void read_connectivity(std::size_t zone, const CgnsNode& node) {
    if (node.label() == "GridConnectivity1to1_t") {
      read_1to1(zone, node);
    } else if (node.label() == "GridConnectivity_t") {
      read_general(zone, node);
    } else if (node.label() == "OversetHoles_t") {
      fault(zone, node.name(), "are overset holes, which are not read");
    }
  }

  /// Of the general kind only overset faces are read: they have no donor to match.
  void read_general(std::size_t zone, const CgnsNode& node) {
    const auto type = node.child("GridConnectivityType_t");
    const std::string said = type ? type->text() : "Overset";
    const auto range = read_range(node, base_.zones[zone]);
    const bool is_face = range && range->within(base_.zones[zone]);
    const auto face = is_face ? face_of(*range, base_.zones[zone]) : std::nullopt;
    if (said != "Overset" || !face) {
      return fault(zone, node.name(),
                   said != "Overset" ? "is connectivity of type " + said + ", which is not read"
                                     : "covers no part of a face");
    }
    add_face(zone, node.name(), {*face, *range}, {ConditionKind::Overset});
  }

  struct Place {
    BlockFace face;
    CgnsRange range;
  };

  void add_face(std::size_t zone, const std::string& name, const Place& place,
                const Condition& condition) {
    const BlockRange range = ascending(
        BlockRange{static_cast<int>(zone), place.face, place.range.begin, place.range.end});
    mesh_.boundary_faces.push_back({boundary_kind(condition.kind), name, range, condition});
  }

  /// A range on a face of a zone; nothing, and a fault, where it is none.
  std::optional<BlockRange> range_on(std::size_t zone, const CgnsNode& node, const char* name) {
    const CgnsZone& of = base_.zones[zone];
    const auto range = read_range(node, of, name);
    if (!range || !range->within(of)) return {};
    const auto face = face_of(*range, of);
    if (!face) return {};
    return BlockRange{static_cast<int>(zone), *face, range->begin, range->end};
  }

  void read_1to1(std::size_t zone, const CgnsNode& node) {
    std::string donor = node.text();
    const std::size_t slash = donor.rfind('/');
    if (slash != std::string::npos) donor = donor.substr(slash + 1);
    const auto found = zones_.find(donor);
    if (found == zones_.end()) {
      return fault(zone, node.name(), "has the donor '" + donor + "', which is no zone");
    }
    const auto first = range_on(zone, node, "PointRange");
    if (!first) return fault(zone, node.name(), "has a PointRange on no face");
    const auto property = node.child("GridConnectivityProperty_t");
    if (property && property->child("Periodic_t")) {
      fault(zone, node.name(), "is periodic, and taken as a boundary");
      return add_face(zone, node.name(), {first->face, {first->begin, first->end}},
                      {ConditionKind::Other});
    }
    const auto second = range_on(static_cast<std::size_t>(found->second), node, "PointRangeDonor");
    if (!second) return fault(zone, node.name(), "has a PointRangeDonor on no face of its donor");
    Interface interface { *first, *second, transform_of(node), node.name() };
    if (!fits(interface)) {
      return fault(zone, node.name(),
                   "has a Transform that does not take its range to the donor's");
    }
    one_way_.push_back(std::move(interface));
  }

  static std::array<int, 3> transform_of(const CgnsNode& node) {
    auto found = node.child("\"int[IndexDimension]\"");
    if (!found) return {1, 2, 3};  // what the SIDS say it is then
    const std::vector<std::int64_t> values = found->integers();
    std::array<int, 3> transform{0, 0, 0};
    for (std::size_t a = 0; a < std::min<std::size_t>(3, values.size()); ++a) {
      transform[a] = static_cast<int>(std::clamp<std::int64_t>(values[a], -9, 9));
    }
    return transform;
  }

  /// Each interface stands in both of its zones; those that do not are kept, and a fault.
  void pair_up() {
    std::multimap<Key, std::size_t> open;
    for (std::size_t n = 0; n < one_way_.size(); ++n) {
      const auto partner = open.find(key_of(reversed(one_way_[n])));
      if (partner == open.end()) {
        open.emplace(key_of(one_way_[n]), n);
        continue;
      }
      mesh_.interfaces.push_back(one_way_[partner->second]);
      open.erase(partner);
    }
    for (const auto& [key, n] : open) {
      const Interface& interface = one_way_[n];
      fault(static_cast<std::size_t>(interface.first.block), interface.name,
            "has no counterpart in the donor '" +
                base_.zones[static_cast<std::size_t>(interface.second.block)].name + "'");
      mesh_.interfaces.push_back(interface);
    }
  }

  const CgnsBase& base_;
  std::map<std::string, int> zones_;
  std::vector<Interface> one_way_;
  ZoneMesh mesh_;
};

}  // namespace

ZoneMesh read_cgns_mesh(const std::filesystem::path& file) {
  try_apart(file, [&] { read_cgns_mesh(file); });
  CgnsTree tree(file);
  const CgnsBase base = read_base(tree);
  need_structured(base);
  for (const CgnsZone& zone : base.zones) {
    if (std::ranges::count(zone.size, 1) == 0) continue;
    zone.node.refuse(fmt::format("has {} points: no volume", fmt::join(zone.size, " x ")));
  }
  return MeshReader(base).read();
}

}  // namespace vdb_offset
