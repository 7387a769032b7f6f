#include "vdb_offset/rasterize/rasterize.h"

#include <doctest/doctest.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <limits>
#include <regex>

#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// The whole of an open surface's band, past its free edges too.
const SurfaceOptions kNoPlanes = [] {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  return options;
}();

Surface example(const char* name, int points) {
  ExampleOptions options;
  options.points = points;
  return build_surface(make_example(name, options), kNoPlanes);
}

bool is_seed(float phi) { return std::abs(phi) < Band::kUnreached; }

/// Seeds hold the exact distance, and every voxel near the wall is one, on both sides.
void check_seeds(const Surface& surface, const RasterizeOptions& options) {
  const Band band = rasterize(surface, options);
  const double h = band.voxel_world;
  std::uint64_t seeds = 0;
  for (auto it = band.phi->cbeginValueOn(); it; ++it) {
    if (!is_seed(*it)) continue;
    ++seeds;
    if (seeds % 97 != 1) continue;
    const Vec3 p = h * Vec3(it.getCoord().x(), it.getCoord().y(), it.getCoord().z());
    const double exact = brute_force_distance(*surface.wall, p);
    CHECK(std::abs(std::abs(*it) - exact) <= 6e-8 * exact + 1e-14);
  }
  CHECK(seeds == band.seed_count);
  std::mt19937_64 random(1);
  const auto accessor = band.phi->getConstAccessor();
  const double reach = options.distance_world + kBandMarginVoxels * h;
  Box box = surface.wall->bounds();
  box.lo.array() -= 1.2 * reach;
  box.hi.array() += 1.2 * reach;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 q = (random_point(random, box) / h).array().round();
    const WallPoint nearest = surface.wall->closest(h * q);
    const openvdb::Coord c(static_cast<int>(q.x()), static_cast<int>(q.y()),
                           static_cast<int>(q.z()));
    float phi = 0;
    const bool active = accessor.probeValue(c, phi);
    const double signed_distance = nearest.side(h * q) * nearest.distance_world;
    CAPTURE(signed_distance / h);
    if (nearest.distance_world <= kSeedReachVoxels * h) {
      CHECK(active);
      CHECK(is_seed(phi));
    } else if (signed_distance > 0 && signed_distance <= reach) {
      CHECK(active);
      CHECK(phi == Band::kUnreached);
    } else if (signed_distance < 0 && options.both_sides && -signed_distance <= reach) {
      CHECK(active);
      CHECK(phi == -Band::kUnreached);
    } else if (signed_distance < 0 && !options.both_sides) {
      CHECK_FALSE(active);
    }
  }
}

std::string refusal(const Surface& surface, const RasterizeOptions& options) {
  try {
    rasterize(surface, options);
  } catch (const LimitError& error) {
    return error.what();
  }
  return "no refusal";
}

}  // namespace

TEST_CASE("rasterize: seeds are exact and the band complete, on one side and on both") {
  for (const char* name : {"sphere", "u-slot", "naca0012-wing"}) {
    CAPTURE(name);
    const Surface surface = example(name, 9);
    for (const bool both : {false, true}) {
      check_seeds(surface, {.distance_world = 0.25, .voxel_world = 0.03, .both_sides = both});
    }
  }
}

TEST_CASE("rasterize: a body beside a tank, whose outside is behind, have both their bands") {
  Patches patches = make_example("sphere", {.points = 9});
  for (Patch patch : make_example("sphere", {.points = 9})) {
    for (Vec3& x : patch.points_world) x = Vec3(4, 4, 4) - x;  // inside out
    patches.push_back(patch);
  }
  const Surface surface = build_surface(patches);
  check_seeds(surface, {.distance_world = 0.8, .voxel_world = 0.04});
  // The bands meet in the plane between the two.
  check_seeds(surface, {.distance_world = 2, .voxel_world = 0.08});
  check_seeds(surface, {.distance_world = 2, .voxel_world = 0.4});
  check_seeds(surface, {.distance_world = 2, .voxel_world = 0.08, .both_sides = true});
}

TEST_CASE("rasterize: one body in another, both with their normals out, has its front there") {
  Patches patches = make_example("sphere", {.points = 9});
  for (Patch patch : make_example("sphere", {.points = 9})) {
    for (Vec3& x : patch.points_world) x = Vec3(0.3, 0.2, 0.1) + 0.25 * x;
    patches.push_back(patch);
  }
  check_seeds(build_surface(patches), {.distance_world = 0.8, .voxel_world = 0.03});
}

TEST_CASE("rasterize: surfaces far finer and far coarser than a voxel are seeded alike") {
  check_seeds(example("sphere", 65), {.distance_world = 1, .voxel_world = 0.4});
  check_seeds(example("cube", 3), {.distance_world = 0.1, .voxel_world = 0.02});
  // A body that fits between the voxels is not lost.
  Patches speck = make_example("sphere", {.points = 5});
  for (Patch& patch : speck) {
    for (Vec3& x : patch.points_world) x = Vec3(0.5, 0.5, 0.5) + 0.01 * x;
  }
  const Surface surface = build_surface(speck);
  check_seeds(surface, {.distance_world = 3, .voxel_world = 1});
}

TEST_CASE("rasterize: an open sheet has its band on the marching side, its plane beyond the edge") {
  const Surface sheet = build_surface(
      {rectangle("sheet", {9, 9}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})}, kNoPlanes);
  check_seeds(sheet, {.distance_world = 0.3, .voxel_world = 0.04});
}

TEST_CASE("rasterize: an open surface's band without sign has the same voxels and distances") {
  RasterizeOptions options{.distance_world = 0.25, .voxel_world = 0.03, .both_sides = true};
  const Surface wing = example("naca0012-wing", 9);
  const Band signed_band = rasterize(wing, options);
  options.unsigned_if_open = true;
  const Band band = rasterize(wing, options);
  CHECK(band.seed_count == signed_band.seed_count);
  const auto is_reached = [&](const Vec3& p) {
    return wing.wall->closest(p).distance_world < options.distance_world;
  };
  for (auto it = signed_band.phi->cbeginValueOn(); it; ++it) {
    const openvdb::Coord c = it.getCoord();
    if (band.phi->tree().isValueOn(c)) continue;  // the rest lies in tiles at the rim
    CHECK(!is_reached(options.voxel_world * Vec3(c.x(), c.y(), c.z())));
  }
  const auto other = signed_band.phi->getConstAccessor();
  std::uint64_t different = 0;
  std::uint64_t negative = 0;
  for (auto it = band.phi->cbeginValueOn(); it; ++it) {
    if (!other.isValueOn(it.getCoord()) && *it == Band::kUnreached) continue;
    // Found without what the nearest place lies on, the distance may be rounded the other way.
    const float expected = std::abs(other.getValue(it.getCoord()));
    const float rounding =
        std::numeric_limits<float>::epsilon() * expected + 1e-15F;  // on the wall
    if (std::abs(*it - expected) > rounding) ++different;
    if (other.getValue(it.getCoord()) < 0) ++negative;
  }
  CHECK(different == 0);
  CHECK(negative > 0);
  // A closed surface keeps its inside.
  const Surface sphere = example("sphere", 9);
  const Vec3 inside = 0.9 * sphere.nodes_world[0] / options.voxel_world;
  const openvdb::Coord c(static_cast<int>(inside.x()), static_cast<int>(inside.y()),
                         static_cast<int>(inside.z()));
  CHECK(rasterize(sphere, options).phi->getConstAccessor().getValue(c) < 0);
}

TEST_CASE("rasterize: the lattice does not move with the surface") {
  const Surface surface = example("sphere", 9);
  const Band band = rasterize(surface, {.distance_world = 0.3, .voxel_world = 0.1});
  CHECK(band.phi->indexToWorld(openvdb::Coord(0, 0, 0)) == openvdb::Vec3d(0.0));
  CHECK(band.phi->voxelSize().x() == 0.1);
}

TEST_CASE("rasterize: the default voxel is the smaller of distance / 12 and the median edge") {
  const Surface surface = example("cube", 17);
  CHECK(plan_band(surface, {.distance_world = 0.24}).voxel_world == doctest::Approx(0.02));
  CHECK(plan_band(surface, {.distance_world = 0.24}).rule == VoxelRule::Distance);
  CHECK(plan_band(surface, {.distance_world = 3}).voxel_world == doctest::Approx(1.0 / 16));
  CHECK(plan_band(surface, {.distance_world = 3}).rule == VoxelRule::SurfaceEdge);
}

TEST_CASE("rasterize: the plan is an upper estimate, within a third of the tiles made") {
  for (const char* name : {"sphere", "l-bar"}) {
    const Surface surface = example(name, 17);
    const Band band = rasterize(surface, {.distance_world = 0.5, .voxel_world = 0.01});
    const auto tiles = static_cast<double>(band.phi->tree().leafCount());
    CHECK(static_cast<double>(band.plan.tiles) >= tiles);
    CHECK(static_cast<double>(band.plan.tiles) < 1.34 * tiles);
    CHECK(band.plan.bytes >= band.phi->tree().memUsage());
  }
}

TEST_CASE("rasterize: memory is obeyed before anything is allocated, and the advice fits") {
  const Surface surface = example("sphere", 9);
  RasterizeOptions options{.distance_world = 1, .voxel_world = 1e-4, .memory_bytes = 64U << 20U};
  const std::string text = refusal(surface, options);
  CAPTURE(text);
  std::smatch advice;
  REQUIRE(std::regex_search(text, advice, std::regex("--voxel ([-+.0-9e]+) would fit")));
  options.voxel_world = std::stod(advice[1]);
  CHECK(plan_band(surface, options).total_bytes <= options.memory_bytes);
  options.voxel_world *= 0.8;
  CHECK(refusal(surface, options) != "no refusal");
  options.voxel_world = 0;
  options.distance_world = 1e-3;
  CHECK(plan_band(surface, options).rule == VoxelRule::Memory);
  options.memory_bytes = 1000;
  CHECK(refusal(surface, options) != "no refusal");
}

TEST_CASE("rasterize: absurd lattices and distances are refused") {
  const Surface surface = example("sphere", 5);
  CHECK(refusal(surface, {.distance_world = 1, .voxel_world = 1e-14}) != "no refusal");
  for (const double d : {1e14, 1e30, 1e99}) {
    CHECK_THROWS_AS(plan_band(surface, {.distance_world = d}), LimitError);
    CHECK_THROWS_AS(plan_band(surface, {.distance_world = d, .voxel_world = 0.1 * d}), InputError);
  }
  for (const double d : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    CHECK_THROWS_AS(plan_band(surface, {.distance_world = d}), InputError);
    if (d != 0) {
      CHECK_THROWS_AS(plan_band(surface, {.distance_world = 1, .voxel_world = d}), InputError);
    }
  }
}

TEST_CASE("rasterize: what the output holds for each tile leaves room for fewer of them") {
  const Surface surface = example("sphere", 9);
  RasterizeOptions options{.distance_world = 1, .voxel_world = 0.05};
  const BandPlan plain = plan_band(surface, options);
  options.output_tile_bytes = 100;  // less than the sweep takes, which is over by then
  CHECK(plan_band(surface, options).total_bytes == plain.total_bytes);
  options.output_tile_bytes = 10000;
  const BandPlan more = plan_band(surface, options);
  CHECK(more.tiles == plain.tiles);
  CHECK(more.bytes >= plain.tiles * (sizeof(float) * 512 + 10000));
  options.memory_bytes = more.total_bytes - 1;
  CHECK_THROWS_AS(plan_band(surface, options), LimitError);
}

TEST_CASE("rasterize: one thread and two make the same tree") {
  const Surface surface = example("l-bar", 17);
  const auto run = [&] { return rasterize(surface, {.distance_world = 0.3}).phi; };
  const auto one = on_threads(1, run);
  const auto two = on_threads(2, run);
  CHECK(one->tree().hasSameTopology(two->tree()));
  auto other = two->getConstAccessor();
  bool same = true;
  for (auto it = one->cbeginValueOn(); it; ++it)
    same = same && *it == other.getValue(it.getCoord());
  CHECK(same);
}

TEST_CASE("rasterize: cancelling stops it") {
  std::atomic<bool> cancel = true;
  const Progress progress{{}, &cancel};
  CHECK_THROWS_AS(rasterize(example("sphere", 9), {.distance_world = 0.3}, progress), Cancelled);
  CHECK_THROWS_AS(plan_band(example("sphere", 9), {.distance_world = 0.3}, progress), Cancelled);
}
