#include "vdb_offset/rasterize/rasterize.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/machine.h"
#include "core/parallel.h"
#include "rasterize/seed_tile.h"
#include "rasterize/tiles.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"

namespace vdb_offset {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// A leaf with its buffer, masks and share of the inner nodes; the sweep's schedule; what finding
// the tile took.
constexpr std::uint64_t kTileBytes = 2048 + 160 + 160 + 200;
constexpr double kVoxelsInDistance = 12;
constexpr double kEnlarge = 1.02;

TileQuery query_for(const Surface& surface, const RasterizeOptions& options, double voxel_world) {
  return {voxel_world, options.distance_world + kBandMarginVoxels * voxel_world,
          options.exact_voxels, options.both_sides, surface.closed};
}

struct Room {
  std::uint64_t fixed;  // bytes that do not depend on the voxel
  double tiles;         // what is left for the band
};

Room room_for(const Surface& surface, const RasterizeOptions& options, const BandPlan& plan) {
  const std::uint64_t fixed = surface.wall->bytes() + options.other_bytes;
  const std::uint64_t left = plan.limit_bytes > fixed ? plan.limit_bytes - fixed : 0;
  return {fixed, static_cast<double>(left / kTileBytes)};
}

bool fits(const Surface& surface, const RasterizeOptions& options, BandPlan& plan,
          std::vector<TileSite>* sites = nullptr) {
  const Room room = room_for(surface, options, plan);
  const auto tiles =
      count_tiles(*surface.wall, query_for(surface, options, plan.voxel_world), sites);
  plan.tiles = tiles && *tiles < 1e15 ? static_cast<std::uint64_t>(*tiles) : UINT64_MAX;
  if (!tiles || *tiles > room.tiles) return false;
  plan.bytes = plan.tiles * kTileBytes;
  plan.total_bytes = plan.bytes + room.fixed;
  return true;
}

/// A voxel that fits, hardly larger than it must be; false if none does.
bool enlarge(const Surface& surface, const RasterizeOptions& options, BandPlan& plan) {
  const double coarsest = 4 * (options.distance_world + surface.wall->bounds().size());
  const double room = room_for(surface, options, plan).tiles;
  while (!fits(surface, options, plan)) {
    if (plan.voxel_world > coarsest || room < 1) return false;
    // Tiles fall with the voxel's second to third power: the cube root never goes too far.
    const double ratio = std::min(1e6, static_cast<double>(plan.tiles) / room);
    plan.voxel_world *= std::max(kEnlarge, std::cbrt(ratio));
  }
  return true;
}

[[noreturn]] void refuse_memory(const BandPlan& plan, const std::string& why) {
  throw LimitError(fmt::format("the run needs more than the {} that it may use: {}",
                               format_bytes(static_cast<double>(plan.limit_bytes)), why));
}

void check_lattice(const Surface& surface, double voxel_world) {
  // The sweep squares the voxel in single precision.
  if (!(voxel_world > 1e-15 && voxel_world < 1e15)) {
    throw InputError(
        fmt::format("voxel = {:g} is outside [1e-15, 1e15]; use --scale to bring the "
                    "surface to a usual size",
                    voxel_world));
  }
  const double far = surface.wall->bounds()
                         .lo.cwiseAbs()
                         .cwiseMax(surface.wall->bounds().hi.cwiseAbs())
                         .maxCoeff();
  if (!(far / voxel_world < 1e9)) {
    throw LimitError(fmt::format(
        "the surface reaches {:g} from the origin, {:g} voxels of {:g}: beyond the lattice's 2^30; "
        "give a larger --voxel or move the surface to the origin",
        far, far / voxel_world, voxel_world));
  }
}

openvdb::Coord origin(const TileSite& site) {
  return {kTile * site.cube.x, kTile * site.cube.y, kTile * site.cube.z};
}

}  // namespace

void RasterizeOptions::validate() const {
  if (!(distance_world > 0 && distance_world < 1e100)) {
    throw InputError(
        fmt::format("distance = {}, but must be above 0 and below 1e100", distance_world));
  }
  if (!(voxel_world >= 0) || !std::isfinite(voxel_world)) {
    throw InputError(fmt::format("voxel = {}, but must be above 0 and finite", voxel_world));
  }
  if (!(exact_voxels >= kSeedReachVoxels && exact_voxels <= 16)) {
    throw InputError(
        fmt::format("exact_voxels = {}, but must be in [{}, 16]", exact_voxels, kSeedReachVoxels));
  }
}

namespace {

/// The plan, and the band's tiles if they were few enough to be kept.
BandPlan make_plan(const Surface& surface, const RasterizeOptions& options,
                   std::vector<TileSite>* sites) {
  options.validate();
  BandPlan plan;
  plan.limit_bytes = options.memory_bytes > 0 ? options.memory_bytes : free_memory_bytes() / 4 * 3;
  const double by_distance = options.distance_world / kVoxelsInDistance;
  const double by_edge = surface.report.median_edge_world;
  plan.rule = by_distance <= by_edge ? VoxelRule::Distance : VoxelRule::SurfaceEdge;
  plan.voxel_world = std::min(by_distance, by_edge);
  if (options.voxel_world > 0) {
    plan.rule = VoxelRule::Given;
    plan.voxel_world = options.voxel_world;
  }
  check_lattice(surface, plan.voxel_world);
  if (fits(surface, options, plan, sites)) return plan;
  if (sites != nullptr) sites->clear();

  BandPlan larger = plan;
  if (!enlarge(surface, options, larger)) {
    refuse_memory(plan, fmt::format("surface, layers and output alone take about {}; give fewer "
                                    "layers or a larger --memory",
                                    format_bytes(static_cast<double>(surface.wall->bytes() +
                                                                     options.other_bytes))));
  }
  if (plan.rule == VoxelRule::Given) {
    refuse_memory(plan, fmt::format("--voxel {:g} is too fine; --voxel {:.4g} would fit",
                                    plan.voxel_world, larger.voxel_world));
  }
  check_lattice(surface, larger.voxel_world);
  larger.rule = VoxelRule::Memory;
  return larger;
}

}  // namespace

BandPlan plan_band(const Surface& surface, const RasterizeOptions& options) {
  return make_plan(surface, options, nullptr);
}

Band rasterize(const Surface& surface, const RasterizeOptions& options, const Progress& progress) {
  Band band;
  std::vector<TileSite> sites;
  band.plan = make_plan(surface, options, &sites);
  band.voxel_world = band.plan.voxel_world;
  band.distance_world = options.distance_world;
  band.closed = surface.closed;
  band.both_sides = options.both_sides;
  const TileQuery query = query_for(surface, options, band.voxel_world);
  if (sites.empty()) sites = find_tiles(*surface.wall, query, progress);
  const TileSeeder seeder(*surface.wall, query);

  std::vector<std::unique_ptr<Leaf>> leaves(sites.size());
  std::vector<int> seeds(sites.size());
  parallel::for_ranges(
      {progress, "rasterize"}, sites.size(), 32, [&](std::size_t begin, std::size_t end) {
        const auto scratch = std::make_unique<TileSeeder::Scratch>();
        for (std::size_t t = begin; t < end; ++t) {
          // Its values are not set twice.
          auto leaf =
              std::make_unique<Leaf>(openvdb::PartialCreate(), origin(sites[t]), 0.0F, false);
          leaf->allocate();
          seeds[t] = seeder.seed(sites[t], *scratch, *leaf);
          if (!leaf->isEmpty()) leaves[t] = std::move(leaf);
        }
      });
  band.seed_count = std::accumulate(seeds.begin(), seeds.end(), std::uint64_t{0});
  band.phi = openvdb::FloatGrid::create(Band::kUnreached);
  if (band.voxel_world >= kLeastVdbVoxel) {
    band.phi->setTransform(openvdb::math::Transform::createLinearTransform(band.voxel_world));
  }
  for (auto& leaf : leaves) {
    if (leaf) band.phi->tree().addLeaf(leaf.release());
  }
  return band;
}

}  // namespace vdb_offset
