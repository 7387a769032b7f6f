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
#include "sweep/wavefront.h"
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
  bool visit_some(std::size_t member);
  float visit(std::span<const int> tiles);

  TileSchedule schedule_;
  const Kernels& kernels_;
  const std::size_t threads_ = parallel::threads();
  WholeLargeVector<TileMarks> marks_;
  unsigned octant_ = 0;
  float h_ = 1;          // voxel, world units
  float tolerance_ = 0;  // world units
  Wavefront wavefront_{schedule_, threads_};
  struct alignas(64) Fall {
    float most = 0;
  };
  std::vector<Fall> falls_;  // of each thread
};

void Sweeper::start() {
  const std::size_t count = schedule_.size();
  marks_.resize(count);  // not set here: each thread does it, and gets the pages, for its tiles
  parallel::Tasks orders;
  for (std::size_t f = 0; f < TileSchedule::kFamilies; ++f) {
    orders.run([this, f] { schedule_.order(f); });
  }
  for_tiles(count, [&](std::size_t t) {
    schedule_.find_buffer(t);
    kernels_.encode(schedule_.tile(t).phi, active_bits(*schedule_.tile(t).leaf), marks_[t].negative,
                    marks_[t].open);
  });
  orders.wait();
  for_tiles(count, [&](std::size_t t) { wake_from_seeds(schedule_, marks_.data(), t); });
}

/// A batch of the octant at hand, if there is one.
bool Sweeper::visit_some(std::size_t member) {
  std::array<int, TileBatch::kMost> tiles;
  const std::size_t count = wavefront_.take(member, tiles);
  if (count == 0) return false;
  float& fall = falls_[member].most;
  fall = std::max(fall, visit(std::span(tiles).first(count)));
  return true;
}

/// Visits tiles that are no neighbours; returns the largest fall.
float Sweeper::visit(std::span<const int> tiles) {
  TileBatch batch;
  batch.octant = octant_;
  batch.h = h_;
  batch.tolerance = tolerance_;
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

void Sweeper::run(const SweepOptions& options, float voxel, const Progress& progress,
                  SweepReport& report) {
  h_ = voxel;
  tolerance_ = static_cast<float>(options.tolerance_voxels) * voxel;
  parallel::Crew crew(threads_, [this](std::size_t member) { return visit_some(member); });
  while (!report.converged && report.sweeps < options.max_sweeps) {
    falls_.assign(threads_, {});
    for (std::size_t o = 0; o < 8 && report.sweeps < options.max_sweeps; ++o) {
      ++report.sweeps;
      if (!schedule_.any_awake(1U << kRound[o])) continue;
      octant_ = kRound[o];
      wavefront_.begin(octant_);
      crew.run([&] { progress.check(); }, [&] { return wavefront_.is_over(); });
    }
    float fall = 0;
    for (const Fall& own : falls_) fall = std::max(fall, own.most);
    report.last_change_voxels = static_cast<double>(fall / voxel);
    report.converged =
        report.last_change_voxels <= options.tolerance_voxels && !schedule_.any_awake(0xff);
    // How many rounds an input needs is not known beforehand: half of the rest, each time.
    progress.update("sweep", 1.0 - std::pow(0.5, report.sweeps / 8.0));
  }
  report.tile_visits = wavefront_.visits();
}

void Sweeper::finish(float limit) {
  for_tiles(schedule_.size(), [&](std::size_t t) {
    TileSchedule::Leaf& leaf = *schedule_.tile(t).leaf;
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
