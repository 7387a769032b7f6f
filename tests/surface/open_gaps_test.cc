#include "vdb_offset/surface/open_gaps.h"

#include <doctest/doctest.h>

#include "support/shapes.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {
namespace {

constexpr int kCells = 4;
constexpr double kEdge = 1.0 / kCells;

/// Two square plates side by side, bent so that no boundary is found between; apart by a part of
/// their edges, and by more and more of it towards the end of the seam.
Patches plates(double part, double more = 0) {
  return {test::make_patch("left", kCells + 1, kCells + 1,
                           [](double u, double v) -> Vec3 {
                             return {u, v, 0.2 * u * u};
                           }),
          test::make_patch("right", kCells + 1, kCells + 1, [=](double u, double v) -> Vec3 {
            return {1 + (part + more * v) * kEdge + u, v, 0.2 + 0.4 * u};
          })};
}

TEST_CASE("open_gaps: an open seam is found with the tolerance that closes it") {
  const double part = 0.1;
  const Surface open = build_surface(plates(part));
  const OpenGaps gaps = open_gaps(open);
  CHECK(gaps.edges == 2 * kCells);
  CHECK(gaps.weld_first == gaps.weld_all);
  CHECK(gaps.weld_all > part);
  CHECK(gaps.weld_all <= 1.1 * part);  // of two digits
  SurfaceOptions options;
  options.weld = gaps.weld_all;
  const Surface closed = build_surface(plates(part), options);
  CHECK(open_gaps(closed).edges == 0);
  CHECK(closed.free_edges() == open.free_edges() - gaps.edges);
  options.weld = 0.99 * part;
  CHECK(open_gaps(build_surface(plates(part), options)).edges == gaps.edges);
}

TEST_CASE("open_gaps: of a seam that widens the first edge and all have tolerances of their own") {
  const OpenGaps gaps = open_gaps(build_surface(plates(0.1, 0.3)));
  CHECK(gaps.edges == 2 * kCells);
  // An edge is joined with its farther end.
  CHECK(gaps.weld_first == doctest::Approx(0.1 + 0.3 / kCells).epsilon(0.06));
  CHECK(gaps.weld_all == doctest::Approx(0.4).epsilon(0.06));
  SurfaceOptions options;
  options.weld = gaps.weld_first;
  CHECK(open_gaps(build_surface(plates(0.1, 0.3), options)).edges == 2 * (kCells - 1));
}

TEST_CASE("open_gaps: what a tolerance has left apart is no gap that it would close") {
  const double part = 0.1;
  const Surface open = build_surface(plates(part));
  CHECK(open_gaps(open, 0.9 * part).edges == 2 * kCells);
  CHECK(open_gaps(open, 1.1 * part).edges == 0);
}

TEST_CASE("open_gaps: there is none where no tolerance joins, or between bodies") {
  CHECK(open_gaps(build_surface(plates(0.6))).edges == 0);
  Patches bodies = plates(0.1);
  bodies[1].body = 1;
  CHECK(open_gaps(build_surface(bodies)).edges == 0);
  CHECK(open_gaps(build_surface({plates(0.1)[0]})).edges == 0);
}

TEST_CASE("open_gaps: the open end of what is thin is none") {
  const auto side = [](const char* name, double slope) {
    return test::make_patch(name, kCells + 1, kCells + 1, [=](double u, double v) -> Vec3 {
      return {slope > 0 ? u : 1 - u, v, slope * (slope > 0 ? u : 1 - u)};
    });
  };
  const Surface wedge = build_surface({side("top", 0.1), side("bottom", -0.1)});
  CHECK(wedge.free_edges() == 2 * 3 * kCells);
  CHECK(open_gaps(wedge).edges == 0);
}

}  // namespace
}  // namespace vdb_offset
