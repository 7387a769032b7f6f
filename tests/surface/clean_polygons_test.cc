// Budget: one header's claims, on the same few shapes.
#include "vdb_offset/surface/clean_polygons.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "vdb_offset/core/error.h"

using namespace vdb_offset;

namespace {

using Faces = std::vector<std::vector<int>>;

PolygonMesh make(Vec3List points, const Faces& faces) {
  PolygonMesh mesh;
  mesh.points_world = std::move(points);
  for (const std::vector<int>& face : faces) mesh.add(face);
  mesh.file = "made.off";
  return mesh;
}

Vec3List cube_points() {
  Vec3List points;
  for (int n = 0; n < 8; ++n) points.emplace_back(n & 1, n >> 1 & 1, n >> 2 & 1);
  return points;
}
/// Normals outward.
const Faces kCube{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

PolygonMesh cube() { return make(cube_points(), kCube); }

double volume_of(const PolygonMesh& mesh) {
  double sum = 0.0;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    const auto p = [&](std::size_t n) {
      return mesh.points_world[static_cast<std::size_t>(face[n])];
    };
    for (std::size_t n = 1; n + 1 < face.size(); ++n) sum += p(0).dot(p(n).cross(p(n + 1)));
  }
  return sum / 6;
}

/// Twice the area that one face encloses, along its normal.
Vec3 vector_area(const PolygonMesh& mesh, std::size_t f) {
  const auto face = mesh.face(f);
  const auto p = [&](std::size_t n) {
    return mesh.points_world[static_cast<std::size_t>(face[n])];
  };
  Vec3 sum = Vec3::Zero();
  for (std::size_t n = 1; n + 1 < face.size(); ++n) sum += (p(n) - p(0)).cross(p(n + 1) - p(0));
  return sum;
}

/// Every face on its own points, as STL has them.
PolygonMesh loose(const PolygonMesh& mesh) {
  PolygonMesh out;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    std::vector<int> face;
    for (const int corner : mesh.face(f)) {
      face.push_back(static_cast<int>(out.points_world.size()));
      out.points_world.push_back(mesh.points_world[static_cast<std::size_t>(corner)]);
    }
    out.add(face);
  }
  return out;
}

std::string refusal(const PolygonMesh& mesh) {
  const CleanedPolygons cleaned = clean_polygons(mesh);
  try {
    refuse_unmeshable(cleaned.mesh, cleaned.report);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A closed torus of ni x nj quads, as triangles.
PolygonMesh torus(int ni, int nj) {
  PolygonMesh mesh;
  for (int j = 0; j < nj; ++j) {
    for (int i = 0; i < ni; ++i) {
      const double u = 2 * std::numbers::pi * i / ni;
      const double v = 2 * std::numbers::pi * j / nj;
      const double r = 2 + std::cos(v);
      mesh.points_world.emplace_back(r * std::cos(u), r * std::sin(u), std::sin(v));
    }
  }
  const auto at = [&](int i, int j) { return j % nj * ni + i % ni; };
  for (int j = 0; j < nj; ++j) {
    for (int i = 0; i < ni; ++i) {
      mesh.add(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.add(std::array{at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("clean_polygons: a sound closed surface stays as it is") {
  const CleanedPolygons cleaned = clean_polygons(cube());
  CHECK(cleaned.mesh.points_world == cube().points_world);
  CHECK(cleaned.mesh.corners == cube().corners);
  CHECK(cleaned.report.turned_faces == 0);
  CHECK(cleaned.report.parts == 1);
  CHECK(cleaned.report.closed_parts == 1);
  CHECK(cleaned.report.boundary_edges == 0);
  CHECK(cleaned.report.is_manifold());
  CHECK(cleaned.report.area_world == doctest::Approx(6));
  CHECK(refusal(cube()) == "");
}

TEST_CASE("clean_polygons: equal points become one, and points of no face go") {
  PolygonMesh mesh = loose(cube());
  mesh.points_world.emplace_back(9, 9, std::nan(""));
  for (Vec3& p : mesh.points_world) p = p.cwiseProduct(Vec3(1, 1, -1));  // zeros of both signs
  const CleanedPolygons cleaned = clean_polygons(mesh, {.weld = 0});
  CHECK(cleaned.report.welded_equal == 24 - 8);
  CHECK(cleaned.report.unused_points == 1);
  CHECK(cleaned.mesh.points_world.size() == 8);
  CHECK(cleaned.report.boundary_edges == 0);
  CHECK(volume_of(cleaned.mesh) == doctest::Approx(1));
}

TEST_CASE("clean_polygons: near points are welded within the tolerance and no farther") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-1, 1);
  const auto shaken = [&](double size) {
    PolygonMesh mesh = loose(cube());
    for (Vec3& p : mesh.points_world) p += size * Vec3(shift(random), shift(random), shift(random));
    return mesh;
  };
  const double most = 2 * std::sqrt(3.0);  // distance of two points, in sizes
  const CleanedPolygons within = clean_polygons(shaken(0.009 / most), {.weld = 0.01});
  CHECK(within.mesh.points_world.size() == 8);
  CHECK(within.report.welded_near == 16);
  CHECK(within.report.moved_max_world < 0.009);
  CHECK(within.report.moved_max_world > 0);
  CHECK(clean_polygons(shaken(0.009 / most), {.weld = 0}).mesh.points_world.size() == 24);
  CHECK(clean_polygons(shaken(0.5), {.weld = 0.01}).mesh.points_world.size() == 24);
  CHECK_THROWS_AS(clean_polygons(cube(), {.weld = 0.5}), InputError);
  CHECK_THROWS_AS(clean_polygons(cube(), {.weld = std::nan("")}), InputError);
}

TEST_CASE("clean_polygons: faces of fewer than three points and repeated faces are dropped") {
  Faces faces = kCube;
  for (const std::vector<int>& face : Faces{{0},
                                            {0, 1},
                                            {0, 1, 0},
                                            {0, 1, 1, 0},
                                            {},
                                            {0, 1, 0, 1, 0},
                                            {2, 3, 1, 0},
                                            {1, 3, 2, 0},
                                            {0, 0, 2, 2, 3, 1, 1}}) {
    faces.push_back(face);
  }
  const CleanedPolygons cleaned = clean_polygons(make(cube_points(), faces));
  CHECK(cleaned.report.degenerate_faces == 6);
  CHECK(cleaned.report.duplicate_faces == 3);
  CHECK(cleaned.mesh.corners == cube().corners);
  CHECK_THROWS_AS(clean_polygons(make(cube_points(), {{0, 1, 1}})), InputError);
}

TEST_CASE("clean_polygons: however faces are turned, a closed part ends with a positive volume") {
  for (unsigned turned = 0; turned < 64; ++turned) {
    Faces faces = kCube;
    for (std::size_t f = 0; f < 6; ++f) {
      if (turned >> f & 1) std::reverse(faces[f].begin(), faces[f].end());
    }
    const CleanedPolygons cleaned = clean_polygons(make(cube_points(), faces));
    CHECK(volume_of(cleaned.mesh) == doctest::Approx(1));
    CHECK(cleaned.report.turned_faces == static_cast<std::size_t>(std::popcount(turned)));
    CHECK(cleaned.report.is_manifold());
    const CleanedPolygons kept =
        clean_polygons(make(cube_points(), faces), {.turn_outward = false});
    const int most = std::popcount(turned) > 3 ? -1 : 1;
    if (std::popcount(turned) != 3) CHECK(volume_of(kept.mesh) == doctest::Approx(most));
    CHECK(kept.report.turned_faces <= 3);
  }
}

TEST_CASE("clean_polygons: each of several parts is oriented by its own volume") {
  PolygonMesh mesh = cube();
  for (const Vec3& p : cube_points()) mesh.points_world.push_back(p + Vec3(5, 0, 0));
  for (const std::vector<int>& face : kCube) {
    std::vector<int> turned(face.rbegin(), face.rend());
    for (int& corner : turned) corner += 8;
    mesh.add(turned);
  }
  const CleanedPolygons cleaned = clean_polygons(mesh);
  CHECK(cleaned.report.parts == 2);
  CHECK(cleaned.report.turned_parts == 1);
  CHECK(cleaned.report.turned_faces == 6);
  CHECK(volume_of(cleaned.mesh) == doctest::Approx(2));
}

TEST_CASE("clean_polygons: an open part keeps the sense of most of its faces") {
  Faces faces(kCube.begin(), kCube.begin() + 5);
  std::reverse(faces[1].begin(), faces[1].end());
  const CleanedPolygons cleaned = clean_polygons(make(cube_points(), faces));
  CHECK(cleaned.report.turned_faces == 1);
  CHECK(cleaned.report.boundary_edges == 4);
  CHECK(cleaned.report.closed_parts == 0);
  CHECK(std::equal(kCube[0].begin(), kCube[0].end(), cleaned.mesh.face(0).begin()));
}

TEST_CASE("clean_polygons: star polygons are split into triangles of their area and sense") {
  std::mt19937 random(5);
  for (const int count : {5, 6, 9, 20, 101, 1000}) {
    std::uniform_real_distribution<double> radius(0.2, 1);
    Vec3List points;
    std::vector<int> face;
    const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized();
    for (int n = 0; n < count; ++n) {
      const double angle = 2 * std::numbers::pi * n / count;
      const double r = radius(random);
      points.push_back(turn * (1e3 * Vec3(r * std::cos(angle), r * std::sin(angle), 0)) +
                       Vec3(1e3, 2e3, 3e3));
      face.push_back(n);
    }
    const PolygonMesh mesh = make(points, {face});
    const CleanedPolygons cleaned = clean_polygons(mesh, {.weld = 0});
    CAPTURE(count);
    CHECK(cleaned.report.split_polygons == 1);
    CHECK(cleaned.report.crossed_polygons == 0);
    CHECK(cleaned.mesh.faces() == static_cast<std::size_t>(count) - 2);
    const Vec3 whole = vector_area(mesh, 0);
    Vec3 sum = Vec3::Zero();
    for (std::size_t f = 0; f < cleaned.mesh.faces(); ++f) {
      const Vec3 area = vector_area(cleaned.mesh, f);
      sum += area;
      CHECK(area.dot(whole) > 0);  // none is outside: their sum is right without cancelling
    }
    CHECK((sum - whole).norm() < 1e-9 * whole.norm());
    CHECK(cleaned.report.boundary_edges == static_cast<std::size_t>(count));
    CHECK(cleaned.report.is_manifold());
  }
}

TEST_CASE("clean_polygons: a polygon round a hole, with a slit to it, leaves the hole open") {
  Vec3List points{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                  {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  const PolygonMesh mesh = make(points, {{0, 1, 2, 3, 0, 4, 5, 6, 7, 4}});
  const CleanedPolygons cleaned = clean_polygons(mesh);
  CHECK(cleaned.report.crossed_polygons == 0);
  CHECK(cleaned.report.area_world == doctest::Approx(16 - 4));
  CHECK(cleaned.report.boundary_edges == 8);
  CHECK(cleaned.mesh.faces() == 8);
}

TEST_CASE("clean_polygons: concave and straight quads are split, convex and bent ones stay") {
  const auto triangles = [](const Vec3& fourth, const CleanOptions& options = {}) {
    return clean_polygons(make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, fourth}, {{0, 1, 2, 3}}), options)
        .mesh.faces();
  };
  CHECK(triangles({0, 1, 0}) == 1);
  CHECK(triangles({0, 1, 0.5}) == 1);
  CHECK(triangles({0.7, 0.3, 0}) == 2);
  CHECK(triangles({0.5, 0.5, 0}) == 2);
  CHECK(triangles({0.7, 0.3, 0}, {.split_concave_quads = false}) == 1);
  const CleanedPolygons dart =
      clean_polygons(make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.7, 0.3, 0}}, {{0, 1, 2, 3}}));
  CHECK(dart.report.area_world == doctest::Approx(0.3));
}

TEST_CASE("clean_polygons: quads that cross themselves are named, by the file's numbers") {
  Faces faces = kCube;
  faces.insert(faces.begin(), {0, 0, 1});  // dropped; others keep their numbers
  for (const std::array<std::size_t, 2> exchanged : {std::array<std::size_t, 2>{1, 2}, {2, 3}}) {
    Faces crossed = faces;
    std::swap(crossed[4][exchanged[0]], crossed[4][exchanged[1]]);
    const PolygonMesh mesh = make(cube_points(), crossed);
    const CleanReport report = clean_polygons(mesh).report;
    REQUIRE(report.crossed_faces.size() == 1);
    CHECK(report.crossed_faces[0].face == 5);
    CHECK_THROWS_WITH_AS(refuse_unmeshable(mesh, report), doctest::Contains("first face 5"),
                         InputError);
  }
  CHECK(clean_polygons(cube()).report.crossed_faces.empty());
  // Bent, concave, and folded over its diagonal, it does not.
  for (const Vec3& fourth : {Vec3(0, 1, 0.9), Vec3(0.7, 0.3, 0), Vec3(0.9, 0.1, 0.2)}) {
    const PolygonMesh quad = make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, fourth}, {{0, 1, 2, 3}});
    CHECK(clean_polygons(quad).report.crossed_faces.empty());
  }
}

TEST_CASE("clean_polygons: polygons that cross themselves are split and counted") {
  const PolygonMesh bow =
      make({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}}, {{0, 1, 2, 3, 4}});
  CHECK(clean_polygons(bow).report.crossed_polygons <= 1);
  const PolygonMesh line =
      make({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, {{0, 1, 2, 3, 4}});
  CHECK(clean_polygons(line).report.crossed_polygons == 1);
  std::vector<int> many(kMostCorners + 1);
  Vec3List points;
  for (std::size_t n = 0; n < many.size(); ++n) {
    many[n] = static_cast<int>(n);
    points.emplace_back(std::cos(6e-4 * static_cast<double>(n)),
                        std::sin(6e-4 * static_cast<double>(n)), 0);
  }
  CHECK_THROWS_AS(clean_polygons(make(points, {many}), {.weld = 0}), InputError);
  many.pop_back();
  CHECK(clean_polygons(make(points, {many}), {.weld = 0}).mesh.faces() == kMostCorners - 2);
}

TEST_CASE("clean_polygons: an edge of three faces is reported with its place, and refused") {
  const PolygonMesh book = make({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}},
                                {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  const CleanReport report = clean_polygons(book).report;
  REQUIRE(report.many_faced_edges.size() == 1);
  CHECK(report.many_faced_edges[0].count == 3);
  CHECK(report.many_faced_edges[0].from_world == Vec3(0, 0, 0));
  CHECK(report.many_faced_edges[0].to_world == Vec3(0, 0, 1));
  CHECK(report.parts == 1);
  CHECK(report.boundary_edges == 6);
  const std::string said = refusal(book);
  CHECK(contains(said, "made.off: 1 edge of more than two faces, the first of 3"));
  CHECK(contains(said, "from (0, 0, 0) to (0, 0, 1)"));
  CHECK(contains(said, "'field'"));
}

TEST_CASE("clean_polygons: cubes that touch in an edge are each closed and turned outward") {
  PolygonMesh mesh = cube();
  Faces faces;
  for (const Vec3& p : cube_points()) mesh.points_world.push_back(p + Vec3(1, 1, 0));
  for (const std::vector<int>& face : kCube) {
    std::vector<int> other(face.rbegin(), face.rend());
    for (int& corner : other) corner += 8;
    mesh.add(other);
  }
  const CleanedPolygons cleaned = clean_polygons(mesh);
  CHECK(cleaned.report.many_faced_edges.size() == 1);
  CHECK(cleaned.report.turned_parts == 1);
  CHECK(volume_of(cleaned.mesh) == doctest::Approx(2));
}

TEST_CASE("clean_polygons: parts that touch in a point are reported with it, and refused") {
  PolygonMesh mesh = cube();
  for (const Vec3& p : cube_points()) mesh.points_world.push_back(p + Vec3(1, 1, 1));
  for (std::vector<int> face : kCube) {
    for (int& corner : face) corner += 8;
    mesh.add(face);
  }
  const CleanReport report = clean_polygons(mesh).report;
  REQUIRE(report.many_fan_points.size() == 1);
  CHECK(report.many_fan_points[0].from_world == Vec3(1, 1, 1));
  CHECK(report.many_fan_points[0].count == 2);
  CHECK(report.many_faced_edges.empty());
  CHECK(report.parts == 2);
  CHECK(contains(refusal(mesh),
                 "1 point where parts touch in a point alone, the first of 2 parts "
                 "at (1, 1, 1)"));
}

TEST_CASE("clean_polygons: a Moebius strip is reported once and refused") {
  constexpr int kCount = 12;
  PolygonMesh strip;
  for (int n = 0; n < kCount; ++n) {
    const double u = 2 * std::numbers::pi * n / kCount;
    for (const double w : {-0.3, 0.3}) {
      const double r = 1 + w * std::cos(u / 2);
      strip.points_world.emplace_back(r * std::cos(u), r * std::sin(u), w * std::sin(u / 2));
    }
  }
  for (int n = 0; n < kCount; ++n) {
    const bool last = n + 1 == kCount;
    const int a = last ? 1 : 2 * n + 2;
    const int b = last ? 0 : 2 * n + 3;
    strip.add(std::array{2 * n, a, b, 2 * n + 1});
  }
  const CleanReport report = clean_polygons(strip).report;
  CHECK(report.twisted_edges.size() == 1);
  CHECK(report.boundary_edges == 2 * kCount);
  CHECK(contains(refusal(strip), "1 part with one side only"));
}

TEST_CASE("face_patches: a patch a family, with its points once") {
  PolygonMesh mesh = cube();
  mesh.families = {"top", "none", "", "top "};
  mesh.family = {2, 0, 2, 2, 3, 3};
  const Patches patches = face_patches(clean_polygons(mesh).mesh);
  REQUIRE(patches.size() == 3);
  CHECK(patches[0].name == "top");
  CHECK(patches[0].family == "top");
  CHECK(patches[0].faces == std::vector<std::array<int, 4>>{{0, 1, 2, 3}});
  CHECK(patches[0].ni == 4);
  CHECK(patches[0].nj == 0);
  CHECK(patches[0].points_world[2] == mesh.points_world[7]);
  CHECK(patches[0].file == "made.off");
  CHECK(patches[1].name == "patch 2");
  CHECK(patches[1].family == "");
  CHECK(patches[1].faces.size() == 3);
  CHECK(patches[2].points_world.size() == 8);
  const Patches one = face_patches(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{2, 0, 1}}));
  CHECK(one[0].name == "patch 1");
  CHECK(one[0].faces == std::vector<std::array<int, 4>>{{0, 1, 2, 2}});
  CHECK(one[0].points_world[0] == Vec3(0, 1, 0));
  CHECK_THROWS_AS(face_patches(make(cube_points(), {{0, 1, 2, 3, 4}})), InputError);
}

TEST_CASE("clean_polygons: random soups of few points end as triangles and quads of their points") {
  std::mt19937 random(17);
  for (int round = 0; round < 2000; ++round) {
    PolygonMesh mesh;
    const int points = 3 + static_cast<int>(random() % 12);
    for (int n = 0; n < points; ++n) {
      mesh.points_world.emplace_back(random() % 4, random() % 4, random() % 3);
    }
    for (int f = 1 + static_cast<int>(random() % 10); f > 0; --f) {
      std::vector<int> face(random() % 9);
      for (int& corner : face) corner = static_cast<int>(random() % static_cast<unsigned>(points));
      mesh.add(face);
    }
    CleanedPolygons cleaned;
    try {
      cleaned = clean_polygons(mesh);
    } catch (const InputError&) {
      continue;
    }
    std::vector<bool> used(cleaned.mesh.points_world.size(), false);
    for (std::size_t f = 0; f < cleaned.mesh.faces(); ++f) {
      const auto face = cleaned.mesh.face(f);
      std::vector<int> sorted(face.begin(), face.end());
      std::sort(sorted.begin(), sorted.end());
      if (face.size() < 3 || face.size() > 4) FAIL("a face of " << face.size() << " corners");
      if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) FAIL("a corner twice");
      for (const int corner : face) used[static_cast<std::size_t>(corner)] = true;
    }
    if (std::find(used.begin(), used.end(), false) != used.end()) FAIL("a point of no face");
    const CleanedPolygons again = clean_polygons(cleaned.mesh, {.weld = 0});
    CHECK(again.mesh.faces() == cleaned.mesh.faces());
    CHECK(again.report.duplicate_faces == 0);
    CHECK(again.report.boundary_edges == cleaned.report.boundary_edges);
  }
}

TEST_CASE("clean_polygons: a torus of loose triangles is welded shut") {
  const PolygonMesh soup = loose(torus(60, 40));
  const CleanedPolygons cleaned = clean_polygons(soup);
  CHECK(cleaned.mesh.points_world.size() == 2400);
  CHECK(cleaned.mesh.faces() == 4800);
  CHECK(cleaned.report.boundary_edges == 0);
  CHECK(cleaned.report.is_manifold());
  const double exact = 2 * std::numbers::pi * std::numbers::pi * 2;
  CHECK(volume_of(cleaned.mesh) == doctest::Approx(exact).epsilon(0.01));
}

TEST_CASE("clean: a triangle without area that closes a T-junction is flipped into its neighbour") {
  // The unit cube, one edge of which has its middle in one of its two faces alone.
  for (const bool quads : {true, false}) {
    Vec3List points = cube_points();
    points.emplace_back(0.5, 0, 0);
    Faces faces{{0, 2, 3},    {0, 3, 8},    {8, 3, 1},    {4, 5, 7, 6},
                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}, {8, 1, 0}};
    if (quads) {
      faces.push_back({0, 1, 5, 4});
    } else {
      faces.insert(faces.end(), {{0, 1, 5}, {0, 5, 4}});
    }
    const CleanedPolygons cleaned = clean_polygons(make(points, faces));
    CHECK(cleaned.report.flipped_triangles == 1);
    CHECK(cleaned.report.flat_triangles == 0);
    CHECK(cleaned.report.boundary_edges == 0);
    CHECK(cleaned.report.is_manifold());
    CHECK(volume_of(cleaned.mesh) == doctest::Approx(1).epsilon(1e-15));
    for (std::size_t f = 0; f < cleaned.mesh.faces(); ++f) {
      CHECK(vector_area(cleaned.mesh, f).norm() > 0.4);
    }
  }
}

TEST_CASE("clean: two sides of a thin plate stay apart, a sheet that is there twice is one") {
  // Triangles with points of their own, each off by a little.
  constexpr int kCells = 10;
  constexpr double kHeight = 5e-4;  // edges of 0.1 are welded up to twice that
  Vec3List points;
  Faces faces;
  const auto add = [&](const std::array<Vec3, 3>& triangle) {
    faces.emplace_back();
    for (const Vec3& p : triangle) {
      faces.back().push_back(static_cast<int>(points.size()));
      points.push_back(p + Vec3::Constant(1e-9 * std::sin(static_cast<double>(points.size()))));
    }
  };
  const auto quad = [&](const Vec3& a, const Vec3& along, const Vec3& across) {
    add({a, a + along, a + along + across});
    add({a, a + along + across, a + across});
  };
  const Vec3 x = 0.1 * Vec3::UnitX();
  const Vec3 y = 0.1 * Vec3::UnitY();
  const Vec3 z = kHeight * Vec3::UnitZ();
  const auto skins = [&](bool is_sheet) {
    for (int n = 0; n < kCells * kCells; ++n) {
      const Vec3 at = n % kCells * x + n / kCells * y;
      quad(at + z, x, y);
      quad(at, is_sheet ? x : y, is_sheet ? y : x);
    }
  };
  skins(false);
  for (int n = 0; n < kCells; ++n) {
    quad(n * x, x, z);
    quad(kCells * y + (n + 1) * x, -x, z);
    quad(n * y + y, -y, z);
    quad(kCells * x + n * y, y, z);
  }
  const CleanedPolygons plate = clean_polygons(make(points, faces));
  CHECK(plate.report.boundary_edges == 0);
  CHECK(plate.report.closed_parts == 1);
  CHECK(plate.report.is_manifold());
  points.clear();
  faces.clear();
  skins(true);
  const CleanedPolygons sheet = clean_polygons(make(points, faces));
  CHECK(sheet.report.boundary_edges == 4 * kCells);
  CHECK(sheet.report.is_manifold());
}

TEST_CASE("clean: a gap between closed parts stays, a crack does not") {
  constexpr double kGap = 0.005;  // of edges of 1, which are welded up to 0.01
  Vec3List points = cube_points();
  Faces faces = kCube;
  for (const Vec3& p : cube_points()) points.push_back(p + Vec3(1 + kGap, 0, 0));
  for (const std::vector<int>& face : kCube) {
    faces.emplace_back();
    for (const int corner : face) faces.back().push_back(corner + 8);
  }
  for (const bool free_alone : {false, true}) {
    const CleanedPolygons apart =
        clean_polygons(make(points, faces), {.weld_free_alone = free_alone});
    CHECK(apart.report.welded_near == 0);
    CHECK(apart.report.closed_parts == 2);
    CHECK(apart.report.is_manifold());
  }

  points = cube_points();
  faces = kCube;
  for (int& corner : faces[1]) {  // the lid, on points of its own
    points.push_back(points[static_cast<std::size_t>(corner)] + Vec3(0, 0, kGap));
    corner = static_cast<int>(points.size()) - 1;
  }
  const CleanedPolygons closed = clean_polygons(make(points, faces), {.weld_free_alone = true});
  CHECK(closed.report.welded_near == 4);
  CHECK(closed.report.boundary_edges == 0);
  const auto& [from, to] = closed.report.moved_farthest_world;
  CHECK((from - to).norm() == closed.report.moved_max_world);
  CHECK(closed.report.moved_max_world == doctest::Approx(kGap));
}

TEST_CASE("clean: slivers of two triangles stay as they are, and each is counted once") {
  // A box so thin that its four sides are made of triangles without area.
  Vec3List points = cube_points();
  for (Vec3& p : points) p.z() *= 1e-9;
  Faces faces;
  for (const std::vector<int>& q : kCube) {
    faces.push_back({q[0], q[1], q[2]});
    faces.push_back({q[0], q[2], q[3]});
  }
  const CleanedPolygons cleaned = clean_polygons(make(points, faces), {.weld = 0});
  CHECK(cleaned.report.flipped_triangles == 0);
  CHECK(cleaned.report.flat_triangles == 8);
  CHECK(cleaned.report.boundary_edges == 0);
  CHECK(cleaned.mesh.faces() == faces.size());
}

TEST_CASE("clean: faces have the number in the file of the one that they are, or are pieces of") {
  PolygonMesh mesh = cube();
  mesh.add(std::vector<int>{0, 0, 1});     // 6: dropped
  mesh.add(std::vector<int>{0, 1, 3, 2});  // 7: repeats 0
  mesh.points_world.insert(mesh.points_world.end(),
                           {{5, 0, 0}, {6, 0, 0}, {7, 1, 0}, {6, 2, 0}, {5, 1, 0}});
  mesh.add(std::vector<int>{8, 9, 10, 11, 12});  // 8: three triangles
  const CleanedPolygons cleaned = clean_polygons(mesh);
  CHECK(cleaned.numbers == std::vector<int>{0, 1, 2, 3, 4, 5, 8, 8, 8});
  CHECK(cleaned.mesh.faces() == cleaned.numbers.size());
}
