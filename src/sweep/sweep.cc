// Zhao, A fast sweeping method for eikonal equations, 2005, on the leaf tiles of an OpenVDB tree.

#include "vdb_offset/sweep/sweep.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "core/crew.h"
#include "core/large_vector.h"
#include "core/parallel.h"
#include "sweep/ghosts.h"
#include "sweep/kernel.h"
#include "sweep/seeds.h"
#include "sweep/sweep_with.h"
#include "sweep/tile_schedule.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

static_assert(kFarAway == Band::kUnreached);

/// for_ranges over tiles in pieces that are worth a task.
template <typename Body>
void for_tiles(std::size_t count, const Body& body) {
  parallel::for_ranges(count, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) body(t);
  });
}

TileBits active_bits(const TileSchedule::Leaf& leaf) {
  TileBits bits;
  for (openvdb::Index w = 0; w < 8; ++w) {
    bits[w] = leaf.getValueMask().getWord<std::uint64_t>(w);
  }
  return bits;
}

class Sweeper {
 public:
  Sweeper(openvdb::FloatTree& tree, const Kernels& kernels) : schedule_(tree), kernels_(kernels) {}

  /// From distances to codes, and wake what the seeds reach.
  void start();
  void run(const SweepOptions& options, float voxel, const Progress& progress, SweepReport& report);
  /// From codes to distances; what lies beyond `limit` leaves the band.
  void finish(float limit);

 private:
  template <typename Crew>
  void octant(Crew& crew, const Progress& progress, SweepReport& report);
  float visit(std::span<const int> tiles);
  void share_plane(const TileSchedule::Plane& plane);

  TileSchedule schedule_;
  const Kernels& kernels_;
  const std::size_t threads_ = parallel::threads();
  LargeVector<TileMarks> marks_;
  TileBatch batch_;         // of the octant at hand
  std::vector<int> awake_;  // tiles of the hyperplane at hand
  std::vector<std::span<const int>> batches_;
  std::vector<std::uint32_t> first_;  // of each thread's batches, and the end
  std::vector<float> falls_;          // of each batch
};

void Sweeper::start() {
  const std::size_t count = schedule_.size();
  marks_.resize(count);  // not set here: each thread does it, and gets the pages, for its tiles
  for_tiles(count, [&](std::size_t t) {
    kernels_.encode(schedule_.tile(t).phi, active_bits(schedule_.leaf(t)), marks_[t].negative,
                    marks_[t].open);
  });
  for_tiles(count, [&](std::size_t t) { wake_from_seeds(schedule_, marks_.data(), t); });
}

/// Visits some tiles of one hyperplane; returns the largest fall.
float Sweeper::visit(std::span<const int> tiles) {
  TileBatch batch = batch_;
  batch.count = tiles.size();
  for (std::size_t n = 0; n < batch.count; ++n) {
    const auto t = static_cast<std::size_t>(tiles[n]);
    const TileSchedule::Tile& tile = schedule_.tile(t);
    schedule_.calm(t);
    batch.tile[n] = tile.phi;
    for (std::size_t face = 0; face < kFaces; ++face) {
      constexpr std::array<int, kFaces> kLayer{7 * 64, 0, 7 * 8, 0, 7, 0};
      const int other = tile.neighbour[face];
      batch.beside[face][n] =
          other < 0 ? nullptr : schedule_.tile(static_cast<std::size_t>(other)).phi + kLayer[face];
    }
  }
  narrowest(kernels_, batch.count).sweep(batch);
  for (std::size_t n = 0; n < batch.count; ++n) {
    const auto t = static_cast<std::size_t>(tiles[n]);
    if (batch.again[n] != 0) schedule_.wake(t, batch.again[n]);
    for (std::size_t face = 0; face < kFaces; ++face) {
      if (batch.wake[face][n] == 0) continue;
      schedule_.wake(static_cast<std::size_t>(schedule_.tile(t).neighbour[face]),
                     batch.wake[face][n]);
    }
  }
  return *std::max_element(batch.fall.begin(),
                           batch.fall.begin() + static_cast<std::ptrdiff_t>(batch.count));
}

/// Tiles of a hyperplane that are awake, an equal part for each thread, in batches. The first ones
/// go to the first thread: tiles are in the order of x, more or less, in all hyperplanes.
void Sweeper::share_plane(const TileSchedule::Plane& plane) {
  constexpr std::size_t kFew = 4;  // tiles that are not worth sharing
  awake_.clear();
  std::copy_if(plane.begin, plane.end, std::back_inserter(awake_),
               [&](int t) { return schedule_.awake(static_cast<std::size_t>(t), batch_.octant); });
  const std::size_t tiles = awake_.size();
  const std::size_t part = std::max(kFew, (tiles + threads_ - 1) / threads_);
  batches_.clear();
  for (std::size_t n = 0; n < threads_; ++n) {
    first_[n] = static_cast<std::uint32_t>(batches_.size());
    const std::size_t end = std::min(tiles, (n + 1) * part);
    for (std::size_t t = std::min(tiles, n * part); t < end; t += TileBatch::kMost) {
      batches_.push_back({awake_.data() + t, std::min(TileBatch::kMost, end - t)});
    }
  }
  first_[threads_] = static_cast<std::uint32_t>(batches_.size());
  falls_.assign(batches_.size(), 0);
}

template <typename Crew>
void Sweeper::octant(Crew& crew, const Progress& progress, SweepReport& report) {
  if (!schedule_.any_awake(1U << batch_.octant)) return;
  for (std::size_t p = 0; p < schedule_.planes(batch_.octant); ++p) {
    if ((p & 63U) == 0) progress.check();
    share_plane(schedule_.plane(batch_.octant, p));
    crew.run(first_);
    report.tile_visits += awake_.size();
    for (const float f : falls_) {
      report.last_change_voxels =
          std::max(report.last_change_voxels, static_cast<double>(f / batch_.h));
    }
  }
}

void Sweeper::run(const SweepOptions& options, float voxel, const Progress& progress,
                  SweepReport& report) {
  batch_.h = voxel;
  batch_.tolerance = static_cast<float>(options.tolerance_voxels) * voxel;
  first_.resize(threads_ + 1);
  parallel::Crew crew(threads_, [this](std::size_t n) { falls_[n] = visit(batches_[n]); });
  while (!report.converged && report.sweeps < options.max_sweeps) {
    report.last_change_voxels = 0;
    for (std::size_t o = 0; o < 8 && report.sweeps < options.max_sweeps; ++o) {
      batch_.octant = kRound[o];
      octant(crew, progress, report);
      ++report.sweeps;
    }
    report.converged =
        report.last_change_voxels <= options.tolerance_voxels && !schedule_.any_awake(0xff);
    // How many rounds an input needs is not known beforehand: half of the rest, each time.
    progress.update("sweep", 1.0 - std::pow(0.5, report.sweeps / 8.0));
  }
}

void Sweeper::finish(float limit) {
  for_tiles(schedule_.size(), [&](std::size_t t) {
    TileSchedule::Leaf& leaf = schedule_.leaf(t);
    TileBits active = active_bits(leaf);
    kernels_.decode(schedule_.tile(t).phi, active, marks_[t].negative, limit);
    TileSchedule::Leaf::NodeMaskType mask;
    for (openvdb::Index w = 0; w < 8; ++w) mask.getWord<std::uint64_t>(w) = active[w];
    leaf.setValueMask(mask);
  });
}

float limit_of(const Band& band) {
  return static_cast<float>(band.distance_world + kBandMarginVoxels * band.voxel_world);
}

struct Solver {
  const Kernels& kernels;
  const SweepOptions& options;
  const Progress& progress;

  SweepReport solve(openvdb::FloatTree& tree, const Band& band) const {
    SweepReport report;
    Sweeper sweeper(tree, kernels);
    sweeper.start();
    sweeper.run(options, static_cast<float>(band.voxel_world), progress, report);
    sweeper.finish(limit_of(band));
    return report;
  }
};

/// Gives what is inactive the sign of its side, as OpenVDB's tool does, which goes through the
/// voxels of leaves with none inactive too.
void flood_fill(openvdb::FloatTree& tree) {
  const openvdb::tools::SignedFloodFillOp<openvdb::FloatTree> op(tree);
  std::vector<TileSchedule::Leaf*> leaves;
  tree.getNodes(leaves);
  for_tiles(leaves.size(), [&](std::size_t n) {
    if (!leaves[n]->isValueMaskOn()) op(*leaves[n]);
  });
  openvdb::tools::signedFloodFill(tree, true, 1, 1);
}

/// With oblique boundaries a first solution says what stands beyond them, and the second starts
/// from there too.
void seed_beyond(const Solver& solver, Band& band) {
  openvdb::FloatTree first(band.phi->tree());
  solver.solve(first, band);
  add_ghosts(find_ghosts(first, band), band.phi->tree());
}

}  // namespace

void SweepOptions::validate() const {
  if (!(tolerance_voxels >= 0) || !std::isfinite(tolerance_voxels)) {
    throw InputError(fmt::format("sweep-tolerance = {}, but must be at least 0", tolerance_voxels));
  }
  if (!(max_sweeps >= 1 && max_sweeps <= 100000)) {
    throw InputError(fmt::format("max-sweeps = {}, but must be in [1, 100000]", max_sweeps));
  }
}

DistanceField sweep(Band band, const SweepOptions& options, const Progress& progress) {
  return sweep_with(*kernels(best_isa()), std::move(band), options, progress);
}

DistanceField sweep_with(const Kernels& kernels, Band band, const SweepOptions& options,
                         const Progress& progress) {
  options.validate();
  if (band.seed_count == 0 || !band.phi) {
    throw InputError("the band has no seeds: no voxel is near the wall");
  }
  DistanceField field;
  field.voxel_world = band.voxel_world;
  field.distance_world = band.distance_world;
  field.closed = band.closed;
  field.both_sides = band.both_sides;
  field.flat = band.flat;
  field.background_world = band.distance_world + kBandMarginVoxels * band.voxel_world;
  const float limit = limit_of(band);
  const Solver solver{kernels, options, progress};
  const bool oblique = band.boundaries && needs_ghosts(*band.boundaries);
  if (oblique) seed_beyond(solver, band);
  openvdb::FloatTree& tree = band.phi->tree();
  field.report = solver.solve(tree, band);
  if (band.boundaries && !oblique) add_ghosts(find_ghosts(tree, band), tree);
  openvdb::tools::pruneInactive(tree);
  if (band.closed) {
    tree.root().setBackground(limit, false);  // what is inactive the flood fill sets anyway
    flood_fill(tree);
    // Says that inactive voxels have the sign of their side: a writer need not see to it.
    band.phi->setGridClass(openvdb::GRID_LEVEL_SET);
  } else {
    openvdb::tools::changeBackground(tree, limit);
  }
  band.phi->setName("phi");
  field.report.active_voxels = tree.activeVoxelCount();
  field.report.bytes = tree.memUsage();
  field.phi = band.phi;
  return field;
}

}  // namespace vdb_offset
