#include "vdb_offset/surface/wall.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
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

// A needle of sine s loses 2 log10(1 / s) digits in the plain formulas below: long double has too
// few for that.
#if defined(__SIZEOF_FLOAT128__)
__extension__ using Quad = __float128;
#else
using Quad = long double;
#endif
using QuadVec = std::array<Quad, 3>;

Quad dot(const QuadVec& u, const QuadVec& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/// p - a - s u - t v
QuadVec minus(const QuadVec& q, Quad s, const QuadVec& u, Quad t, const QuadVec& v) {
  return {q[0] - s * u[0] - t * v[0], q[1] - s * u[1] - t * v[1], q[2] - s * u[2] - t * v[2]};
}

QuadVec between(const Vec3& from, const Vec3& to) {
  return {Quad(to.x()) - from.x(), Quad(to.y()) - from.y(), Quad(to.z()) - from.z()};
}

/// Least of the three segments and, where it is inside, the foot by its barycentric coordinates.
double quad_distance(const std::array<Vec3, 3>& corners, const Vec3& p) {
  Quad best = HUGE_VAL;
  for (std::size_t c = 0; c < 3; ++c) {
    const QuadVec e = between(corners[c], corners[(c + 1) % 3]);
    const QuadVec q = between(corners[c], p);
    Quad t = dot(e, e) > 0 ? dot(e, q) / dot(e, e) : Quad(0);
    t = t < 0 ? Quad(0) : (t > 1 ? Quad(1) : t);
    const QuadVec rest = minus(q, t, e, 0, e);
    best = std::min(best, dot(rest, rest));
  }
  const QuadVec u = between(corners[0], corners[1]);
  const QuadVec v = between(corners[0], corners[2]);
  const QuadVec q = between(corners[0], p);
  const Quad area2 = dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v);
  if (area2 > 0) {
    const Quad s = (dot(v, v) * dot(q, u) - dot(u, v) * dot(q, v)) / area2;
    const Quad t = (dot(u, u) * dot(q, v) - dot(u, v) * dot(q, u)) / area2;
    const QuadVec rest = minus(q, s, u, t, v);
    if (s >= 0 && t >= 0 && s + t <= 1) best = std::min(best, dot(rest, rest));
  }
  return static_cast<double>(std::sqrt(static_cast<long double>(best)));
}

/// The error of a wall's distance as a part of what `Wall::closest` allows.
double part_of_promise(const Wall& wall, const Vec3& q) {
  double exact = HUGE_VAL;
  for (const Wall::Triangle& t : wall.triangles()) {
    const auto& v = wall.vertices();
    const auto corner = [&](std::size_t c) { return v[static_cast<std::size_t>(t[c])]; };
    exact = std::min(exact, quad_distance({corner(0), corner(1), corner(2)}, q));
  }
  const Box& box = wall.bounds();
  const double coordinate =
      q.cwiseAbs().cwiseMax(box.lo.cwiseAbs()).cwiseMax(box.hi.cwiseAbs()).maxCoeff();
  return std::abs(wall.closest(q).distance_world - exact) /
         std::max(1e-12 * exact, 1e-15 * coordinate);
}

/// 1.2 long, the smallest angle of sine about `sine` at its first corner: isosceles, and with an
/// obtuse angle in the middle.
std::array<std::array<Vec3, 3>, 2> needles(double sine) {
  const Vec3 a(0.31, -0.17, 0.23);
  const Vec3 along = 1.2 * Vec3(0.48, 0.6, 0.64);
  const Vec3 across = 1.2 * sine * Vec3(0.8, 0, -0.6);
  return {{{a, a + along, a + along + across}, {a, a + along, a + 0.37 * along + across}}};
}

/// A point at a distance of any size from some place on or beside the triangle.
Vec3 beside(std::mt19937_64& random, const std::array<Vec3, 3>& v, double width) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double s = 1.2 * unit(random) - 0.1;
  const double t = 1.2 * unit(random) - 0.1;
  const double scale = unit(random) < 0.5 ? width : 1.2;
  const double away = scale * std::pow(10, 2 - 6 * unit(random));
  const Box cube{Vec3::Constant(-1), Vec3::Constant(1)};
  return v[0] + s * (v[1] - v[0]) + s * t * (v[2] - v[1]) + away * random_point(random, cube);
}

/// Ruled between two curves: cells `aspect` times as long as wide.
Surface ruled(double aspect) {
  const auto point = [&](double u, double v) {
    const double x = 6 * u / aspect;
    return Vec3(x, v + 0.1 * x * v, 0.3 * std::sin(2 * v) + 0.2 * x);
  };
  return build_surface({make_patch("ruled", 7, 2, point)});
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

TEST_CASE("wall: needles keep the promise near and far, from whichever corner they are given") {
  std::mt19937_64 random(29);
  std::array<int, 3> order{0, 1, 2};
  do {
    for (double sine = 1e-1; sine > 5e-9; sine /= 10) {
      for (const auto& corners : needles(sine)) {
        const Wall wall({corners[0], corners[1], corners[2]}, {order});
        CAPTURE(sine);
        double worst = 0;
        for (int n = 0; n < kQueries / 25; ++n) {
          worst = std::max(worst, part_of_promise(wall, beside(random, corners, 1.2 * sine)));
        }
        CHECK(worst <= 1);
      }
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("wall: a point above a needle is in front of it, one below behind") {
  for (double sine = 1e-1; sine > 5e-13; sine /= 10) {
    CAPTURE(sine);
    for (const auto& v : needles(sine)) {
      const Vec3 up = Vec3(0.48, 0.6, 0.64).cross(Vec3(0.8, 0, -0.6));
      const Vec3 middle = v[0] + 0.5 * (v[1] - v[0]) + 0.2 * (v[2] - v[1]);
      for (const std::array<int, 3>& order : {Wall::Triangle{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
        const Wall wall({v[0], v[1], v[2]}, {order});
        CHECK(wall.triangle_normal(0).dot(up) > 0.99);
        for (const double h : {1e-3, 1.0, 1e3}) {
          CHECK(wall.closest(middle + h * up).side(middle + h * up) == 1);
          CHECK(wall.closest(middle - h * up).side(middle - h * up) == -1);
        }
      }
    }
  }
}

TEST_CASE("wall: surfaces of cells 10,000 and 1,000,000 times as long as wide keep the promise") {
  for (const double aspect : {1e4, 1e6}) {
    CAPTURE(aspect);
    const Surface surface = ruled(aspect);
    std::mt19937_64 random(31);
    std::uniform_int_distribution<std::size_t> any(0, surface.wall->triangles().size() - 1);
    double worst = 0;
    for (int n = 0; n < kQueries / 5; ++n) {
      const Wall::Triangle& t = surface.wall->triangles()[any(random)];
      std::array<Vec3, 3> v;
      for (std::size_t c = 0; c < 3; ++c) {
        v[c] = surface.wall->vertices()[static_cast<std::size_t>(t[c])];
      }
      worst = std::max(worst, part_of_promise(*surface.wall, beside(random, v, 1 / aspect)));
    }
    CHECK(worst <= 1);
  }
}

TEST_CASE("wall: far from the origin the distance found does not depend on where a search starts") {
  std::mt19937_64 random(37);
  for (const double shift : {0.0, 1e4, 1e5, 1e6}) {
    CAPTURE(shift);
    Patches patches = make_example("sphere", {.points = 17});
    for (Patch& patch : patches) {
      for (Vec3& x : patch.points_world) x += shift * Vec3(1, -0.7, 0.4);
    }
    const Surface surface = build_surface(patches);
    const Wall& wall = *surface.wall;
    std::uniform_int_distribution<int> guess(0, static_cast<int>(wall.triangles().size()) - 1);
    const Vec3 centre = 0.5 * (wall.bounds().lo + wall.bounds().hi);
    int different = 0;
    for (int n = 0; n < kQueries / 2; ++n) {
      Vec3 q = random_point(random, inflated(wall, 0.3));
      if (n % 4 == 0) q = centre + 1e-3 * (q - centre);  // all triangles are about as near
      const double d = wall.closest(q).distance_world;
      different += wall.closest_from(guess(random), q).distance_world == d ? 0 : 1;
    }
    CHECK(different == 0);
  }
}

TEST_CASE("wall: a query that is not finite is near to nothing") {
  const Surface surface = build_surface(make_example("cube", {.points = 5}));
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 q(0.1, 0.2, 0.3);
      q[axis] = bad;
      for (const WallPoint& found : {surface.wall->closest(q), surface.wall->closest(q, 1),
                                     surface.wall->closest_from(3, q)}) {
        CHECK(found.triangle == -1);
        CHECK(found.distance_world == HUGE_VAL);
      }
      const Vec3List queries{q, {0, 0, 0}};
      const std::vector<double> batch = surface.wall->true_distance(queries);
      CHECK(batch[0] == HUGE_VAL);
      CHECK(batch[1] == surface.wall->closest({0, 0, 0}).distance_world);
    }
  }
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
