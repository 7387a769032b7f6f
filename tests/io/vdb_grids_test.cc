#include <doctest/doctest.h>
#include <openvdb/openvdb.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <set>

#include "support/shapes.h"
#include "support/temp_folder.h"
#include "support/threads.h"
#include "vdb_offset/io/vdb.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

constexpr double kVoxel = 0.05;

FieldResult field_of(Patches patches, bool both) {
  PipelineOptions options;
  options.distance_world = 0.3;
  options.rasterize.voxel_world = kVoxel;
  options.surface.side = both ? MarchSide::Both : MarchSide::Along;
  options.surface.open_edges = OpenEdges::Splay;
  return make_field(std::move(patches), options);
}

FieldResult sphere(bool both) { return field_of(make_example("sphere", {.points = 33}), both); }

template <typename Grid>
typename Grid::Ptr read(const std::filesystem::path& file, const char* name) {
  openvdb::initialize();
  openvdb::io::File in(file.string());
  in.open(/*delayLoad=*/false);
  const auto grid = openvdb::findGridByName(*in.getGrids(), name);
  return grid ? openvdb::gridPtrCast<Grid>(grid) : nullptr;
}

Vec3 place(const openvdb::Coord& c) { return kVoxel * Vec3(c.x(), c.y(), c.z()); }

Vec3 vec(const openvdb::Vec3s& v) {
  return Vec3(static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z()));
}

std::string refusal(const DistanceField& field, const VdbWriteOptions& options) {
  const TempFolder folder;
  try {
    write_vdb(folder / "phi.vdb", field, nullptr, options);
  } catch (const IoError& error) {
    CHECK(folder.listing().empty());
    return error.what();
  }
  return "no refusal";
}

}  // namespace

TEST_CASE("vdb: the field of a closed surface on both sides is a level set to OpenVDB") {
  const TempFolder folder;
  const FieldResult result = sphere(true);
  write_vdb(folder / "f.vdb", result.field);
  const auto phi = read<openvdb::FloatGrid>(folder / "f.vdb", "phi");
  REQUIRE(phi);
  CHECK(phi->getGridClass() == openvdb::GRID_LEVEL_SET);
  CHECK(phi->background() == static_cast<float>(0.3 + kBandMarginVoxels * kVoxel));
  CHECK(phi->tree().getValue(openvdb::Coord(0)) == -phi->background());
  std::uint64_t inside = 0;
  for (auto it = phi->cbeginValueOn(); it; ++it) {
    const double r = place(it.getCoord()).norm();
    if (std::abs(r - 1) < 0.5 * kVoxel) continue;  // chords lie inside the sphere
    REQUIRE((*it < 0) == (r < 1));
    inside += *it < 0 ? 1U : 0U;
  }
  CHECK(inside > 1000);
}

TEST_CASE("vdb: normals point away from a sphere's centre, inside and outside") {
  const TempFolder folder;
  const FieldResult result = sphere(true);
  write_vdb(folder / "f.vdb", result.field, nullptr, {.phi = false, .normal = true});
  CHECK(read<openvdb::FloatGrid>(folder / "f.vdb", "phi") == nullptr);
  const auto normal = read<openvdb::Vec3SGrid>(folder / "f.vdb", "normal");
  REQUIRE(normal);
  CHECK(normal->activeVoxelCount() == result.field.phi->activeVoxelCount());
  CHECK(normal->voxelSize() == openvdb::Vec3d(kVoxel));
  double worst = 0;
  for (auto it = normal->cbeginValueOn(); it; ++it) {
    REQUIRE(std::abs((*it).length() - 1) < 4 * std::numeric_limits<float>::epsilon());
    worst = std::max(worst, (vec(*it) - place(it.getCoord()).normalized()).norm());
  }
  // One-sided differences on the rim are off by half a voxel's turn; the band reaches in to r.
  const double r = 1 - 0.3 - kBandMarginVoxels * kVoxel;
  CHECK(worst < kVoxel / r);
}

TEST_CASE("vdb: normals beside an open sheet lead away from its nearest place") {
  const TempFolder folder;
  const FieldResult result =
      field_of({rectangle("sheet", {9, 9}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})}, false);
  write_vdb(folder / "f.vdb", result.field, nullptr, {.normal = true});
  const auto normal = read<openvdb::Vec3SGrid>(folder / "f.vdb", "normal");
  REQUIRE(normal);
  int checked = 0;
  for (auto it = normal->cbeginValueOn(); it; ++it) {
    const Vec3 p = place(it.getCoord());
    const WallPoint nearest = result.surface.wall->closest(p);
    if (nearest.distance_world < 2 * kVoxel) continue;  // the edge's kink is in the differences
    const Vec3 away = nearest.side(p) * (p - nearest.point_world).normalized();
    REQUIRE(vec(*it).dot(away) > 0.8);
    ++checked;
  }
  CHECK(checked > 1000);
}

TEST_CASE("vdb: the feature of a voxel is a quad that no other is nearer than") {
  const TempFolder folder;
  const FieldResult result = field_of(make_example("l-bar", {.points = 9}), false);
  const auto write = [&](std::size_t threads, const char* name) {
    on_threads(threads, [&] {
      write_vdb(folder / name, result.field, nullptr, {.feature_of = &result.surface});
      return 0;
    });
    return read<openvdb::Int32Grid>(folder / name, "feature");
  };
  const auto feature = write(1, "one.vdb");
  const auto other = write(4, "four.vdb");
  REQUIRE(feature);
  CHECK(feature->background() == -1);
  CHECK(feature->activeVoxelCount() == result.field.phi->activeVoxelCount());
  // The quads in the order that the header names.
  std::vector<std::array<Vec3, 4>> quads;
  for (const Patch& patch : result.surface.patches) {
    for (int j = 0; j + 1 < patch.nj; ++j) {
      for (int i = 0; i + 1 < patch.ni; ++i) {
        quads.push_back(
            {patch.at(i, j), patch.at(i + 1, j), patch.at(i + 1, j + 1), patch.at(i, j + 1)});
      }
    }
  }
  int number = 0;
  for (auto it = feature->cbeginValueOn(); it; ++it) {
    REQUIRE(other->tree().getValue(it.getCoord()) == *it);
    if (++number % 41 != 0) continue;
    REQUIRE(*it >= 0);
    REQUIRE(*it < static_cast<int>(quads.size()));
    const auto& q = quads[static_cast<std::size_t>(*it)];
    const Vec3 centre = 0.25 * (q[0] + q[1] + q[2] + q[3]);
    const Wall quad({centre, q[0], q[1], q[2], q[3]}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}});
    const Vec3 p = place(it.getCoord());
    const double nearest = result.surface.wall->closest(p).distance_world;
    REQUIRE(std::abs(quad.closest(p).distance_world - nearest) < 1e-12 * (1 + nearest));
  }
  CHECK(number > 10000);
}

/// A prism on a pentagon, its sides quads and pairs of triangles by turns, in two families; among
/// them a face of no area and one that repeats another.
PolygonMesh mixed_prism() {
  PolygonMesh mesh;
  mesh.families = {"even", "odd"};
  for (int n = 0; n < 10; ++n) {
    const double angle = 2 * std::numbers::pi * (n % 5) / 5 + 0.1;
    mesh.points_world.emplace_back(std::cos(angle), std::sin(angle), n < 5 ? -0.4 : 0.6);
  }
  const auto add = [&](std::vector<int> corners) {
    mesh.add(corners);
    mesh.family.back() = static_cast<int>(mesh.faces() % 2);
  };
  add({4, 3, 2, 1, 0});
  add({0, 0, 1});
  for (int a = 0; a < 5; ++a) {
    const int b = (a + 1) % 5;
    if (a % 2 == 0) {
      add({a, b, b + 5, a + 5});
    } else {
      add({a, b, b + 5});
      add({a, b + 5, a + 5});
    }
    if (a == 2) add({a, b, b + 5, a + 5});
  }
  add({5, 6, 7, 8, 9});
  return mesh;
}

/// To a convex face, as the fan of its first corner.
double distance_to(const PolygonMesh& mesh, std::size_t face, const Vec3& p) {
  Vec3List corners;
  for (const int corner : mesh.face(face)) {
    corners.push_back(mesh.points_world[static_cast<std::size_t>(corner)]);
  }
  std::vector<Wall::Triangle> fan;
  for (int n = 1; n + 1 < static_cast<int>(corners.size()); ++n) fan.push_back({0, n, n + 1});
  return Wall(corners, fan).closest(p).distance_world;
}

TEST_CASE("vdb: the feature of a voxel is the number in the file of the nearest polygon") {
  const TempFolder folder;
  const PolygonMesh mesh = mixed_prism();
  const CleanedPolygons cleaned = clean_polygons(mesh);
  REQUIRE(cleaned.report.boundary_edges == 0);
  VdbWriteOptions options;
  options.face_numbers.resize(2);
  for (std::size_t f = 0; f < cleaned.mesh.faces(); ++f) {
    options.face_numbers[static_cast<std::size_t>(cleaned.mesh.family_of(f))].push_back(
        cleaned.numbers[f]);
  }
  const FieldResult result = field_of(face_patches(cleaned.mesh), false);
  REQUIRE(result.surface.patches.size() == 2);
  options.feature_of = &result.surface;
  write_vdb(folder / "f.vdb", result.field, nullptr, options);
  const auto feature = read<openvdb::Int32Grid>(folder / "f.vdb", "feature");
  REQUIRE(feature);
  std::set<int> seen;
  int number = 0;
  for (auto it = feature->cbeginValueOn(); it; ++it) {
    REQUIRE(*it >= 0);
    REQUIRE(*it < static_cast<int>(mesh.faces()));
    seen.insert(*it);
    if (++number % 29 != 0) continue;
    const Vec3 p = place(it.getCoord());
    const double nearest = result.surface.wall->closest(p).distance_world;
    REQUIRE(std::abs(distance_to(mesh, static_cast<std::size_t>(*it), p) - nearest) < 1e-12);
  }
  CHECK(seen == std::set<int>{0, 2, 3, 4, 5, 7, 8, 9, 10});  // but no face of no area, nor a copy
}

TEST_CASE("vdb: grids that are cancelled leave no file") {
  const TempFolder folder;
  const FieldResult result = sphere(true);
  const std::atomic<bool> cancel{true};
  const Progress progress{{}, &cancel};
  for (const bool has_normal : {false, true}) {
    CHECK_THROWS_AS(
        write_vdb(folder / "f.vdb", result.field, nullptr, {.normal = has_normal}, progress),
        Cancelled);
    CHECK(folder.listing().empty());
  }
}

TEST_CASE("vdb: half precision keeps eleven bits in a smaller file") {
  const TempFolder folder;
  const FieldResult result = sphere(false);
  write_vdb(folder / "full.vdb", result.field);
  write_vdb(folder / "half.vdb", result.field, nullptr, {.half = true});
  const auto bytes = [&](const char* name) {
    return static_cast<double>(std::filesystem::file_size(folder / name));
  };
  CHECK(bytes("half.vdb") < 0.7 * bytes("full.vdb"));
  const auto full = read<openvdb::FloatGrid>(folder / "full.vdb", "phi");
  const auto half = read<openvdb::FloatGrid>(folder / "half.vdb", "phi");
  REQUIRE(half);
  CHECK(half->saveFloatAsHalf());
  CHECK_FALSE(full->saveFloatAsHalf());
  double worst = 0;
  for (auto it = full->cbeginValueOn(); it; ++it) {
    const double change = std::abs(double(half->tree().getValue(it.getCoord())) - double(*it));
    worst = std::max(worst, change / std::max(std::abs(double(*it)), 1e-3 * kVoxel));
  }
  CHECK(worst <= std::ldexp(1.0, -11) * 1.01);
  CHECK(worst > std::ldexp(1.0, -13));
}

TEST_CASE("vdb: voxels and distances that a file cannot hold are refused before writing") {
  FieldResult result = sphere(false);
  result.field.voxel_world = 1e-6;
  CHECK(refusal(result.field, {}).find("--scale") != std::string::npos);
  CHECK(refusal(result.field, {}).find("phi.vdb") != std::string::npos);
  result.field.voxel_world = kVoxel;
  result.field.background_world = 7e4;
  CHECK(refusal(result.field, {.half = true}).find("--half") != std::string::npos);
}

}  // namespace vdb_offset::test
