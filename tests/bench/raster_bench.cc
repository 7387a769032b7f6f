// Rasterize against openvdb::tools::meshToVolume: the same triangles, band and threads, in one
// process, alternating. Ours includes building the wall (its hierarchy and pseudonormals).

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/rasterize/rasterize.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;

namespace {

constexpr double kBandVoxels = 3;

struct Input {
  std::string name;
  Vec3List vertices;
  std::vector<Wall::Triangle> triangles;
  double voxel_world;
  bool closed;
};

struct Run {
  double wall_s = 0, ours_s = 0, peer_s = 0;  // ours: wall included
  std::uint64_t seeds = 0, peer_voxels = 0;
  double worst_voxels = 0;  // largest difference of the magnitudes
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Input from_surface(const std::string& name, const Surface& surface, double voxel_world) {
  return {name, surface.wall->vertices(), surface.wall->triangles(), voxel_world, surface.closed};
}

Input sphere(double radius_voxels) {
  const Surface surface = build_surface(make_example("sphere", {.points = 83}));
  return from_surface(fmt::format("sphere, R = {}", radius_voxels), surface, 1 / radius_voxels);
}

Input plate() {
  constexpr int kCells = 200;
  Input in{"thin plate", {}, {}, 1.0 / 400, true};
  // Two sheets a tenth of a voxel apart, closed along their rim by nothing: thinner than a voxel.
  for (int side = 0; side < 2; ++side) {
    const auto base = static_cast<int>(in.vertices.size());
    for (int j = 0; j <= kCells; ++j) {
      for (int i = 0; i <= kCells; ++i) {
        in.vertices.emplace_back(i / double(kCells), j / double(kCells), side * 0.1 / 400);
      }
    }
    for (int j = 0; j < kCells; ++j) {
      for (int i = 0; i < kCells; ++i) {
        const int a = base + j * (kCells + 1) + i;
        const int b = a + 1;
        const int c = a + kCells + 2;
        const int d = a + kCells + 1;
        if (side == 1) {
          in.triangles.push_back({a, b, c});
          in.triangles.push_back({a, c, d});
        } else {
          in.triangles.push_back({a, c, b});
          in.triangles.push_back({a, d, c});
        }
      }
    }
  }
  in.closed = false;
  return in;
}

Input speckles() {
  Input in{"random tiny triangles", {}, {}, 1.0 / 100, false};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto point = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (int n = 0; n < 100'000; ++n) {
    const Vec3 centre = point();
    for (int c = 0; c < 3; ++c) in.vertices.push_back(centre + 1e-3 * point());
    in.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return in;
}

double run_ours(const Input& in, Run& run, Band& band) {
  Vec3List vertices = in.vertices;
  std::vector<Wall::Triangle> triangles = in.triangles;
  const auto start = std::chrono::steady_clock::now();
  Surface surface;
  surface.wall = std::make_shared<const Wall>(std::move(vertices), std::move(triangles));
  surface.closed = in.closed;
  run.wall_s = seconds_since(start);
  RasterizeOptions options;
  options.distance_world = 1e-3 * in.voxel_world;
  options.voxel_world = in.voxel_world;
  options.both_sides = true;
  options.exact_voxels = kBandVoxels;
  band = rasterize(surface, options);
  run.seeds = band.seed_count;
  return seconds_since(start);
}

double run_peer(const Input& in, openvdb::FloatGrid::Ptr& grid) {
  std::vector<openvdb::Vec3d> points;
  for (const Vec3& v : in.vertices) {
    const Vec3 p = v / in.voxel_world;
    points.emplace_back(p.x(), p.y(), p.z());
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : in.triangles) {
    triangles.emplace_back(static_cast<unsigned>(t[0]), static_cast<unsigned>(t[1]),
                           static_cast<unsigned>(t[2]));
  }
  const auto start = std::chrono::steady_clock::now();
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3d, openvdb::Vec3I> mesh(points,
                                                                                        triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(in.voxel_world);
  const auto reach = static_cast<float>(kBandVoxels);
  grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      mesh, *transform, reach, reach, in.closed ? 0 : openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  return seconds_since(start);
}

double worst_difference(const Input& in, const Band& band, const openvdb::FloatGrid& peer) {
  const auto ours = band.phi->getConstAccessor();
  double worst = 0;
  for (auto it = peer.cbeginValueOn(); it; ++it) {
    const double phi = ours.getValue(it.getCoord());
    if (std::abs(phi) >= Band::kUnreached) continue;
    worst = std::max(worst, std::abs(std::abs(phi) - std::abs(double(*it))) / in.voxel_world);
  }
  return worst;
}

template <typename T>
T median(std::vector<T> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void compare(const Input& in, int repeats, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  Run run;
  std::vector<double> ours;
  std::vector<double> peer;
  std::vector<double> wall;
  for (int r = 0; r < repeats; ++r) {
    Band band;
    openvdb::FloatGrid::Ptr grid;
    ours.push_back(run_ours(in, run, band));
    wall.push_back(run.wall_s);
    peer.push_back(run_peer(in, grid));
    run.peer_voxels = grid->activeVoxelCount();
    if (r == 0) run.worst_voxels = worst_difference(in, band, *grid);
  }
  fmt::print(
      "{:<22} {} thread  {:>8} triangles  {:>9} seeds {:>9} peer's  ours {:.4f} s (wall "
      "{:.4f})  peer {:.4f} s  ratio {:.2f}  worst difference {:.1e} voxel\n",
      in.name, threads, in.triangles.size(), run.seeds, run.peer_voxels, median(ours), median(wall),
      median(peer), median(peer) / median(ours), run.worst_voxels);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  const int repeats = argc > 1 ? std::atoi(argv[1]) : 5;
  const std::string only = argc > 2 ? argv[2] : "";
  const char* data = std::getenv("VDB_OFFSET_SHARED_DATA");
  std::vector<Input> inputs{sphere(100), sphere(300), plate(), speckles()};
  if (data != nullptr) {
    const Surface bwb = build_surface(read_plot3d(std::string(data) + "/plot3d/bwb.fmt"));
    inputs.push_back(from_surface("bwb", bwb, bwb.wall->bounds().size() / 400));
  }
  for (const Input& in : inputs) {
    if (in.name.find(only) == std::string::npos) continue;
    for (const int threads : {1, 2}) compare(in, repeats, threads);
  }
}
