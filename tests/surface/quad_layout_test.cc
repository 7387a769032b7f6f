#include "vdb_offset/surface/quad_layout.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include "support/quad_files.h"
#include "support/quad_shapes.h"
#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kPi = std::numbers::pi;

using Place = std::array<double, 3>;
using Quad = std::array<Place, 4>;

Place place(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

/// The same for every corner that a quad may begin with, but not for the other sense.
Quad from_lowest(Quad quad) {
  std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
  return quad;
}

std::multiset<Quad> quads_of(const PolygonMesh& mesh) {
  std::multiset<Quad> quads;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    Quad quad;
    for (std::size_t c = 0; c < 4; ++c) {
      quad[c] = place(mesh.points_world[static_cast<std::size_t>(mesh.face(f)[c])]);
    }
    quads.insert(from_lowest(quad));
  }
  return quads;
}

std::multiset<Quad> quads_of(const Patches& patches) {
  std::multiset<Quad> quads;
  for (const Patch& patch : patches) {
    for (int j = 0; j + 1 < patch.nj; ++j) {
      for (int i = 0; i + 1 < patch.ni; ++i) {
        quads.insert(from_lowest({place(patch.at(i, j)), place(patch.at(i + 1, j)),
                                  place(patch.at(i + 1, j + 1)), place(patch.at(i, j + 1))}));
      }
    }
  }
  return quads;
}

/// Every quad once, bit for bit and in its sense; and the surface stage sees the same surface.
QuadLayout checked(const PolygonMesh& mesh, const QuadLayoutOptions& options = {}) {
  QuadLayout layout = quad_layout(mesh, options);
  CHECK(quads_of(layout.patches) == quads_of(mesh));
  std::set<std::string> names;
  for (const Patch& patch : layout.patches) names.insert(patch.name);
  CHECK(names.size() == layout.patches.size());
  std::map<std::array<int, 2>, int> uses;
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const int a = mesh.corners[c];
    const int b = mesh.corners[c / 4 * 4 + (c + 1) % 4];
    ++uses[{std::min(a, b), std::max(a, b)}];
  }
  const auto free = std::ranges::count_if(uses, [](const auto& use) { return use.second == 1; });
  const Surface surface = build_surface(layout.patches);
  CHECK(surface.faces() == static_cast<int>(mesh.faces()));
  CHECK(surface.free_edges() == free);
  CHECK(surface.report.flipped.empty());
  return layout;
}

std::size_t patches_of(const PolygonMesh& mesh, double feature_turn = kPi) {
  return checked(mesh, {.feature_turn = feature_turn}).patches.size();
}

/// Quads along the sides of each patch, the larger first.
std::multiset<std::array<int, 2>> sizes_of(const Patches& patches) {
  std::multiset<std::array<int, 2>> sizes;
  for (const Patch& patch : patches) {
    sizes.insert({std::max(patch.ni, patch.nj) - 1, std::min(patch.ni, patch.nj) - 1});
  }
  return sizes;
}

std::string message_of(const PolygonMesh& mesh) {
  try {
    quad_layout(mesh);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

PolygonMesh faces(int points, const std::vector<std::vector<int>>& list) {
  PolygonMesh mesh;
  for (int p = 0; p < points; ++p) mesh.points_world.emplace_back(p, p * p, p * p * p);
  for (const std::vector<int>& face : list) mesh.add(face);
  mesh.file = "part.obj";
  return mesh;
}

PolygonMesh cell_picture(const std::vector<std::string>& rows) {
  return cells(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), [&](int i, int j) {
    return rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] == '#';
  });
}

}  // namespace

TEST_CASE("quad layout: a regular sheet is one patch, down to a single quad") {
  for (const std::array<int, 2> size : {std::array{7, 4}, {1, 5}, {1, 1}}) {
    const QuadLayout layout = checked(sheet(size[0], size[1]));
    REQUIRE(layout.patches.size() == 1);
    CHECK(sizes_of(layout.patches).count({std::max(size[0], size[1]), std::min(size[0], size[1])}));
    CHECK(layout.report.boundary_corners == 4);
    CHECK(layout.report.irregular_vertices == 0);
    CHECK(layout.patches[0].name == "block 1");
  }
}

TEST_CASE("quad layout: flat outlines fall into the fewest rectangles there are") {
  // By Lipski and others: inner corners, less chords that join two of them, less holes, plus one.
  CHECK(patches_of(cell_picture({"###", "###", "#..", "#.."})) == 2);
  CHECK(patches_of(cell_picture({"#..#", "#..#", "####"})) == 3);
  CHECK(patches_of(cell_picture({".#.", "###", ".#."})) == 3);
  CHECK(patches_of(cell_picture({"###", "#.#", "###"})) == 4);
  CHECK(patches_of(cell_picture({"#...", "##..", "###.", "####"})) == 4);
  CHECK(patches_of(
            cell_picture({"#######", "#.....#", "#.###.#", "#.#.#.#", "#.#...#", "#.#####"})) == 7);
}

TEST_CASE("quad layout: a cube is its faces, and less where its edges are no features") {
  for (const int n : {2, 3, 8}) {
    const QuadLayout layout = checked(cube(n));
    CHECK(layout.patches.size() == 6);
    CHECK(layout.report.irregular_vertices == 8);
    CHECK(layout.report.feature_edges == 12 * n);
    CHECK(patches_of(cube(n)) <= 3);
  }
  // Coarse enough, a cube is as good as a sphere.
  CHECK(patches_of(cube(1), kPi / 6) <= 3);
}

TEST_CASE("quad layout: a sphere made of a cube is three patches at most") {
  const PolygonMesh sphere = bent(cube(6), [](const Vec3& x) { return Vec3(x.normalized()); });
  const QuadLayout layout = checked(sphere);
  CHECK(layout.report.irregular_vertices == 8);
  CHECK(layout.report.traced_patches == 6);
  CHECK(layout.patches.size() <= 3);
  CHECK(checked(sphere, {.merge = false}).patches.size() == 6);
}

TEST_CASE("quad layout: a tube is one patch whose first and last column are the same points") {
  for (const int around : {3, 12}) {
    const QuadLayout layout = checked(tube(around, 5));
    REQUIRE(layout.patches.size() == 1);
    CHECK(layout.report.seams == 1);
    CHECK(sizes_of(layout.patches).count({std::max(around, 5), std::min(around, 5)}) == 1);
  }
}

TEST_CASE("quad layout: a torus is one patch that meets itself both ways, twisted or not") {
  for (const int twist : {0, 1, 5}) {
    CAPTURE(twist);
    const QuadLayout layout = checked(torus({.ni = 12, .nj = 20, .both = true, .twist = twist}));
    CHECK(layout.patches.size() == 1);
    CHECK(layout.report.seams == 2);
    CHECK(layout.report.irregular_vertices == 0);
  }
}

TEST_CASE("quad layout: lines that would spiral over the whole surface stop at each other") {
  // A hole in a twisted torus: each line from its corners passes every quad before it closes.
  const PolygonMesh mesh =
      torus({.ni = 24, .nj = 30, .both = true, .twist = 1, .has = [](int i, int j) {
               return i != 4 || j != 7;
             }});
  const QuadLayout layout = checked(mesh);
  CHECK(layout.report.boundary_corners == 4);
  // Each of four inner corners needs one line, and Euler's number is -1.
  CHECK(layout.patches.size() <= 4 - 1);
}

TEST_CASE("quad layout: points of two, three and many quads are corners or on sides of patches") {
  PolygonMesh mesh = sheet(5, 5);
  // The middle quad is parted in two by a line through a new point, which has two quads.
  const std::array<int, 4> middle{mesh.face(12)[0], mesh.face(12)[1], mesh.face(12)[2],
                                  mesh.face(12)[3]};
  const auto centre = static_cast<int>(mesh.points_world.size());
  mesh.points_world.emplace_back(2.5, 2.5, 0);
  mesh.corners[12 * 4 + 2] = centre;
  mesh.add(std::array<int, 4>{middle[1], middle[2], middle[3], centre});
  const QuadLayout layout = checked(mesh);
  CHECK(layout.report.irregular_vertices == 3);
  for (const int n : {3, 5, 7, 12, 100}) {
    const QuadLayout poles = checked(star(n));
    CHECK(poles.report.irregular_vertices == 1);
    CHECK(poles.report.traced_patches == n);
    // Two neighbours make a patch; no two that are left over are neighbours.
    CHECK(static_cast<int>(poles.patches.size()) <= (2 * n + 2) / 3);
    CHECK(static_cast<int>(poles.patches.size()) >= (n + 1) / 2);
  }
}

TEST_CASE("quad layout: the numbering of a mesh changes nothing") {
  const PolygonMesh hole =
      torus({.ni = 12, .nj = 18, .both = true, .twist = 5, .has = [](int i, int j) {
               return i + j > 0;
             }});
  for (const PolygonMesh& mesh :
       {cube(4), hole, star(9), cell_picture({"###.", "#.##", "####", ".##."})}) {
    for (const double turn : {kPi / 6, kPi}) {
      const auto sizes = sizes_of(checked(mesh, {.feature_turn = turn}).patches);
      for (const unsigned seed : {1U, 2U, 3U}) {
        const PolygonMesh other = renumbered(mesh, seed);
        CHECK(sizes_of(checked(other, {.feature_turn = turn}).patches) == sizes);
      }
    }
  }
}

TEST_CASE("quad layout: random outlines keep one line an inner corner") {
  std::mt19937 random(7);
  for (int round = 0; round < 40; ++round) {
    std::array<std::array<bool, 12>, 12> has{};
    for (auto& row : has) {
      for (bool& cell : row) cell = random() % 8 != 0;
    }
    const auto filled = [&](int i, int j) {
      return i >= 0 && j >= 0 && i < 12 && j < 12 &&
             has[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
    };
    // Cells that touch in one point only are not a surface: fill those places.
    for (int again = 0; again < 144; ++again) {
      for (int j = 0; j < 11; ++j) {
        for (int i = 0; i < 11; ++i) {
          if (filled(i, j) == filled(i + 1, j + 1) && filled(i + 1, j) == filled(i, j + 1) &&
              filled(i, j) != filled(i + 1, j)) {
            has[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = true;
            has[static_cast<std::size_t>(j)][static_cast<std::size_t>(i) + 1] = true;
          }
        }
      }
    }
    const PolygonMesh mesh = cells(12, 12, filled);
    int inner = 0;
    int outer = 0;
    for (int j = -1; j < 12; ++j) {
      for (int i = -1; i < 12; ++i) {
        const int around =
            filled(i, j) + filled(i + 1, j) + filled(i, j + 1) + filled(i + 1, j + 1);
        inner += around == 3 ? 1 : 0;
        outer += around == 1 ? 1 : 0;
      }
    }
    // Components less holes are (outer - inner) / 4; each line adds one patch to that.
    CAPTURE(round);
    CHECK(static_cast<int>(patches_of(mesh)) <= inner + (outer - inner) / 4);
  }
}

TEST_CASE("quad layout: random bodies of cubes fall into rectangles, however they are numbered") {
  std::mt19937 random(11);
  int bodies = 0;
  for (int round = 0; round < 400 && bodies < 25; ++round) {
    const PolygonMesh mesh = random_body(random);
    if (!message_of(mesh).empty()) continue;  // its cubes touch along an edge or in a corner alone
    CAPTURE(round);
    ++bodies;
    for (const double turn : {kPi / 6, kPi}) {
      const QuadLayout layout = checked(mesh, {.feature_turn = turn});
      CHECK(static_cast<int>(layout.patches.size()) <= layout.report.traced_patches);
      const QuadLayout other =
          checked(renumbered(mesh, static_cast<unsigned>(bodies)), {.feature_turn = turn});
      CHECK(sizes_of(other.patches) == sizes_of(layout.patches));
    }
  }
  CHECK(bodies == 25);
}

TEST_CASE("quad layout: no patch lies in two families, and each is named by its own") {
  PolygonMesh mesh = sheet(6, 6);
  mesh.families = {"floor", "", "pad"};
  for (int f = 0; f < 36; ++f) {
    const int i = f % 6;
    const int j = f / 6;
    mesh.family.push_back(i < 2 ? 1 : i > 2 && i < 5 && j > 1 && j < 4 ? 2 : 0);
  }
  mesh.file = "floor.obj";
  const QuadLayout layout = checked(mesh);
  CHECK(layout.report.family_edges == 6 + 8);
  std::map<std::string, int> area;
  for (const Patch& patch : layout.patches) {
    area[patch.family] += (patch.ni - 1) * (patch.nj - 1);
    CHECK(patch.name.starts_with(patch.family.empty() ? "block " : patch.family + " "));
    CHECK(patch.file == "floor.obj");
    for (const Vec3& x : patch.points_world) {
      CHECK_FALSE((patch.family == "pad" && (x.x() < 3 || x.x() > 5 || x.y() < 2 || x.y() > 4)));
      CHECK_FALSE((patch.family.empty() && x.x() > 2));
    }
  }
  CHECK(area == std::map<std::string, int>{{"", 12}, {"floor", 20}, {"pad", 4}});
  // Without families and with a hole for the pad: four.
  CHECK(layout.patches.size() == 1 + 1 + 4);
}

TEST_CASE("quad layout: edges that run from border to border end patches, those that fade do not") {
  const auto folded = [](const Vec3& x) { return Vec3(x.x(), x.y(), std::abs(x.x() - 3)); };
  const QuadLayout fold = checked(bent(sheet(6, 4), folded));
  CHECK(fold.patches.size() == 2);
  CHECK(fold.report.feature_edges == 4);
  CHECK(patches_of(bent(sheet(6, 4), folded)) == 1);
  const auto fading = [](const Vec3& x) {
    return Vec3(x.x(), x.y(), std::max(0.0, 4 - x.y()) / 2 * std::abs(x.x() - 3));
  };
  const QuadLayout fade = checked(bent(sheet(6, 6), fading));
  CHECK(fade.patches.size() == 1);
  CHECK(fade.report.feature_edges == 0);
  CHECK(fade.report.loose_feature_edges >= 2);
  // Eight flat quads round a tube are a round tube of large cells, no eight features.
  CHECK(checked(tube(8, 5)).patches.size() == 1);
}

TEST_CASE("quad layout: what is no surface of quads is refused by file and place") {
  CHECK(contains(message_of(faces(0, {})), "the surface of part.obj has no faces"));
  CHECK(contains(message_of(faces(5, {{0, 1, 2, 3}, {1, 4, 2}})),
                 "face 2 of part.obj at (1, 1, 1) has 3 corners"));
  CHECK(contains(message_of(faces(4, {{0, 1, 2, 4}})),
                 "face 1 of part.obj at (0, 0, 0) uses a point "
                 "that there is not"));
  CHECK(contains(message_of(faces(4, {{0, 1, 2, 1}})), "uses a point twice"));
  const std::string three = message_of(faces(8, {{0, 1, 2, 3}, {1, 0, 4, 5}, {0, 1, 6, 7}}));
  CHECK(contains(three,
                 "3 faces, 1, 2 and 3 among them, meet on the edge from (0, 0, 0) to "
                 "(1, 1, 1) of part.obj"));
  CHECK(contains(message_of(faces(6, {{0, 1, 2, 3}, {0, 1, 4, 5}})),
                 "faces 1 and 2 are turned against each other on the edge from (0, 0, 0) to "
                 "(1, 1, 1) of part.obj"));
  CHECK(contains(message_of(faces(6, {{0, 1, 2, 3}, {2, 3, 4, 5}, {4, 5, 1, 0}})), "Moebius"));
  CHECK(contains(message_of(faces(7, {{0, 1, 2, 3}, {0, 4, 5, 6}})), "touch in a single point"));
  PolygonMesh nowhere = sheet(2, 2);
  nowhere.points_world[4].y() = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(message_of(nowhere), "point 5 at (2, nan, 0) is not finite"));
  for (const double turn : {0.0, -1.0, 4.0, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_WITH_AS(quad_layout(sheet(1, 1), {.feature_turn = turn}),
                         doctest::Contains("feature_turn"), InputError);
  }
}

TEST_CASE("quad layout: real meshes fall into a few patches that the surface stage takes whole") {
  const auto folder = shared_data();
  if (!folder) {
    MESSAGE("skipped: no shared data");
    return;
  }
  const std::map<std::string, std::size_t> most{{"hedra_eight-smoothed-quads.off", 10},
                                                {"cino_cubespikes.obj", 114},
                                                {"hedra_boxtoruscc2.off", 32},
                                                {"hedra_pipes_all_quads_closed.off", 30}};
  for (const auto& [name, patches] : most) {
    CAPTURE(name);
    const PolygonMesh mesh = read_quads(*folder + "/quadobj/" + name);
    const QuadLayout layout = checked(mesh);
    CHECK(layout.patches.size() <= patches);
    CHECK(build_surface(layout.patches).closed);
    CHECK(sizes_of(checked(renumbered(mesh, 5)).patches) == sizes_of(layout.patches));
  }
  CHECK(contains(message_of(read_quads(*folder + "/quadobj/gc_moebius.obj")), "Moebius"));
}
