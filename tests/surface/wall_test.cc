#include "vdb_offset/surface/wall.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

Box inflated(const Wall& wall, double part) {
  Box box = wall.bounds();
  const Vec3 margin = Vec3::Constant(part * box.size());
  box.lo -= margin;
  box.hi += margin;
  return box;
}

double worst_against_brute_force(const Wall& wall, int queries, double margin) {
  std::mt19937_64 random(7);
  double worst = 0;
  for (int n = 0; n < queries; ++n) {
    const Vec3 q = random_point(random, inflated(wall, margin));
    const double exact = brute_force_distance(wall, q);
    const double scale = std::max(exact, 1e-3 * wall.bounds().size());
    worst = std::max(worst, std::abs(wall.closest(q).distance_world - exact) / scale);
  }
  return worst;
}

// Sanitized code is twenty times slower and is not here for the accuracy.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kQueries = 500;
#else
constexpr int kQueries = 10'000;
#endif

/// kQueries points: half of them in a box around the wall, half beside its vertices, from a
/// millionth of its size to a tenth. The largest error of a batch, as a part of the one allowed:
/// 1e-12 of the distance. Where that is less than the rounding of the coordinates, 1e-15 of the
/// size: there the query itself is no nearer to the place that was meant.
double worst_of_batch(const Wall& wall) {
  const double size = wall.bounds().size();
  const BruteForce reference(wall);
  std::mt19937_64 random(17);
  std::uniform_int_distribution<std::size_t> vertex(0, wall.vertices().size() - 1);
  std::uniform_real_distribution<double> exponent(-6, -1);
  const Box cube{Vec3::Constant(-1), Vec3::Constant(1)};
  Vec3List queries;
  for (int n = 0; n < kQueries / 2; ++n) {
    queries.push_back(random_point(random, inflated(wall, 0.3)));
    const double away = size * std::pow(10, exponent(random));
    queries.push_back(wall.vertices()[vertex(random)] + away * random_point(random, cube));
  }
  const std::vector<double> distances = wall.true_distance(queries);
  double worst = 0;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double exact = reference.distance(queries[n]);
    const double allowed = std::max(1e-12 * exact, 1e-15 * size);
    worst = std::max(worst, std::abs(distances[n] - exact) / allowed);
  }
  return worst;
}

}  // namespace

TEST_CASE("wall: distances equal those to the nearest of all triangles") {
  for (const char* name : {"sphere", "l-bar", "naca0012-wing", "sphere-pair"}) {
    CAPTURE(name);
    ExampleOptions options;
    options.points = 9;
    const Surface surface = build_surface(make_example(name, options));
    CHECK(worst_against_brute_force(*surface.wall, 300, 0.3) < 1e-12);
    CHECK(worst_against_brute_force(*surface.wall, 50, 30) < 1e-12);
  }
}

TEST_CASE("wall: true_distance agrees with brute force at 10,000 points around each surface") {
  for (const ExampleInfo& info : examples()) {
    CAPTURE(info.name);
    const Patches patches = make_example(info.name, {.points = 5});
    if (patches[0].nj == 1) continue;  // curves
    const Surface surface = build_surface(patches);
    CHECK(worst_of_batch(*surface.wall) < 1);
  }
  for (const char* name : {"sphere", "draft-tube"}) {
    CAPTURE(name);
    CHECK(worst_of_batch(*build_surface(make_example(name)).wall) < 1);
  }
}

TEST_CASE("wall: true_distance agrees with brute force at 10,000 points around a real aircraft") {
  const auto data = shared_data();
  if (!data) {
    MESSAGE("skipped: the real geometry is not here");
    return;
  }
  const Surface bwb = build_surface(read_plot3d(*data + "/plot3d/bwb.fmt"));
  CHECK(worst_of_batch(*bwb.wall) < 1);
}

TEST_CASE("wall: distances of a batch do not depend on its order, its company or the threads") {
  const Surface surface = build_surface(make_example("naca0012-wing", {.points = 17}));
  const Wall& wall = *surface.wall;
  std::mt19937_64 random(23);
  Vec3List queries;
  for (int n = 0; n < 20'000; ++n) queries.push_back(random_point(random, inflated(wall, 0.1)));
  for (std::size_t n = 0; n < 500; ++n) queries.push_back(wall.vertices()[n]);
  queries.emplace_back(std::nan(""), 0, 0);
  const auto ask = [&] { return wall.true_distance(queries); };
  const std::vector<double> one = on_threads(1, ask);
  const std::vector<double> four = on_threads(4, ask);
  bool same = true;
  for (std::size_t n = 0; n + 1 < queries.size(); ++n) {
    same = same && one[n] == four[n] && one[n] == wall.closest(queries[n]).distance_world;
  }
  CHECK(same);
  CHECK(wall.true_distance({}).empty());
}

TEST_CASE("wall: needles and triangles of no area keep their distances") {
  const Vec3List v{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}, {0.3, 0, 0}, {2, 2, 2}, {2, 2, 2.5}};
  const Wall wall(v, {{0, 1, 2}, {0, 1, 3}, {4, 5, 4}, {0, 4, 5}});
  CHECK(wall.triangles().size() == 3);
  CHECK(worst_against_brute_force(wall, 500, 0.5) < 1e-12);
}

TEST_CASE("wall: the sign of the distance tells inside from outside a closed surface") {
  for (const char* name : {"cube", "l-bar", "u-slot", "torus"}) {
    CAPTURE(name);
    ExampleOptions options;
    options.points = 9;
    const Surface surface = build_surface(make_example(name, options));
    std::mt19937_64 random(11);
    int inside = 0;
    for (int n = 0; n < 300; ++n) {
      const Vec3 q = random_point(random, inflated(*surface.wall, 0.05));
      // Van Oosterom and Strackee's solid angle of each triangle: 4 pi inside, 0 outside.
      double winding = 0;
      for (const auto& t : surface.wall->triangles()) {
        const auto p = [&](std::size_t c) {
          return Vec3(surface.wall->vertices()[static_cast<std::size_t>(t[c])] - q);
        };
        const Vec3 a = p(0);
        const Vec3 b = p(1);
        const Vec3 c = p(2);
        const double la = a.norm();
        const double lb = b.norm();
        const double lc = c.norm();
        const Vec3 bxc(b.y() * c.z() - b.z() * c.y(), b.z() * c.x() - b.x() * c.z(),
                       b.x() * c.y() - b.y() * c.x());
        winding += 2 * std::atan2(a.dot(bxc),
                                  la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
      }
      const bool is_inside = winding > 6.28;
      inside += is_inside ? 1 : 0;
      CHECK(surface.wall->closest(q).side(q) == (is_inside ? -1.0 : 1.0));
    }
    CHECK(inside > 10);
    CHECK(inside < 290);
  }
}

TEST_CASE("wall: a search limit hides what lies beyond it and nothing else") {
  ExampleOptions options;
  options.points = 9;
  const Surface surface = build_surface(make_example("sphere", options));
  std::mt19937_64 random(3);
  for (int n = 0; n < 200; ++n) {
    const Vec3 q = random_point(random, inflated(*surface.wall, 0.5));
    const double d = surface.wall->closest(q).distance_world;
    CHECK(surface.wall->closest(q, d * (1 + 1e-12)).distance_world == d);
    CHECK(surface.wall->closest(q, d * 0.999).triangle == -1);
  }
}

TEST_CASE("wall: places on the open boundary are marked") {
  const Surface surface =
      build_surface({rectangle("sheet", {5, 5}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})});
  CHECK(surface.wall->closest({1.5, 0.5, 0.2}).on_free_edge);
  CHECK(surface.wall->closest({-0.5, -0.5, 0.2}).on_free_edge);
  CHECK_FALSE(surface.wall->closest({0.6, 0.45, 0.2}).on_free_edge);
}

TEST_CASE("wall: batched distances are those of single queries") {
  const Surface surface = build_surface(make_example("cube"));
  std::mt19937_64 random(5);
  Vec3List queries;
  for (int n = 0; n < 1000; ++n)
    queries.push_back(random_point(random, inflated(*surface.wall, 1)));
  const std::vector<double> batch = surface.wall->true_distance(queries);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    CHECK(batch[n] == surface.wall->closest(queries[n]).distance_world);
  }
}

TEST_CASE("wall: no triangles and points that are not finite are refused") {
  CHECK_THROWS_AS(Wall({Vec3::Zero(), Vec3::UnitX()}, {{0, 1, 1}}), InputError);
  CHECK_THROWS_AS(Wall({Vec3::Zero(), Vec3::UnitX(), Vec3(0, std::nan(""), 0)}, {{0, 1, 2}}),
                  InputError);
}
