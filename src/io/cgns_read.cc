#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <set>
#include <utility>

#include "io/byte_way.h"
#include "io/cgns_zones.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {
namespace {

/// A patch of two of a zone's directions (0 = i), the third fixed at `level`.
struct Slice {
  std::size_t first;
  std::size_t second;
  std::array<int, 3> begin;
  std::array<int, 3> end;
};

std::size_t index_in(const CgnsZone& zone, const std::array<int, 3>& at) {
  return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(zone.size[1]) +
          static_cast<std::size_t>(at[1])) *
             static_cast<std::size_t>(zone.size[0]) +
         static_cast<std::size_t>(at[0]);
}

Patch cut(const CgnsZone& zone, const Vec3List& points, const Slice& slice) {
  Patch patch;
  patch.ni = slice.end[slice.first] - slice.begin[slice.first] + 1;
  patch.nj = slice.end[slice.second] - slice.begin[slice.second] + 1;
  std::array<int, 3> at = slice.begin;
  for (int j = 0; j < patch.nj; ++j) {
    at[slice.second] = slice.begin[slice.second] + j;
    for (int i = 0; i < patch.ni; ++i) {
      at[slice.first] = slice.begin[slice.first] + i;
      patch.points_world.push_back(points[index_in(zone, at)]);
    }
  }
  return patch;
}

bool covers_all(const CgnsBoundary& boundary, const CgnsZone& zone) {
  if (!boundary.range) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    if (boundary.range->begin[a] != 0 || boundary.range->end[a] != zone.size[a] - 1) return false;
  }
  return true;
}

Patch surface_patch(const CgnsBase& base, std::size_t index) {
  const CgnsZone& zone = base.zones[index];
  const std::array<int, 3> last{zone.size[0] - 1, zone.size[1] - 1, zone.size[2] - 1};
  const std::size_t first = zone.size[0] > 1 ? 0 : 1;
  const std::size_t second = zone.size[2] > 1 ? 2 : 1;
  Patch patch = cut(zone, zone.read_points(), {first, second, {0, 0, 0}, last});
  patch.name = zone.name;
  patch.family = zone.family;
  for (const CgnsBoundary& boundary : read_boundaries(base, index)) {
    if (patch.family.empty() && covers_all(boundary, zone)) patch.family = boundary.called();
  }
  return patch;
}

/// Six times the volume of the cells that stand on a face, as i, j, k turn: its sign is their hand.
double turn_of_cells(const CgnsZone& zone, const Vec3List& points, const BlockRange& face) {
  const std::size_t axis = axis_of(face.face);
  std::array<int, 3> begin = face.begin;
  std::array<int, 3> end = face.end;
  if (is_max(face.face)) --begin[axis];
  end[axis] = begin[axis] + 1;
  double sum = 0;
  for (int k = begin[2]; k < end[2]; ++k) {
    for (int j = begin[1]; j < end[1]; ++j) {
      for (int i = begin[0]; i < end[0]; ++i) {
        const Vec3& p = points[index_in(zone, {i, j, k})];
        const Vec3 a = points[index_in(zone, {i + 1, j, k})] - p;
        const Vec3 b = points[index_in(zone, {i, j + 1, k})] - p;
        const Vec3 c = points[index_in(zone, {i, j, k + 1})] - p;
        sum += a.cross(b).dot(c);
      }
    }
  }
  return sum;
}

/// The face of a BC, its normal into the volume.
Patch wall_patch(const CgnsZone& zone, const Vec3List& points, const BlockRange& face) {
  const std::size_t axis = axis_of(face.face);
  const bool right_handed = turn_of_cells(zone, points, face) >= 0;
  Slice slice{(axis + 1) % 3, (axis + 2) % 3, face.begin, face.end};
  if (is_max(face.face) == right_handed) std::swap(slice.first, slice.second);
  return cut(zone, points, slice);
}

void add_walls(const CgnsBase& base, std::size_t index, Patches& patches) {
  const CgnsZone& zone = base.zones[index];
  Vec3List points;
  for (const CgnsBoundary& boundary : read_boundaries(base, index)) {
    const ConditionKind kind = boundary.condition.kind;
    if (kind != ConditionKind::Wall && kind != ConditionKind::InviscidWall) continue;
    if (!boundary.fault.empty()) {
      zone.node.refuse(fmt::format("the wall '{}' {}", boundary.name, boundary.fault));
    }
    if (points.empty()) points = zone.read_points();
    patches.push_back(wall_patch(zone, points, *boundary.range));
    patches.back().name = zone.name + ": " + boundary.name;
    patches.back().family = boundary.called();
  }
}

/// "surface" or "volume", of all zones alike.
bool are_surfaces(const CgnsBase& base) {
  const auto is_surface = [](const CgnsZone& zone) { return zone.is_surface(); };
  const auto count = std::ranges::count_if(base.zones, is_surface);
  if (count == static_cast<std::ptrdiff_t>(base.zones.size())) return true;
  for (const CgnsZone& zone : base.zones) {
    if (std::ranges::count(zone.size, 1) > 1) {
      zone.node.refuse(
          fmt::format("has {} points: a curve or a single point; only surfaces and "
                      "volumes are read",
                      fmt::join(zone.size, " x ")));
    }
    if (count == 0 || is_surface(zone)) continue;
    zone.node.refuse(
        "is a volume, and other zones of its base are surfaces; put them into files "
        "of their own");
  }
  return false;
}

CgnsInfo inspect(const std::filesystem::path& file) {
  CgnsTree tree(file);
  const CgnsBase base = read_base(tree);
  CgnsInfo info;
  info.container = tree.is_hdf5() ? "HDF5" : "ADF";
  info.version = base.version;
  info.bases = base.count;
  info.base = base.node.name();
  info.cell_dimension = base.cell_dimension;
  info.physical_dimension = base.physical_dimension;
  info.length_unit = base.length_unit;
  for (const CgnsZone& zone : base.zones) {
    const auto interfaces = zone.node.child("ZoneGridConnectivity_t");
    const auto boundaries = zone.node.child("ZoneBC_t");
    info.zones.push_back({zone.name, zone.family, zone.size[0], zone.size[1], zone.size[2],
                          interfaces ? static_cast<int>(interfaces->children().size()) : 0,
                          boundaries ? static_cast<int>(boundaries->children("BC_t").size()) : 0,
                          zone.is_structured, zone.cells});
  }
  for (const CgnsFamily& family : base.families)
    info.families.push_back({family.name, family.type});
  return info;
}

/// One way or the other.
template <typename Way, typename Info>
void pass(Way& way, Info& info) {
  way(info.container);
  way(info.version);
  way(info.bases);
  way(info.base);
  way(info.cell_dimension);
  way(info.physical_dimension);
  way(info.length_unit);
  way.each(info.zones, [](auto& to, auto& zone) {
    to(zone.name);
    to(zone.family);
    for (auto* count : {&zone.ni, &zone.nj, &zone.nk, &zone.cells}) to(*count);
    for (auto* count : {&zone.interfaces, &zone.boundaries}) to(*count);
    to(zone.is_structured);
  });
  way.each(info.families, [](auto& to, auto& family) {
    to(family.name);
    to(family.type);
  });
}

}  // namespace

bool CgnsInfo::is_unstructured() const {
  return std::ranges::none_of(zones, &CgnsZoneInfo::is_structured);
}

bool CgnsInfo::is_surface() const {
  return std::ranges::all_of(zones, [](const CgnsZoneInfo& zone) {
    return zone.is_structured && (zone.ni == 1) + (zone.nj == 1) + (zone.nk == 1) == 1;
  });
}

/// Of a damaged file the library leaves out in silence what it cannot open, and HDF5 goes round in
/// circles at the end of a process in which that was tried.
CgnsInfo inspect_cgns(const std::filesystem::path& file) {
  const std::string bytes = read_apart(file, [&] {
    ByteWriter out;
    const CgnsInfo info = inspect(file);
    pass(out, info);
    return std::move(out.bytes);
  });
  CgnsInfo info;
  ByteReader in(bytes);
  pass(in, info);
  return info;
}

Patches read_cgns(const std::filesystem::path& file) {
  try_apart(file, [&] { read_cgns(file); });
  CgnsTree tree(file);
  const CgnsBase base = read_base(tree);
  need_structured(base);
  Patches patches;
  if (are_surfaces(base)) {
    for (std::size_t z = 0; z < base.zones.size(); ++z) patches.push_back(surface_patch(base, z));
  } else {
    for (std::size_t z = 0; z < base.zones.size(); ++z) add_walls(base, z, patches);
    if (patches.empty()) {
      base.node.refuse(
          "is a volume mesh whose zones have no walls (a BC_t of type BCWall..., or "
          "of a family of that type) to take as the surface");
    }
  }
  for (Patch& patch : patches) patch.file = file.string();
  return patches;
}

}  // namespace vdb_offset
