#include "field_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "gap_words.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vdb.h"
#include "vdb_offset/surface/inside.h"
#include "vdb_offset/surface/overlaps.h"
#include "vdb_offset/surface/splayed_edges.h"

namespace vdb_offset::command {
namespace {

constexpr const char* kEndsOnBoundaries =
    "past which there is no phi, and so no outside to tell an inside from; close it, or leave "
    "boundaries out and take --sign winding, which closes openings";

std::size_t edges_on_boundaries(const Surface& surface) {
  return static_cast<std::size_t>(surface.free_edges()) - splayed_edges(surface).edges;
}

/// What --weld would do, to stand behind what there is to say of an open surface.
std::string gaps_behind(const Surface& surface, const Settings& settings) {
  const std::string gaps = gaps_in_words(surface, settings.pipeline.surface.weld);
  return gaps.empty() ? std::string() : "; " + gaps;
}

/// Where the nearest face does not tell the side; empty: nowhere.
std::string doubt(const Surface& surface) {
  const std::string overlaps = overlaps_in_words(surface);
  if (!overlaps.empty()) {
    return overlaps +
           (surface.flat ? "; unite the curves" : "; --sign winding has them as one solid");
  }
  const SelfCrossing crossing = find_self_crossing(*surface.wall);
  if (crossing.edges > 0) {
    return fmt::format(
        "the {} goes through itself, with {} edges, the first at {}; {}",
        surface.flat ? "curve" : "surface", crossing.edges,
        in_words(crossing.place_world, surface.flat),
        surface.flat ? "mend it there" : "--sign winding has inside what it encloses");
  }
  if (surface.flat) return {};
  const std::vector<FlatPart> parts = find_flat_parts(*surface.wall);
  if (parts.empty()) return {};
  return fmt::format(
      "closed parts without an inside, no thicker than {:.3g}: {}, the first at {}; --sign "
      "unsigned "
      "has them as sheets",
      std::ranges::max(parts, {}, &FlatPart::thickness_world).thickness_world, parts.size(),
      in_words(parts.front().place_world, false));
}

/// What a note says of an open surface.
void print_open(const Console& console, const Surface& surface, const Settings& settings) {
  const bool is_one_side = settings.pipeline.surface.side != MarchSide::Both;
  const char* const half =
      is_one_side ? "; the band lies on one side of it, and --side both has the other" : "";
  if (surface.flat) {
    console.remark(fmt::format("sign: none, for the curve is open; close it to have one{}", half));
  } else if (surface.boundaries) {
    console.remark(
        fmt::format("sign: none, for the surface is open: {} of its {} free edges lie on "
                    "boundaries, {}{}",
                    edges_on_boundaries(surface), surface.free_edges(), kEndsOnBoundaries, half));
  } else {
    console.remark(fmt::format(
        "sign: none, for the surface is open, with {} free edges; --sign winding gives it one{}",
        surface.free_edges(), half));
  }
}

/// A limit that the voxel keeps, or not, as does the reach of its band.
void check_limits(const std::vector<Output>& outputs, double voxel_world, double distance_world,
                  bool half) {
  for (const Output& output : outputs) {
    if (output.format != Format::Vdb) continue;
    check_vdb_limits(output.file, voxel_world, distance_world + kBandMarginVoxels * voxel_world,
                     half);
  }
}

}  // namespace

void refuse_open(const Surface& surface, const Settings& settings) {
  if (settings.sign != SignRule::Closed || has_inside(surface)) return;
  if (surface.flat) {
    throw InputError(
        fmt::format("--sign closed: curves are open, with {} free ends; end each with its first "
                    "point, or take unsigned",
                    surface.free_edges()));
  }
  const SplayedEdges open = splayed_edges(surface);
  if (open.edges == 0) {
    throw InputError(
        fmt::format("--sign closed: the surface is open: its {} free edges lie on "
                    "boundaries, {}",
                    surface.free_edges(), kEndsOnBoundaries));
  }
  const auto& [from, to] = open.first_world;
  throw InputError(fmt::format(
      "--sign closed: the surface is open, with {} free edges on no boundary, the first from "
      "({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}); mend it, or take winding or "
      "unsigned{}",
      open.edges, from.x(), from.y(), from.z(), to.x(), to.y(), to.z(),
      gaps_behind(surface, settings)));
}

void print_sign(const Console& console, const Surface& surface, const Settings& settings) {
  // A note says why winding numbers, or no sign, were chosen for faces that are no surface.
  if (settings.pipeline.surface.sides != SideRule::Manifold) return;
  if (!has_inside(surface)) return print_open(console, surface, settings);
  const std::string why = doubt(surface);
  if (!why.empty()) {
    console.warning("sign: by the normal of the nearest face, as of closed surfaces; " + why);
  } else if (settings.sign == SignRule::Auto) {
    console.remark(fmt::format("sign: by the normal of the nearest face, for the {} is closed",
                               surface.flat ? "curve" : "surface"));
  }
  if (settings.pipeline.surface.side == MarchSide::Against) {
    console.remark(
        "side: against, with the normals turned round: phi is positive behind the surface, and no "
        "level set where that is inside");
  }
}

void print_closed_gap(const Console& console, const FieldResult& result, const PolygonUse& read,
                      const Settings& settings) {
  const double scale = settings.pipeline.surface.scale;
  const double on_reading = scale * read.moved_max_world;
  const double gap = std::max(on_reading, result.surface.report.weld_distance_max_world);
  if (!(gap >= result.plan.voxel_world)) return;
  const auto& [from, to] = read.moved_farthest_world;
  const std::string place =
      gap > on_reading ? std::string()
                       : fmt::format(", from {} to {}", in_words(scale * from, result.surface.flat),
                                     in_words(scale * to, result.surface.flat));
  console.warning(
      fmt::format("welding closed gaps as wide as {:.4g}, which voxels of {:.4g} resolve{}; --weld "
                  "0 keeps them "
                  "open",
                  gap, result.plan.voxel_world, place));
}

void refuse_unwritable(const Surface& surface, const PipelineOptions& pipeline,
                       const std::vector<Output>& outputs, const Settings& settings) {
  const double distance = pipeline.distance_world;
  const RasterizeOptions& band = pipeline.rasterize;
  // No voxel will be smaller.
  const double least = band.voxel_world > 0
                           ? band.voxel_world
                           : std::min(distance / 12, surface.report.median_edge_world);
  try {
    check_limits(outputs, least, distance, settings.grids.half);
  } catch (const IoError&) {
    RasterizeOptions asked = band;
    asked.distance_world = distance;
    asked.both_sides = asked.both_sides || surface.both_sides;
    check_limits(outputs, plan_band(surface, asked).voxel_world, distance, settings.grids.half);
  }
}

std::vector<std::vector<int>> numbers_in_files(const Surface& surface, const PolygonUse& read,
                                               MarchSide side) {
  std::vector<std::vector<int>> numbers = read.face_numbers;
  for (std::size_t p = 0; p < std::min(numbers.size(), surface.patches.size()); ++p) {
    const Patch& patch = surface.patches[p];
    const bool is_flipped =
        std::ranges::count(surface.report.flipped, static_cast<int>(p)) % 2 != 0;
    if (!patch.is_grid() || is_flipped == (side == MarchSide::Against)) continue;
    for (auto row = numbers[p].begin(); row != numbers[p].end(); row += patch.ni - 1) {
      std::reverse(row, row + patch.ni - 1);
    }
  }
  return numbers;
}

}  // namespace vdb_offset::command
