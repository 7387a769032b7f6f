#include "core/most_normal.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace vdb_offset;

TEST_CASE("most normal: a narrow cone of three normals is left along its axis") {
  for (const double cosine : {0.9, 0.1, 0.01, 1e-4}) {
    CAPTURE(cosine);
    Vec3List normals;
    for (int n = 0; n < 3; ++n) {
      const double turn = 2 * std::numbers::pi * n / 3;
      const double sine = std::sqrt(1 - cosine * cosine);
      normals.emplace_back(sine * std::cos(turn), sine * std::sin(turn), cosine);
    }
    const Visible out = most_normal(normals, normals.front());
    CHECK(out.least_cosine == doctest::Approx(cosine).epsilon(0.05));
    CHECK(out.least_cosine == least_cosine(out.direction, normals));
  }
}

TEST_CASE("most normal: nothing sees four normals that hold the origin between them") {
  const double a = 1 / std::sqrt(3.0);
  const Vec3List normals{{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
  CHECK(most_normal(normals, normals.front()).least_cosine <= 0);
}
