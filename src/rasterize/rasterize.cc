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
#include "vdb_offset/surface/inside.h"

namespace vdb_offset {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// A leaf with its buffer, masks and share of the inner nodes.
constexpr std::uint64_t kLeafBytes = 2048 + 160;
// The sweep's schedule; what finding the tile took.
constexpr std::uint64_t kSweepBytes = 160 + 200;
constexpr double kVoxelsInDistance = 12;
constexpr double kEnlarge = 1.02;
// Cubes of one size that a try looks at, of several tries.
constexpr std::size_t kCoarseSample = 15'000;
// The coarsest voxel, in sizes of the surface. Seen from much farther away all parts of the surface
// are equally near, and each distance costs a look at all of them.
constexpr double kCoarsest = 1000;

/// What the band ends on. A slice of voxels lies in its two outer planes all over.
std::shared_ptr<const Boundaries> ends_of(const Surface& surface) {
  if (!surface.flat) return surface.boundaries;
  auto ends = std::make_shared<Boundaries>();
  const std::vector<Boundary>& all = surface.boundaries->list();
  for (std::size_t b = Surface::kFlatPlanes; b < all.size(); ++b) ends->add(all[b]);
  return ends->empty() ? nullptr : ends;
}

/// What a band is planned for.
struct Task {
  const Surface& surface;
  const RasterizeOptions& options;
  const Progress& progress;
  const SideParts& parts;
};

TileQuery query_for(const Task& task, double voxel_world) {
  const auto& [surface, options, progress, parts] = task;
  return {.voxel_world = voxel_world,
          .reach_world = options.distance_world + kBandMarginVoxels * voxel_world,
          .seed_reach_voxels = options.exact_voxels,
          .both_sides = options.both_sides,
          .closed = surface.closed && surface.winding == nullptr,
          .one_body = surface.closed && surface.winding == nullptr &&
                      surface.topology.components == 1 && !surface.boundaries,
          .sides = has_inside(surface) || !options.both_sides || !options.unsigned_if_open,
          .winding = surface.winding.get(),
          .parts = &parts,
          .flat = surface.flat,
          .boundaries = nullptr};
}

/// The most that a tile takes: during the sweep, or when the output is made.
std::uint64_t tile_bytes(const RasterizeOptions& options) {
  return kLeafBytes + std::max(kSweepBytes, options.output_tile_bytes);
}

struct Room {
  std::uint64_t fixed;  // bytes that do not depend on the voxel
  double tiles;         // what is left for the band
};

Room room_for(const Task& task, const BandPlan& plan) {
  const std::uint64_t fixed = task.surface.wall->bytes() + task.options.other_bytes;
  const std::uint64_t left = plan.limit_bytes > fixed ? plan.limit_bytes - fixed : 0;
  return {fixed, static_cast<double>(left / tile_bytes(task.options))};
}

bool fits(const Task& task, BandPlan& plan, std::vector<TileSite>* sites = nullptr) {
  const Room room = room_for(task, plan);
  const std::shared_ptr<const Boundaries> ends = ends_of(task.surface);
  TileQuery query = query_for(task, plan.voxel_world);
  query.boundaries = ends.get();
  if (plan.rule == VoxelRule::Memory) query.sample = kCoarseSample;
  const auto tiles = count_tiles(*task.surface.wall, query, task.progress, sites);
  plan.tiles = tiles && *tiles < 1e15 ? static_cast<std::uint64_t>(*tiles) : UINT64_MAX;
  if (!tiles || *tiles > room.tiles) return false;
  plan.bytes = plan.tiles * tile_bytes(task.options);
  plan.total_bytes = plan.bytes + room.fixed;
  return true;
}

double coarsest_voxel(const Surface& surface) { return kCoarsest * surface.wall->bounds().size(); }

/// A voxel that fits, hardly larger than it must be; false if none does.
bool enlarge(const Task& task, BandPlan& plan) {
  const double room = room_for(task, plan).tiles;
  if (room < 1) return false;
  const double coarsest = coarsest_voxel(task.surface);
  while (!fits(task, plan)) {
    if (plan.voxel_world >= coarsest) return false;
    // Tiles fall with the voxel's second to third power: the cube root never goes too far.
    const double ratio = std::min(1e6, static_cast<double>(plan.tiles) / room);
    plan.voxel_world = std::min(coarsest, plan.voxel_world * std::max(kEnlarge, std::cbrt(ratio)));
  }
  return true;
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

void check_coarse(const Surface& surface, double voxel_world) {
  if (voxel_world <= coarsest_voxel(surface)) return;
  throw InputError(fmt::format(
      "voxel = {:g} is more than {:g} times the size of the whole surface, {:g}: nothing of it "
      "would be resolved; give a smaller --voxel",
      voxel_world, kCoarsest, surface.wall->bounds().size()));
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

[[noreturn]] void refuse(const Task& task, const BandPlan& plan) {
  const auto in_words = [](std::uint64_t bytes) {
    return format_bytes(static_cast<double>(bytes));
  };
  const Room room = room_for(task, plan);
  if (room.tiles < 1) {
    throw LimitError(fmt::format(
        "the run needs more than the {} that it may use: the program, surface, layers and output "
        "alone take about {}; give a larger --memory, or fewer layers",
        in_words(plan.limit_bytes), in_words(room.fixed)));
  }
  const double size = task.surface.wall->bounds().size();
  throw LimitError(fmt::format(
      "distance = {:g} is {:.3g} times the size of the whole surface, {:g}: no voxel resolves that "
      "in {}; give a smaller --distance, or a larger --memory",
      task.options.distance_world, task.options.distance_world / size, size,
      in_words(plan.limit_bytes)));
}

BandPlan first_plan(const Surface& surface, const RasterizeOptions& options) {
  BandPlan plan;
  plan.limit_bytes = options.memory_bytes > 0 ? options.memory_bytes : free_memory_bytes() / 4 * 3;
  const double by_distance = options.distance_world / kVoxelsInDistance;
  const double by_edge = surface.report.median_edge_world;
  plan.rule = by_distance <= by_edge ? VoxelRule::Distance : VoxelRule::SurfaceEdge;
  plan.voxel_world = std::min(by_distance, by_edge);
  if (options.voxel_world > 0) {
    plan.rule = VoxelRule::Given;
    plan.voxel_world = options.voxel_world;
    check_coarse(surface, plan.voxel_world);
  }
  check_lattice(surface, plan.voxel_world);
  return plan;
}

/// The plan, and the band's tiles if they were few enough to be kept.
BandPlan make_plan(const Task& task, std::vector<TileSite>* sites) {
  task.options.validate();
  const BandPlan plan = first_plan(task.surface, task.options);
  BandPlan larger = plan;
  if (fits(task, larger, sites)) return larger;
  if (sites != nullptr) sites->clear();
  larger.rule = VoxelRule::Memory;
  if (!enlarge(task, larger)) refuse(task, plan);
  if (plan.rule == VoxelRule::Given) {
    throw LimitError(fmt::format(
        "the run needs more than the {} that it may use: --voxel {:g} is too fine; --voxel {:.4g} "
        "would fit",
        format_bytes(static_cast<double>(plan.limit_bytes)), plan.voxel_world,
        1.01 * larger.voxel_world));  // a count of many tiles is a sample
  }
  check_lattice(task.surface, larger.voxel_world);
  return larger;
}

}  // namespace

BandPlan plan_band(const Surface& surface, const RasterizeOptions& options,
                   const Progress& progress) {
  return make_plan({surface, options, progress, SideParts(surface)}, nullptr);
}

Band rasterize(const Surface& surface, const RasterizeOptions& options, const Progress& progress) {
  Band band;
  std::vector<TileSite> sites;
  const SideParts parts(surface);
  const Task task{surface, options, progress, parts};
  band.plan = make_plan(task, &sites);
  band.voxel_world = band.plan.voxel_world;
  band.distance_world = options.distance_world;
  band.closed = has_inside(surface);
  band.boundaries = ends_of(surface);
  band.flat = surface.flat;
  if (band.boundaries) band.wall = surface.wall;
  band.both_sides = options.both_sides;
  TileQuery query = query_for(task, band.voxel_world);
  query.boundaries = band.boundaries.get();
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
