#include "vdb_offset/io/vdb.h"

#include <doctest/doctest.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointCount.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <random>

#include "support/hand_made.h"
#include "support/temp_folder.h"
#include "support/threads.h"
#include "vdb_offset/core/version.h"

namespace vdb_offset::test {
namespace {

constexpr double kVoxel = 0.1;
constexpr double kBackground = 0.6;
constexpr double kRadius = 1.0;

/// Signed distance to a sphere in the narrow band that the sweep leaves: two voxels behind the
/// wall, `kBackground` in front. `sign` = -1: seen from inside, as in a duct.
DistanceField sphere_field(bool closed, float sign = 1) {
  DistanceField field;
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(static_cast<float>(kBackground));
  const int reach = static_cast<int>((kRadius + kBackground) / kVoxel) + 1;
  auto values = grid->getAccessor();
  const openvdb::CoordBBox box(openvdb::Coord(-reach), openvdb::Coord(reach));
  for (const openvdb::Coord& at : box) {
    const double phi = sign * (kVoxel * at.asVec3d().length() - kRadius);
    if (phi > -2 * kVoxel && phi < kBackground) values.setValue(at, static_cast<float>(phi));
  }
  field.phi = grid;
  field.voxel_world = kVoxel;
  field.distance_world = kBackground - 4 * kVoxel;
  field.background_world = kBackground;
  field.closed = closed;
  return field;
}

/// Nodes scattered over a box with several in a voxel, so that their order can go wrong.
Layers scattered_layers(int nodes) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> where(-1, 1);
  return make_layers(nodes, 2, [&](int, int) -> Vec3 {
    return {where(random), where(random), 0.1 * where(random)};
  });
}

openvdb::GridPtrVecPtr read(const std::filesystem::path& file) {
  openvdb::initialize();
  openvdb::io::File in(file.string());
  in.open(/*delayLoad=*/false);
  return in.getGrids();
}

openvdb::FloatGrid::Ptr read_phi(const std::filesystem::path& file) {
  return openvdb::gridPtrCast<openvdb::FloatGrid>(openvdb::findGridByName(*read(file), "phi"));
}

using Vec3Set = std::vector<std::array<double, 3>>;

Vec3Set sorted_points(const openvdb::points::PointDataGrid& grid) {
  Vec3Set points;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const openvdb::points::AttributeHandle<openvdb::Vec3f> position(leaf->constAttributeArray("P"));
    for (auto index = leaf->beginIndexOn(); index; ++index) {
      const openvdb::Vec3d at = position.get(*index) + index.getCoord().asVec3d();
      const openvdb::Vec3d world = grid.transform().indexToWorld(at);
      points.push_back({world.x(), world.y(), world.z()});
    }
  }
  std::sort(points.begin(), points.end());
  return points;
}

TEST_CASE("vdb: a closed body is a level set, negative all through its inside") {
  const TempFolder folder;
  const DistanceField field = sphere_field(true);
  write_vdb(folder / "phi.vdb", field);
  CHECK(folder.listing() == std::vector<std::string>{"phi.vdb"});
  const auto grids = read(folder / "phi.vdb");
  CHECK(grids->size() == 1);
  const auto phi = read_phi(folder / "phi.vdb");
  REQUIRE(phi);
  CHECK(phi->getGridClass() == openvdb::GRID_LEVEL_SET);
  CHECK(phi->getCreator() == std::string("vdb-offset ") + kVersion);
  CHECK(phi->background() == static_cast<float>(kBackground));
  CHECK(phi->voxelSize() == openvdb::Vec3d(kVoxel));
  CHECK(phi->transform().isLinear());
  CHECK(phi->activeVoxelCount() == field.phi->activeVoxelCount());
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    REQUIRE(phi->tree().getValue(voxel.getCoord()) == *voxel);
  }
  CHECK(phi->tree().getValue(openvdb::Coord(0)) == -static_cast<float>(kBackground));
  CHECK(phi->tree().getValue(openvdb::Coord(1000)) == static_cast<float>(kBackground));
  // OpenVDB's own mesher must find the one sphere, and no shell where the band ends inside
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*phi, points, quads);
  CHECK(!points.empty());
  for (const openvdb::Vec3s& p : points) CHECK(std::abs(p.length() - kRadius) < 0.1 * kVoxel);
}

TEST_CASE("vdb: the field that is given is not touched") {
  const TempFolder folder;
  const DistanceField field = sphere_field(false);
  const auto before = field.phi->deepCopy();
  write_vdb(folder / "phi.vdb", field);
  CHECK(field.phi->getName().empty());
  bool same = before->activeVoxelCount() == field.phi->activeVoxelCount();
  for (auto voxel = before->cbeginValueOn(); voxel; ++voxel) {
    same = same && field.phi->tree().getValue(voxel.getCoord()) == *voxel;
  }
  CHECK(same);
}

TEST_CASE("vdb: an open surface has an unsigned field") {
  const TempFolder folder;
  const DistanceField field = sphere_field(false);
  write_vdb(folder / "phi.vdb", field);
  const auto phi = read_phi(folder / "phi.vdb");
  REQUIRE(phi);
  CHECK(phi->getGridClass() == openvdb::GRID_UNKNOWN);
  CHECK(phi->background() == static_cast<float>(kBackground));
  bool had_negative = false;
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    had_negative = had_negative || *voxel < 0;
    REQUIRE(phi->tree().getValue(voxel.getCoord()) == std::abs(*voxel));
  }
  CHECK(had_negative);
  for (auto value = phi->cbeginValueAll(); value; ++value) REQUIRE(*value >= 0);
}

TEST_CASE("vdb: a closed surface filled from inside keeps its signs, but is no level set") {
  const TempFolder folder;
  const DistanceField field = sphere_field(true, -1);
  write_vdb(folder / "phi.vdb", field);
  const auto phi = read_phi(folder / "phi.vdb");
  REQUIRE(phi);
  CHECK(phi->getGridClass() == openvdb::GRID_UNKNOWN);
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    REQUIRE(phi->tree().getValue(voxel.getCoord()) == *voxel);
  }
}

TEST_CASE("vdb: a duct filled on both sides is turned round to be a level set") {
  const TempFolder folder;
  DistanceField field = sphere_field(true, -1);
  field.both_sides = true;
  write_vdb(folder / "phi.vdb", field);
  const auto phi = read_phi(folder / "phi.vdb");
  REQUIRE(phi);
  CHECK(phi->getGridClass() == openvdb::GRID_LEVEL_SET);
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    REQUIRE(phi->tree().getValue(voxel.getCoord()) == -*voxel);
  }
  CHECK(phi->tree().getValue(openvdb::Coord(1000)) == static_cast<float>(kBackground));
}

TEST_CASE("vdb: the outermost level's points come back, each once") {
  const TempFolder folder;
  const int nodes = 5000;
  const Layers layers = scattered_layers(nodes);
  write_vdb(folder / "both.vdb", sphere_field(true), &layers);
  const auto grids = read(folder / "both.vdb");
  CHECK(grids->size() == 2);
  const auto level = openvdb::gridPtrCast<openvdb::points::PointDataGrid>(
      openvdb::findGridByName(*grids, "level"));
  REQUIRE(level);
  CHECK(level->voxelSize() == openvdb::Vec3d(kVoxel));
  CHECK(openvdb::points::pointCount(level->tree()) == static_cast<openvdb::Index64>(nodes));
  Vec3Set expected;
  for (int n = 0; n < nodes; ++n) {
    const Vec3& p = layers.at(n, 2);
    expected.push_back({p.x(), p.y(), p.z()});
  }
  std::sort(expected.begin(), expected.end());
  const Vec3Set found = sorted_points(*level);
  REQUIRE(found.size() == expected.size());
  // positions are single precision within a voxel
  const double rounding = kVoxel * std::numeric_limits<float>::epsilon();
  for (std::size_t n = 0; n < found.size(); ++n) {
    for (std::size_t a = 0; a < 3; ++a) CHECK(std::abs(found[n][a] - expected[n][a]) < rounding);
  }
}

TEST_CASE("vdb: the same bytes on one thread and on four, the random file id aside") {
  const TempFolder folder;
  const DistanceField field = sphere_field(true);
  const Layers layers = scattered_layers(20000);
  const auto write = [&](std::size_t threads, const std::string& name) {
    return on_threads(threads, [&] {
      write_vdb(folder / name, field, &layers);
      std::string bytes = file_bytes(folder / name);
      // magic (8), file version (4), library version (8), offsets flag (1), then the id (36)
      return bytes.erase(21, 36);
    });
  };
  const std::string one = write(1, "one.vdb");
  CHECK(one.size() > 20000 * sizeof(float));
  CHECK(one == write(4, "four.vdb"));
}

TEST_CASE("vdb: a write that fails leaves everything as it was") {
  const TempFolder folder;
  const DistanceField field = sphere_field(true);
  CHECK_THROWS_AS(write_vdb(folder / "missing/phi.vdb", field), IoError);
  CHECK(folder.listing().empty());
  std::filesystem::create_directory(folder / "phi.vdb");
  CHECK_THROWS_AS(write_vdb(folder / "phi.vdb", field), IoError);
  CHECK(folder.listing() == std::vector<std::string>{"phi.vdb"});
}

}  // namespace
}  // namespace vdb_offset::test
