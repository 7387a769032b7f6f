#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <random>

#include "vdb_offset/blocks/quality.h"

// Prisms and pyramids as hexahedra with collapsed edges: positive where the Jacobians of their maps
// are, sampled here.

namespace vdb_offset::test {
namespace {

using Cell = std::array<Vec3, 8>;

/// The same solid with its indices turned: i -> j -> k -> i, which keeps the handedness.
Cell turned(const Cell& c) { return {c[0], c[3], c[7], c[4], c[1], c[2], c[6], c[5]}; }

/// The prism between two triangles, as the hexahedron whose base has corner `twice` doubled.
Cell prism(const std::array<Vec3, 3>& bottom, const std::array<Vec3, 3>& top, std::size_t twice) {
  Cell cell;
  for (std::size_t n = 0, t = 0; n < 4; ++n) {
    cell[n] = bottom[t];
    cell[n + 4] = top[t];
    if (n != twice) t = (t + 1) % 3;
  }
  return cell;
}

}  // namespace

TEST_CASE("quality: a prism is positive where its map is, whichever of its sides is doubled") {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> shift(-0.7, 0.7);
  const std::array<Vec3, 3> triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  std::array<int, 2> seen{};
  for (int n = 0; n < 300; ++n) {
    std::array<Vec3, 3> top = triangle;
    for (Vec3& p : top) p += Vec3(shift(random), shift(random), 0.5 + 0.7 * shift(random));
    double least = 1;  // of the Jacobian, on a lattice of the prism: columns decide, but try all
    for (int k = 0; k <= 64; ++k) {
      const double t = k / 64.0;
      const auto edge = [&](std::size_t c) -> Vec3 {
        return (1 - t) * (triangle[c] - triangle[0]) + t * (top[c] - top[0]);
      };
      const Vec3 area = edge(1).cross(edge(2));
      for (int i = 0; i <= 4; ++i) {
        for (int j = 0; i + j <= 4; ++j) {
          const std::array<double, 3> part{(4 - i - j) / 4.0, i / 4.0, j / 4.0};
          Vec3 up = Vec3::Zero();
          for (std::size_t c = 0; c < 3; ++c) up += part[c] * (top[c] - triangle[c]);
          least = std::min(least, area.dot(up));
        }
      }
    }
    if (std::abs(least) < 1.0 / 64 / 64) continue;  // less than a step of t can tell
    ++seen[least > 0 ? 1 : 0];
    for (std::size_t twice = 0; twice < 4; ++twice) {
      Cell cell = prism(triangle, top, twice);
      for (int turn = 0; turn < 3; ++turn, cell = turned(cell)) {
        CAPTURE(n);
        CAPTURE(twice);
        CAPTURE(turn);
        CHECK(cell_quality(cell).positive == (least > 0));
      }
    }
  }
  CHECK(seen[0] > 50);
  CHECK(seen[1] > 50);
}

TEST_CASE("quality: a pyramid is positive where its map is, on either end") {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> shift(-0.6, 0.6);
  std::array<int, 2> seen{};
  for (int n = 0; n < 300; ++n) {
    std::array<Vec3, 4> base{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    for (Vec3& p : base) p += Vec3(shift(random), shift(random), shift(random));
    const Vec3 apex(0.5 + shift(random), 0.5 + shift(random), 0.8);
    double least = 1;
    for (int i = 0; i <= 16; ++i) {
      for (int j = 0; j <= 16; ++j) {
        const double r = i / 16.0;
        const double s = j / 16.0;
        const Vec3 along_r = (1 - s) * (base[1] - base[0]) + s * (base[2] - base[3]);
        const Vec3 along_s = (1 - r) * (base[3] - base[0]) + r * (base[2] - base[1]);
        const Vec3 at =
            (1 - r) * ((1 - s) * base[0] + s * base[3]) + r * ((1 - s) * base[1] + s * base[2]);
        least = std::min(least, along_r.cross(along_s).dot(apex - at));
      }
    }
    ++seen[least > 0 ? 1 : 0];
    Cell cell;
    for (std::size_t c = 0; c < 4; ++c) {
      cell[c] = base[c];
      cell[c + 4] = apex;
    }
    for (int turn = 0; turn < 3; ++turn, cell = turned(cell)) {
      CAPTURE(n);
      CAPTURE(turn);
      CHECK(cell_quality(cell).positive == (least > 0));
    }
  }
  CHECK(seen[0] > 50);
  CHECK(seen[1] > 50);
}

TEST_CASE("cell quality: a corner that is flat to rounding is not positive") {
  // The top's corner at (1, 1) moved onto the diagonal of the others, but for `off`: the angle
  // there is flat to about that.
  const auto cell = [](double off) {
    const double c = 0.5 + off;
    return cell_quality({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0, 0, 1),
                         Vec3(1, 0, 1), Vec3(c, c, 1), Vec3(0, 1, 1)});
  };
  const CellQuality flat = cell(1e-3 * kFlat);
  CHECK(flat.min_jacobian > 0);
  CHECK(flat.scaled_jacobian < kFlat);
  CHECK_FALSE(flat.positive);
  CHECK(cell(1e3 * kFlat).positive);
  CHECK_FALSE(cell(-1e3 * kFlat).positive);
}

}  // namespace vdb_offset::test
