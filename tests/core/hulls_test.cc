#include "core/hulls.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/box_tree.h"

using namespace vdb_offset;

namespace {

Vec3List cube(const Vec3& centre, const Eigen::Matrix3d& turn) {
  Vec3List points;
  for (unsigned c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1U ? 0.5 : -0.5, c & 2U ? 0.5 : -0.5, c & 4U ? 0.5 : -0.5);
    points.push_back(centre + turn * corner);
  }
  return points;
}

}  // namespace

TEST_CASE("hulls: cubes are as far apart as their boxes, and moved and turned alike") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  int apart = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 off = 2 * Vec3(any(random), any(random), any(random));
    const double distance = (off.cwiseAbs() - Vec3::Ones()).cwiseMax(0.0).norm();
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(3 * any(random), Vec3(any(random), any(random), 1).normalized())
            .toRotationMatrix();
    const Vec3 there(any(random), any(random), any(random));
    const Vec3List first = cube(there, turn);
    const Vec3List second = cube(there + turn * off, turn);
    const HullGap gap = hull_gap(first, second);
    CHECK(gap.distance_world == doctest::Approx(distance).epsilon(1e-8).scale(1e-4));
    CHECK((gap.first - gap.second).norm() == doctest::Approx(gap.distance_world).epsilon(1e-8));
    if (std::abs(distance) > 1e-9 || (off.cwiseAbs().array() < 1 - 1e-9).all()) {
      CHECK(are_apart(first, second) == (distance > 0));
    }
    apart += distance > 0 ? 1 : 0;
  }
  CHECK(apart > 500);
  CHECK(apart < 1900);
}

TEST_CASE("hulls: flat ones and points have distances too") {
  const Vec3List square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const Vec3& point : {Vec3(0.5, 0.5, 1e-3), Vec3(2, 0.5, 0), Vec3(-3, -4, 0)}) {
    const Vec3 off = (Vec3(0, 0, 0) - point).cwiseMax(point - Vec3(1, 1, 0)).cwiseMax(0.0);
    CHECK(hull_gap({&point, 1}, square).distance_world == doctest::Approx(off.norm()));
    CHECK(are_apart({&point, 1}, square));
  }
  const Vec3 within(0.3, 0.4, 0);
  CHECK(!are_apart({&within, 1}, square));
  CHECK(!are_apart(square, square));
}

TEST_CASE("box tree: finds what looking at all boxes does") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  for (const std::size_t count : {0U, 1U, 4U, 5U, 17U, 33U, 1000U}) {
    CAPTURE(count);
    LargeVector<Box> boxes;
    for (std::size_t n = 0; n < count; ++n) {
      const Vec3 lo(any(random), any(random), any(random));
      boxes.push_back({lo, lo + 0.1 * Vec3(any(random), any(random), any(random))});
    }
    LargeVector<int> order;
    const BoxTree tree(boxes, order);
    REQUIRE(order.size() == count);
    for (int n = 0; n < 50; ++n) {
      const Vec3 lo(any(random), any(random), any(random));
      const Box box{lo, lo + Vec3::Constant(0.1)};
      std::vector<char> found(count, 0);
      std::size_t leaves = 0;
      tree.near_box(box, 0, [&](std::uint32_t first, std::uint32_t last, const Box& around) {
        for (std::uint32_t p = first; p < last; ++p) {
          const auto b = static_cast<std::size_t>(order[p]);
          ++found[b];
          CHECK((around.lo.array() <= boxes[b].lo.array()).all());
          CHECK((around.hi.array() >= boxes[b].hi.array()).all());
        }
        ++leaves;
        return false;
      });
      for (std::size_t b = 0; b < count; ++b) {
        const bool meets = (boxes[b].lo.array() <= box.hi.array()).all() &&
                           (box.lo.array() <= boxes[b].hi.array()).all();
        CHECK(found[b] <= 1);
        CHECK((found[b] == 1 || !meets));
      }
      CHECK(leaves <= std::max<std::size_t>(1, count / 10));  // and does not look at all
    }
  }
}
