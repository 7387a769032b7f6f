#include "vdb_offset/blocks/check_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "blocks/check_faces.h"
#include "core/parallel.h"
#include "vdb_offset/blocks/widen_minima.h"

namespace vdb_offset {
namespace {

/// A zone as `judge` wants it: levels of a column together; in the mirror i runs backward.
MultiBlock columns_of(const Zone& zone, bool mirrored) {
  Block block{zone.name, zone.family, 0, zone.ni, zone.nj, zone.nk, {}};
  block.columns.resize(static_cast<std::size_t>(zone.ni) * static_cast<std::size_t>(zone.nj));
  std::iota(block.columns.begin(), block.columns.end(), 0);
  MultiBlock mesh;
  mesh.layers.spacing.layers = zone.nk - 1;
  mesh.layers.points_world.resize(zone.point_count());
  const auto ni = static_cast<std::size_t>(zone.ni);
  const auto nk = static_cast<std::size_t>(zone.nk);
  parallel::for_ranges(
      static_cast<std::size_t>(zone.nj), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin * nk; row < end * nk; ++row) {
          const std::size_t j = row / nk;
          const std::size_t k = row % nk;
          const Vec3* const from = &zone.at(0, static_cast<int>(j), static_cast<int>(k));
          for (std::size_t i = 0; i < ni; ++i) {
            mesh.layers.points_world[(j * ni + i) * nk + k] = from[mirrored ? ni - 1 - i : i];
          }
        }
      });
  mesh.blocks.push_back(std::move(block));
  return mesh;
}

void add_fault(MeshFault fault, MeshCheck& check) {
  ++check.fault_count;
  if (check.faults.size() < kMostListed) check.faults.push_back(std::move(fault));
}

void judge_zone(const ZoneMesh& mesh, std::size_t index, MeshCheck& check) {
  const Zone& zone = mesh.zones[index];
  MultiBlock columns = columns_of(zone, false);
  QualityField quality = judge(columns);
  bool mirrored = false;
  if (2 * quality.report.nonpositive_cells > zone.cell_count()) {
    MultiBlock image = columns_of(zone, true);
    QualityField other = judge(image);
    mirrored = other.report.nonpositive_cells < quality.report.nonpositive_cells;
    if (mirrored) {
      columns = std::move(image);
      quality = std::move(other);
    }
  }
  if (mirrored) {
    add_fault(
        {FaultKind::LeftHanded,
         fmt::format("zone '{}': is left-handed; turn one of its directions round", zone.name)},
        check);
  }
  const std::size_t room = kMostListed - check.nonpositive.size();
  for (CellPlace place : nonpositive_cells(columns, quality, room)) {
    place.block = static_cast<int>(index);
    if (mirrored) place.i = zone.ni - 2 - place.i;
    check.nonpositive.push_back(place);
  }
  check.zones.push_back(quality.report);
  widen(quality.report, check.quality);
  check.mean_scaled_jacobian +=
      quality.report.mean_scaled_jacobian * static_cast<double>(zone.cell_count());
}

/// Interfaces side by side; what was found keeps their order.
void check_interfaces(const ZoneMesh& mesh, const std::vector<const Interface*>& sound,
                      MeshCheck& check) {
  std::vector<InterfaceCheck> found(sound.size());
  parallel::for_ranges(sound.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) found[n] = check_interface(mesh, *sound[n]);
  });
  for (InterfaceCheck& one : found) {
    check.interface_points += one.points;
    check.interface_distance_world = std::max(check.interface_distance_world, one.distance_world);
    for (MeshFault& fault : one.faults) add_fault(std::move(fault), check);
  }
}

void check_connectivity(const ZoneMesh& mesh, MeshCheck& check) {
  std::vector<BlockRange> ranges;
  const auto keep = [&](const BlockRange& range, const char* what, const std::string& name) {
    const bool sound = lies_on_face(mesh, range);
    if (sound) {
      ranges.push_back(range);
    } else {
      add_fault({FaultKind::Range,
                 fmt::format("{} '{}' of {}: covers no part of this face", what, name,
                             place_in_words(mesh, range)),
                 {range}},
                check);
    }
    return sound;
  };
  std::vector<const Interface*> sound;
  for (const Interface& interface : mesh.interfaces) {
    const bool first = keep(interface.first, "interface", interface.name);
    const bool second = keep(interface.second, "interface", interface.name);
    if (first && second) sound.push_back(&interface);
  }
  for (const BoundaryFace& face : mesh.boundary_faces) keep(face.range, "boundary", face.name);
  check_interfaces(mesh, sound, check);
  std::vector<MeshFault> faces = check_coverage(mesh, ranges);
  std::ranges::stable_sort(faces, {}, &MeshFault::kind);
  for (MeshFault& fault : faces) add_fault(std::move(fault), check);
}

}  // namespace

std::string_view describe(FaultKind kind) {
  switch (kind) {
    case FaultKind::Unreadable:
      return "unreadable";
    case FaultKind::LeftHanded:
      return "left-handed";
    case FaultKind::Range:
      return "range";
    case FaultKind::Transform:
      return "transform";
    case FaultKind::Mismatch:
      return "mismatch";
    case FaultKind::Uncovered:
      return "uncovered";
    case FaultKind::DoublyCovered:
      return "doubly-covered";
    case FaultKind::Gap:
      return "gap";
    case FaultKind::Misoriented:
      return "misoriented";
    case FaultKind::Unused:
      break;
  }
  return "unused";
}

MeshCheck check_mesh(const ZoneMesh& mesh, const Progress& progress) {
  MeshCheck check;
  check.has_connectivity = !mesh.interfaces.empty() || !mesh.boundary_faces.empty();
  for (const std::string& text : mesh.faults) add_fault({FaultKind::Unreadable, text}, check);
  for (std::size_t z = 0; z < mesh.zones.size(); ++z) {
    progress.check();
    judge_zone(mesh, z, check);
    progress.update("check", static_cast<double>(z + 1) / static_cast<double>(mesh.zones.size()));
  }
  if (check.quality.cells > 0) {
    check.mean_scaled_jacobian /= static_cast<double>(check.quality.cells);
  }
  if (check.has_connectivity) check_connectivity(mesh, check);
  return check;
}

}  // namespace vdb_offset
