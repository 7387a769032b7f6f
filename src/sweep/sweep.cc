// Zhao, A fast sweeping method for eikonal equations, 2005, on the leaf tiles of an OpenVDB tree.

#include "vdb_offset/sweep/sweep.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "sweep/tile_schedule.h"
#include "sweep/tile_sweep.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

using Tile = TileSchedule::Tile;

std::size_t leaf_offset(int x, int y, int z) {
  return static_cast<std::size_t>((x * 8 + y) * 8 + z);
}

void load_core(const Tile& tile, HaloTile& halo) {
  const float* phi = tile.leaf->buffer().data();
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) {
        const std::size_t n = leaf_offset(x, y, z);
        const auto m = static_cast<std::size_t>(HaloTile::index(x, y, z));
        const bool active = tile.leaf->isValueOn(static_cast<openvdb::Index>(n));
        halo.phi[m] = active ? std::abs(phi[n]) : Band::kUnreached;
        halo.floor[m] = tile.open.isOn(static_cast<openvdb::Index>(n)) ? 0.0F : halo.phi[m];
      }
    }
  }
}

/// The layer of the neighbour's voxels that touches the tile across face `face`.
void load_face(const TileSchedule& schedule, const Tile& tile, std::size_t face, HaloTile& halo) {
  const int neighbour = tile.neighbour[face];
  const TileSchedule::Leaf* leaf =
      neighbour < 0 ? nullptr : schedule.tiles()[static_cast<std::size_t>(neighbour)].leaf;
  const float* phi = leaf == nullptr ? nullptr : leaf->buffer().data();
  const int theirs = face % 2 == 0 ? 7 : 0;
  const int ours = face % 2 == 0 ? -1 : 8;
  for (int u = 0; u < 8; ++u) {
    for (int v = 0; v < 8; ++v) {
      const auto pick = [&](int w) {
        const std::size_t axis = face / 2;
        if (axis == 0) return std::array<int, 3>{w, u, v};
        return axis == 1 ? std::array<int, 3>{u, w, v} : std::array<int, 3>{u, v, w};
      };
      const auto to = pick(ours);
      float value = Band::kUnreached;
      if (phi != nullptr) {
        const auto from = pick(theirs);
        const std::size_t n = leaf_offset(from[0], from[1], from[2]);
        if (leaf->isValueOn(static_cast<openvdb::Index>(n))) value = std::abs(phi[n]);
      }
      halo.phi[static_cast<std::size_t>(HaloTile::index(to[0], to[1], to[2]))] = value;
    }
  }
}

/// Writes the magnitudes back under the old signs; bit f of the result: layer at face f changed.
unsigned store(const HaloTile& halo, const Tile& tile, float tolerance) {
  float* phi = tile.leaf->buffer().data();
  unsigned faces = 0;
  for (auto it = tile.open.beginOn(); it; ++it) {
    const openvdb::Index n = it.pos();
    const int x = static_cast<int>(n >> 6U);
    const int y = static_cast<int>(n >> 3U & 7U);
    const int z = static_cast<int>(n & 7U);
    const float fresh = halo.phi[static_cast<std::size_t>(HaloTile::index(x, y, z))];
    if (std::abs(phi[n]) - fresh > tolerance) {
      const std::array<int, 3> at{x, y, z};
      for (unsigned a = 0; a < 3; ++a) {
        if (at[a] == 0) faces |= 1U << (2 * a);
        if (at[a] == 7) faces |= 2U << (2 * a);
      }
    }
    phi[n] = std::copysign(fresh, phi[n]);
  }
  return faces;
}

/// Octants that travel towards + (or -) along an axis.
std::uint8_t octants_towards(std::size_t axis, int step) {
  unsigned mask = 0;
  for (unsigned o = 0; o < 8; ++o) {
    const std::array<int, 3> d{kOctants[o].x, kOctants[o].y, kOctants[o].z};
    if (d[axis] == step) mask |= 1U << o;
  }
  return static_cast<std::uint8_t>(mask);
}

class Sweeper {
 public:
  Sweeper(openvdb::FloatTree& tree, float voxel, float tolerance)
      : schedule_(tree), voxel_(voxel), tolerance_(tolerance), change_(schedule_.tiles().size()) {
    for (std::size_t f = 0; f < 6; ++f) towards_[f] = octants_towards(f / 2, f % 2 == 0 ? -1 : 1);
  }

  /// Wake every tile that holds or touches a seed.
  void start();
  void run(const SweepOptions& options, const Progress& progress, SweepReport& report);

 private:
  void octant(int number, const Progress& progress, SweepReport& report);
  void visit(int tile, int octant);

  TileSchedule schedule_;
  float voxel_;
  float tolerance_;
  std::array<std::uint8_t, 6> towards_{};  // octants that carry a change out through each face
  std::vector<float> change_;              // of each tile in the running octant, -1: not visited
};

void Sweeper::start() {
  for (std::size_t t = 0; t < schedule_.tiles().size(); ++t) {
    const Tile& tile = schedule_.tiles()[t];
    if (tile.leaf->onVoxelCount() == tile.open.countOn()) continue;
    schedule_.wake(static_cast<int>(t), 0xff);
    for (const int n : tile.neighbour) {
      if (n >= 0) schedule_.wake(n, 0xff);
    }
  }
}

void Sweeper::visit(int index, int octant) {
  const auto t = static_cast<std::size_t>(index);
  if (!schedule_.take(index, octant)) return;
  const Tile& tile = schedule_.tiles()[t];
  HaloTile halo;
  load_core(tile, halo);
  for (std::size_t face = 0; face < 6; ++face) load_face(schedule_, tile, face, halo);
  change_[t] = sweep_tile(halo, kOctants[static_cast<std::size_t>(octant)], voxel_);
  if (change_[t] <= 0) return;
  const unsigned faces = store(halo, tile, tolerance_);
  if (change_[t] <= tolerance_) return;
  schedule_.wake(index, static_cast<std::uint8_t>(~(1U << static_cast<unsigned>(octant))));
  for (std::size_t face = 0; face < 6; ++face) {
    if ((faces >> face & 1U) == 0 || tile.neighbour[face] < 0) continue;
    schedule_.wake(tile.neighbour[face], towards_[face]);
  }
}

void Sweeper::octant(int number, const Progress& progress, SweepReport& report) {
  const Octant& octant = kOctants[static_cast<std::size_t>(number)];
  std::fill(change_.begin(), change_.end(), -1.0F);
  for (std::size_t p = 0; p < schedule_.planes(octant); ++p) {
    if ((p & 63U) == 0) progress.check();
    const TileSchedule::Plane plane = schedule_.plane(octant, p);
    parallel::for_ranges(static_cast<std::size_t>(plane.end - plane.begin), 8,
                         [&](std::size_t begin, std::size_t end) {
                           for (std::size_t n = begin; n < end; ++n) visit(plane.begin[n], number);
                         });
  }
  float largest = 0;
  for (const float change : change_) {
    if (change < 0) continue;
    ++report.tile_visits;
    largest = std::max(largest, change);
  }
  report.last_change_voxels =
      std::max(report.last_change_voxels, static_cast<double>(largest / voxel_));
}

void Sweeper::run(const SweepOptions& options, const Progress& progress, SweepReport& report) {
  while (!report.converged && report.sweeps < options.max_sweeps) {
    report.last_change_voxels = 0;
    for (int o = 0; o < 8 && report.sweeps < options.max_sweeps; ++o) {
      octant(o, progress, report);
      ++report.sweeps;
    }
    report.converged =
        report.last_change_voxels <= options.tolerance_voxels && !schedule_.any_awake();
    // How many rounds an input needs is not known beforehand: half of the rest, each time.
    progress.update("sweep", 1.0 - std::pow(0.5, report.sweeps / 8.0));
  }
}

/// Voxels beyond the margin leave the band; what is inactive holds the background.
void trim(openvdb::FloatTree& tree, float limit) {
  for (auto leaf = tree.beginLeaf(); leaf; ++leaf) {
    float* phi = leaf->buffer().data();
    for (openvdb::Index n = 0; n < TileSchedule::Leaf::SIZE; ++n) {
      if (leaf->isValueOn(n) && std::abs(phi[n]) <= limit) continue;
      leaf->setValueOff(n, std::copysign(limit, phi[n]));
    }
  }
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
  options.validate();
  if (band.seed_count == 0 || !band.phi) {
    throw InputError("the band has no seeds: no voxel is near the wall");
  }
  DistanceField field;
  field.voxel_world = band.voxel_world;
  field.distance_world = band.distance_world;
  field.closed = band.closed;
  field.both_sides = band.both_sides;
  const auto voxel = static_cast<float>(band.voxel_world);
  openvdb::FloatTree& tree = band.phi->tree();
  {
    Sweeper sweeper(tree, voxel, static_cast<float>(options.tolerance_voxels) * voxel);
    sweeper.start();
    sweeper.run(options, progress, field.report);
  }
  field.background_world = band.distance_world + kBandMarginVoxels * band.voxel_world;
  const auto limit = static_cast<float>(field.background_world);
  trim(tree, limit);
  openvdb::tools::pruneInactive(tree);
  tree.root().setBackground(limit, true);
  if (band.closed) openvdb::tools::signedFloodFill(tree);
  band.phi->setName("phi");
  field.report.active_voxels = tree.activeVoxelCount();
  field.report.bytes = tree.memUsage();
  field.phi = band.phi;
  return field;
}

}  // namespace vdb_offset
