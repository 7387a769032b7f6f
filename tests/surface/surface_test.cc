#include "vdb_offset/surface/surface.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kPi = std::numbers::pi;

void reverse_i(Patch& patch) {
  for (int j = 0; j < patch.nj; ++j) {
    const auto row = patch.points_world.begin() + static_cast<std::ptrdiff_t>(j) * patch.ni;
    std::reverse(row, row + patch.ni);
  }
}

int count(const Surface& surface, EdgeKind kind) {
  return static_cast<int>(std::count_if(surface.topology.edges.begin(),
                                        surface.topology.edges.end(),
                                        [&](const Edge& e) { return e.kind == kind; }));
}

/// Node at position s of a side.
int side_node(const Surface& surface, const SideRange& range, int s) {
  const Patch& patch = surface.patches[static_cast<std::size_t>(range.patch)];
  switch (range.side) {
    case Side::IMin:
      return surface.node(range.patch, 0, s);
    case Side::IMax:
      return surface.node(range.patch, patch.ni - 1, s);
    case Side::JMin:
      return surface.node(range.patch, s, 0);
    case Side::JMax:
      break;
  }
  return surface.node(range.patch, s, patch.nj - 1);
}

/// Every grid edge of every side lies in one edge; interfaces match node for node.
void check_topology(const Surface& surface) {
  std::map<std::array<int, 3>, int> covered;
  const auto cover = [&](const SideRange& r) {
    for (int s = std::min(r.begin, r.end); s < std::max(r.begin, r.end); ++s) {
      ++covered[{r.patch, static_cast<int>(r.side), s}];
    }
  };
  for (const Edge& edge : surface.topology.edges) {
    CHECK(edge.first.begin < edge.first.end);
    cover(edge.first);
    if (edge.kind != EdgeKind::Interface) continue;
    cover(edge.second);
    REQUIRE(edge.first.cells() == edge.second.cells());
    const int step = edge.second.begin < edge.second.end ? 1 : -1;
    for (int n = 0; n <= edge.first.cells(); ++n) {
      CHECK(side_node(surface, edge.first, edge.first.begin + n) ==
            side_node(surface, edge.second, edge.second.begin + step * n));
    }
  }
  std::size_t sides = 0;
  for (const Patch& patch : surface.patches) {
    sides += static_cast<std::size_t>(2 * (patch.ni - 1) + 2 * (patch.nj - 1));
  }
  CHECK(covered.size() == sides);
  for (const auto& [where, times] : covered) CHECK(times == 1);
}

std::string message_of(const Patches& patches, const SurfaceOptions& options = {}) {
  try {
    build_surface(patches, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("surface: a cube-topology sphere welds to 6 (n - 1)^2 + 2 nodes and 12 edges") {
  for (const int n : {3, 5, 17}) {
    ExampleOptions options;
    options.points = n;
    const Surface surface = build_surface(make_example("sphere", options));
    CHECK(surface.points() == 6 * n * n);
    CHECK(surface.nodes_world.size() == static_cast<std::size_t>(6 * (n - 1) * (n - 1) + 2));
    CHECK(surface.faces() == 6 * (n - 1) * (n - 1));
    CHECK(surface.closed);
    CHECK(surface.topology.vertices.size() == 8);
    CHECK(count(surface, EdgeKind::Interface) == 12);
    CHECK(surface.topology.components == 1);
    check_topology(surface);
  }
}

TEST_CASE("surface: points off by a hundredth of the spacing weld, by a tenth they do not") {
  ExampleOptions options;
  options.points = 9;
  const Patches exact = make_example("cube", options);
  const double spacing = 1.0 / 8;
  std::mt19937_64 random(2);
  for (const double part : {0.004, 0.1}) {
    Patches moved = exact;
    for (std::size_t p = 0; p < moved.size(); ++p) {
      const Box box{Vec3::Constant(-0.5), Vec3::Constant(0.5)};
      const Vec3 shift = part * spacing * random_point(random, box).normalized();
      for (Vec3& x : moved[p].points_world) x += shift;
    }
    const Surface surface = build_surface(moved);
    CHECK(surface.closed == (part < 0.01));
    CHECK((surface.report.weld_distance_max_world > 0) == (part < 0.01));
  }
}

TEST_CASE("surface: welding follows the local spacing, from 1e-9 to 1 on one patch") {
  const auto graded = [](double u, double v) {
    return Vec3(u <= 0 ? 0 : std::pow(10, -9 * (1 - u)), v, 0);
  };
  const Patch left = make_patch("left", 19, 5, graded);
  const Patch right = make_patch("right", 19, 5, [&](double u, double v) {
    return Vec3(Vec3(2, 0, 0) + Vec3(-1, 1, 1).cwiseProduct(graded(1 - u, v)));
  });
  const Surface surface = build_surface({left, right});
  CHECK(surface.nodes_world.size() == static_cast<std::size_t>(2 * 19 * 5 - 5));
  CHECK(count(surface, EdgeKind::Interface) == 1);
}

TEST_CASE("surface: turned patches are turned back, and reported") {
  ExampleOptions options;
  options.points = 5;
  Patches patches = make_example("cube", options);
  reverse_i(patches[1]);
  reverse_i(patches[4]);
  const Surface surface = build_surface(patches);
  CHECK(surface.report.flipped == std::vector<int>{1, 4});
  const Vec3 centre = 0.5 * (surface.wall->bounds().lo + surface.wall->bounds().hi);
  CHECK(surface.wall->closest(centre).side(centre) == -1);
  check_topology(surface);
}

TEST_CASE("surface: a side meets parts of two sides") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  const Surface surface =
      build_surface({rectangle("wide", {9, 3}, Vec3::Zero(), {2 * x, y}),
                     rectangle("upper left", {4, 3}, y, {0.75 * x, y}),
                     rectangle("upper right", {6, 3}, y + 0.75 * x, {1.25 * x, y})});
  CHECK(count(surface, EdgeKind::Interface) == 3);
  CHECK(surface.free_edges() == 8 + 2 * 2 + 3 + 2 + 5 + 2);
  check_topology(surface);
}

TEST_CASE("surface: a patch that closes on itself, and one with two poles") {
  const Patch globe = make_patch("globe", 17, 9, [](double u, double v) {
    const double a = 2 * kPi * (u >= 1 ? 0 : u);
    const double r = v <= 0 || v >= 1 ? 0 : std::sin(kPi * v);
    return Vec3(r * std::cos(a), r * std::sin(a), v <= 0 ? -1 : v >= 1 ? 1 : -std::cos(kPi * v));
  });
  const Surface surface = build_surface({globe});
  CHECK(surface.closed);
  CHECK(surface.nodes_world.size() == 16 * 7 + 2);
  CHECK(surface.faces() == 16 * 8);
  CHECK(count(surface, EdgeKind::Degenerate) == 2);
  CHECK(count(surface, EdgeKind::Interface) == 1);
  CHECK(surface.wall->closest({0, 0, 0}).side({0, 0, 0}) == -1);
  check_topology(surface);
}

TEST_CASE("surface: a C-type patch meets itself along its wake") {
  // Round a flat plate: i runs along the wake, round the body, back along the wake.
  const Patch c_grid = make_patch("c", 21, 3, [](double u, double v) {
    const double t = std::abs(2 * u - 1);  // 1 at both wake ends
    if (v <= 0) return Vec3(t, 0, 0);
    const double a = kPi * (2 * u - 1);
    return Vec3(t - v * std::cos(0.5 * a) + 0.5 * v, v * std::sin(0.5 * a), 0);
  });
  const Surface surface = build_surface({c_grid});
  CHECK(count(surface, EdgeKind::Interface) == 1);
  CHECK(surface.nodes_world.size() == 21 * 3 - 10);
  check_topology(surface);
}

TEST_CASE("surface: three cells on an edge are refused, with patches and place") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  const std::string text =
      message_of({rectangle("a", {3, 3}, Vec3::Zero(), {x, y}), rectangle("b", {3, 3}, -y, {x, y}),
                  rectangle("fin", {3, 3}, Vec3::Zero(), {x, Vec3::UnitZ()})});
  CAPTURE(text);
  CHECK(says(text, "not a manifold"));
  CHECK(says(text, "'a'"));
  CHECK(says(text, "'b'"));
  CHECK(says(text, "'fin'"));
}

TEST_CASE("surface: a doubled patch and a single shared node are refused") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  const Patch a = rectangle("a", {4, 4}, Vec3::Zero(), {x, y});
  CHECK(says(message_of({a, a}), "not a manifold"));
  CHECK(says(message_of({a, rectangle("b", {3, 3}, x + y, {x, y})}), "single node"));
  const Vec3 z = Vec3::UnitZ();
  const auto leaf = [&](const Vec3& away) {
    return rectangle("l", {4, 4}, Vec3::Zero(), {x, away});
  };
  CHECK(says(message_of({leaf(y), leaf(z), leaf(-y), leaf(-z)}), "two bodies that touch"));
  CHECK(!says(message_of({leaf(y), leaf(z), leaf(-y)}), "two bodies"));
}

TEST_CASE("surface: points of two bodies that coincide are two nodes") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  Patches patches{rectangle("a", {3, 3}, Vec3::Zero(), {x, y}),
                  rectangle("b", {3, 3}, x + y, {x, y})};
  CHECK_THROWS_AS(build_surface(patches), InputError);
  patches[1].body = 1;
  CHECK(build_surface(patches).nodes_world.size() == 18);
}

TEST_CASE("surface: cells that cross themselves are named before layers are made on them") {
  Patches patches{rectangle("a", {4, 4}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})};
  CHECK_NOTHROW(refuse_crossed_cells(build_surface(patches)));
  std::swap(patches[0].at(1, 1), patches[0].at(2, 1));
  CHECK_THROWS_WITH_AS(refuse_crossed_cells(build_surface(patches)),
                       doctest::Contains("2 quads of the surface cross themselves"), InputError);
}

TEST_CASE("surface: sides whose points do not match are told from a touch in one node") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  Patch a = rectangle("a", {4, 4}, Vec3::Zero(), {x, y});
  a.file = "wing.xyz";
  const std::string whole = message_of({a, rectangle("b", {4, 6}, x, {x, y})});
  CAPTURE(whole);
  CHECK(says(whole, "do not match"));
  CHECK(says(whole, "side imax of patch 1 'a' of wing.xyz (4 points)"));
  CHECK(says(whole, "side imin of patch 2 'b' (6 points)"));
  // The other patch's side begins in a node of this one's and ends beyond its last.
  const std::string part = message_of({a, rectangle("b", {5, 3}, x + y / 3, {x, y})});
  CHECK(says(part, "do not match"));
  // A fold of 90 degrees between the sides' directions is no side that was meant to match.
  CHECK(says(message_of({a, rectangle("b", {3, 3}, x + y, {x, Vec3::UnitZ()})}), "single node"));
}

TEST_CASE("surface: a Moebius strip is refused, in one patch and in three") {
  const auto strip = [](double u, double v) {
    const double a = 2 * kPi * u;
    const double w = 0.6 * (v - 0.5);
    const double half = 0.5 * a;
    return Vec3((1 + w * std::cos(half)) * std::cos(a), (1 + w * std::cos(half)) * std::sin(a),
                w * std::sin(half));
  };
  CHECK(says(message_of({make_patch("strip", 25, 5, strip)}), "cannot be oriented"));
  Patches thirds;
  for (int n = 0; n < 3; ++n) {
    thirds.push_back(make_patch("third " + std::to_string(n), 9, 5,
                                [&](double u, double v) { return strip((n + u) / 3, v); }));
  }
  const std::string text = message_of(thirds);
  CHECK(says(text, "cannot be oriented"));
  CHECK(says(text, "third"));
}

TEST_CASE("surface: nonsense is refused by name") {
  Patch patch = rectangle("good", {3, 3}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()});
  CHECK(says(message_of({}), "no patches"));
  Patch thin = patch;
  thin.ni = 1;
  thin.nj = 9;
  thin.name = "thin";
  CHECK(says(message_of({thin}), "'thin' has 1 x 9"));
  thin.ni = 9;
  thin.nj = 1;
  CHECK(says(message_of({patch, thin}), "'thin' is a curve and patch 1 'good' a surface"));
  Patch bad = patch;
  bad.at(1, 2).y() = std::nan("");
  CHECK(says(message_of({bad}), "point (2, 3)"));
  Patch point = patch;
  for (Vec3& x : point.points_world) x.setZero();
  CHECK(message_of({point}) != "no error");
  Patch line = patch;
  for (Vec3& x : line.points_world) x.y() = x.z() = 0;
  CHECK(message_of({line}) != "no error");
  SurfaceOptions options;
  options.weld = std::nan("");
  CHECK(says(message_of({patch}, options), "weld"));
}

TEST_CASE("surface: both sides give two sets of nodes on one wall") {
  const Patch sheet = rectangle("sheet", {4, 3}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()});
  SurfaceOptions options;
  options.side = MarchSide::Both;
  const Surface surface = build_surface({sheet}, options);
  CHECK(surface.patches.size() == 2);
  CHECK(surface.nodes_world.size() == 24);
  CHECK(surface.wall_nodes == 12);
  CHECK(surface.wall->triangles().size() == 4 * 6);
  CHECK(surface.patches[1].at(0, 0) == surface.patches[0].at(3, 0));
  check_topology(surface);
}

TEST_CASE("surface: real wings weld to the counts that their makers' tools give") {
  const auto data = shared_data();
  if (!data) {
    MESSAGE("skipped: the real geometry is not here");
    return;
  }
  const Surface bwb = build_surface(read_plot3d(*data + "/plot3d/bwb.fmt"));
  CHECK(bwb.patches.size() == 9);
  CHECK(bwb.points() == 14105);
  CHECK(bwb.nodes_world.size() == 13457);
  CHECK(bwb.faces() == 13376);
  CHECK(bwb.free_edges() == 160);
  check_topology(bwb);
  const Surface m6 = build_surface(read_plot3d(*data + "/plot3d/m6_small.fmt"));
  CHECK(m6.faces() == 15232);
  CHECK(m6.free_edges() == 176);
  check_topology(m6);
  const Surface sphere = build_surface(read_plot3d(*data + "/plot3d/even_sphere.fmt"));
  CHECK(sphere.closed);
  CHECK(sphere.nodes_world.size() == 98);
  check_topology(sphere);
}
