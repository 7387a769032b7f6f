#include "vdb_offset/io/neutral_map.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/neutral_faces.h"
#include "io/output_file.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

const Vec3& point_of(const MultiBlock& mesh, int block, const std::array<int, 3>& p) {
  return mesh.point(mesh.blocks[static_cast<std::size_t>(block)], p[0], p[1], p[2]);
}

/// `visit` gets each point of a range.
template <typename Visit>
void for_points(const MultiBlock& mesh, const BlockRange& given, const Visit& visit) {
  const BlockRange range = ascending(given);
  std::array<int, 3> p{};
  for (p[2] = range.begin[2]; p[2] <= range.end[2]; ++p[2]) {
    for (p[1] = range.begin[1]; p[1] <= range.end[1]; ++p[1]) {
      for (p[0] = range.begin[0]; p[0] <= range.end[0]; ++p[0]) {
        visit(p, point_of(mesh, range.block, p));
      }
    }
  }
}

/// Whether all points along one direction of a range are one.
bool is_collapsed(const MultiBlock& mesh, const BlockRange& given, std::size_t axis) {
  const BlockRange range = ascending(given);
  bool collapsed = true;
  for_points(mesh, range, [&](std::array<int, 3> p, const Vec3& point) {
    p[axis] = range.begin[axis];
    collapsed = collapsed && point == point_of(mesh, range.block, p);
  });
  return collapsed;
}

std::string pole_type(const MultiBlock& mesh, const BlockRange& range) {
  const std::array<std::size_t, 2> axes = neutral_axes(range.face);
  const bool first = is_collapsed(mesh, range, axes[0]);
  const bool second = is_collapsed(mesh, range, axes[1]);
  if (first == second) return "COLLAPSED";
  return first ? "POLE_DIR1" : "POLE_DIR2";
}

/// A plane across x, y or z is called by it; how far off it points may be is the unit of rounding
/// of its extent.
std::string symmetry_type(const MultiBlock& mesh, const BlockRange& range) {
  Box box;
  for_points(mesh, range, [&](const std::array<int, 3>&, const Vec3& p) { box.add(p); });
  for (int a = 0; a < 3; ++a) {
    if (box.hi[a] - box.lo[a] <= 1e-9 * box.size()) return fmt::format("Symmetry-{}", "XYZ"[a]);
  }
  return "SYMMETRY";
}

std::string type_of(const MultiBlock& mesh, const BoundaryFace& face) {
  switch (face.condition.kind) {
    case ConditionKind::Wall:
      return "WALL";
    case ConditionKind::InviscidWall:
      return "INVISCID";
    case ConditionKind::Symmetry:
      return symmetry_type(mesh, face.range);
    case ConditionKind::Inflow:
      return "INFLOW";
    case ConditionKind::Outflow:
      return "OUTFLOW";
    case ConditionKind::Farfield:
      return "FARFIELD";
    case ConditionKind::Overset:
      return "OVERSET";
    case ConditionKind::Degenerate:
      return pole_type(mesh, face.range);
    case ConditionKind::Unspecified:
      return "UNPROCESSED";
    case ConditionKind::Other:
      break;
  }
  return std::string(cgns_type(face.condition));
}

std::string range_text(const BlockRange& given) {
  const NeutralRange range = neutral_range(given);
  return fmt::format("{:7} {:3} {:6} {:6} {:6} {:6}", range.block, range.face, range.begin[0],
                     range.end[0], range.begin[1], range.end[1]);
}

constexpr const char* kRule =
    "# =============================================================================\n";

}  // namespace

NeutralMap neutral_map(const MultiBlock& mesh) {
  NeutralMap map;
  for (const Block& block : mesh.blocks) map.sizes.push_back({block.ni, block.nj, block.nk});
  for (const Interface& interface : mesh.interfaces) {
    map.interfaces.push_back(
        neutral_interface(interface.first, interface.second, is_swapped(interface)));
  }
  for (const BoundaryFace& face : mesh.boundary_faces) {
    map.boundary_faces.push_back(neutral_boundary(type_of(mesh, face), face.range));
  }
  return map;
}

void write_neutral_map(const std::filesystem::path& file, const MultiBlock& mesh) {
  if (mesh.flat) {
    throw InputError(file.string() +
                     ": a neutral map is of blocks in three dimensions; for curves write .cgns");
  }
  write_neutral_map(file, neutral_map(mesh));
}

void write_neutral_map(const std::filesystem::path& file, const NeutralMap& map) {
  OutputFile output(file);
  std::ostream& out = output.stream();
  out << fmt::format("{}# Block     IDIM   JDIM   KDIM\n{}{:8}\n", kRule, kRule, map.sizes.size());
  for (std::size_t b = 0; b < map.sizes.size(); ++b) {
    out << fmt::format("{:8} {:8} {:6} {:6}\n", b + 1, map.sizes[b][0], map.sizes[b][1],
                       map.sizes[b][2]);
  }
  out << fmt::format(
      "{}# Type            B1  F1     S1     E1     S2     E2"
      "      B2  F2     S1     E1     S2     E2  Swap\n{}",
      kRule, kRule);
  for (const Interface& interface : map.interfaces) {
    out << fmt::format("{:<12} {} {}  {}\n", "ONE_TO_ONE", range_text(interface.first),
                       range_text(interface.second), is_swapped(interface) ? "TRUE" : "FALSE");
  }
  for (const BoundaryFace& face : map.boundary_faces) {
    const bool has_blank = face.name.find_first_of(" \t#\\,") != std::string::npos;
    out << fmt::format("{:<12} {}\n", has_blank ? "'" + face.name + "'" : face.name,
                       range_text(face.range));
  }
  output.commit();
}

void connect(const NeutralMap& map, const NeutralMapFiles& files, ZoneMesh& mesh) {
  if (map.sizes.size() != mesh.zones.size()) {
    throw IoError(fmt::format("{}: has {} blocks, and {} has {}; give the map of this mesh",
                              files.map.string(), map.sizes.size(), files.points.string(),
                              mesh.zones.size()));
  }
  for (std::size_t b = 0; b < map.sizes.size(); ++b) {
    const Zone& zone = mesh.zones[b];
    const std::array<int, 3> sizes{zone.ni, zone.nj, zone.nk};
    if (sizes == map.sizes[b]) continue;
    throw IoError(fmt::format("{}: block {} is {} points, and in {} {}; give the map of this mesh",
                              files.map.string(), b + 1, fmt::join(map.sizes[b], " x "),
                              files.points.string(), fmt::join(sizes, " x ")),
                  {static_cast<std::int64_t>(b)});
  }
  mesh.interfaces = map.interfaces;
  mesh.boundary_faces = map.boundary_faces;
  mesh.faults.insert(mesh.faults.end(), map.faults.begin(), map.faults.end());
}

}  // namespace vdb_offset
