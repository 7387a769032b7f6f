// Bands of faces that are no surface: sides by winding numbers.

#include <doctest/doctest.h>
#include <openvdb/openvdb.h>

#include <cmath>

#include "support/polygons.h"
#include "vdb_offset/rasterize/rasterize.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset::test {

TEST_CASE(
    "soup: with a hole and doubled faces inside is inside, and distances are those to faces") {
  Patch sphere = icosphere(3);
  sphere.faces.erase(sphere.faces.begin() + 17);
  sphere.faces.push_back(sphere.faces[5]);
  SurfaceOptions options;
  options.sides = SideRule::Winding;
  options.side = MarchSide::Both;
  const Surface surface = build_surface({sphere}, options);
  const double voxel = 0.05;
  const Band band = rasterize(
      surface, {.distance_world = 0.4, .voxel_world = voxel, .both_sides = surface.both_sides});
  CHECK(band.closed);
  const DistanceField field = sweep(band);
  int inside = 0;
  int outside = 0;
  for (auto voxels = field.phi->cbeginValueOn(); voxels; ++voxels) {
    const openvdb::Vec3d at = field.phi->indexToWorld(voxels.getCoord());
    const Vec3 p(at.x(), at.y(), at.z());
    if (std::abs(p.norm() - 1) < voxel) continue;  // of the hole the sides are a matter of taste
    CHECK((*voxels < 0) == (p.norm() < 1));
    ++(*voxels < 0 ? inside : outside);
    const double exact = surface.wall->closest_place(p).distance_world;
    CHECK(std::abs(std::abs(static_cast<double>(*voxels)) - exact) < voxel);
  }
  CHECK(inside > 10000);
  CHECK(outside > 10000);
}

}  // namespace vdb_offset::test
