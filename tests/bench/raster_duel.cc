#include "bench/raster_duel.h"

#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>

#include "bench/measure.h"

namespace vdb_offset::bench {

namespace {

RasterizeOptions narrow_options() {
  RasterizeOptions options;
  options.voxel_world = 1;
  options.distance_world = 1e-3;  // the margin alone is wider than the narrow band
  options.both_sides = true;
  options.unsigned_if_open = true;  // as the peer is asked
  options.exact_voxels = kNarrowVoxels;
  return options;
}

openvdb::FloatGrid::Ptr mesh_to_volume(const Input& in, double& time) {
  std::vector<openvdb::Vec3d> points;
  for (const Vec3& v : in.vertices) points.emplace_back(v.x(), v.y(), v.z());
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : in.triangles) {
    triangles.emplace_back(static_cast<unsigned>(t[0]), static_cast<unsigned>(t[1]),
                           static_cast<unsigned>(t[2]));
  }
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3d, openvdb::Vec3I> mesh(points,
                                                                                        triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  const int flags = in.closed ? 0 : openvdb::tools::UNSIGNED_DISTANCE_FIELD;
  const auto reach = static_cast<float>(kNarrowVoxels);
  openvdb::FloatGrid::Ptr grid;
  time = seconds([&] {
    grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, reach, reach, flags);
  });
  return grid;
}

}  // namespace

void RasterDuel::judge(const Wall& wall, const Band& band) {
  constexpr float kAgree = 1e-5F;
  const auto ours = band.phi->getConstAccessor();
  for (auto it = narrow_->cbeginValueOn(); it; ++it) {
    const openvdb::Coord c = it.getCoord();
    const float phi = std::abs(ours.getValue(c));
    const float other = std::abs(*it);
    if (std::abs(phi - other) < kAgree) continue;
    const double exact = wall.closest({double(c.x()), double(c.y()), double(c.z())}).distance_world;
    peer_worst_ = std::max(peer_worst_, std::abs(double(other) - exact));
    if (exact > kNarrowVoxels) continue;  // not in the band: the peer is wrong about it
    worst_ = std::max(worst_, std::abs(double(phi) - exact));
  }
}

void RasterDuel::repeat() {
  Surface surface;
  Input given = input_;  // not timed, as the peer's copy is not
  wall_.push_back(seconds([&] { surface = std::move(given).surface(); }));
  Band band;
  ours_.push_back(wall_.back() + seconds([&] { band = rasterize(surface, narrow_options()); }));
  double time = 0;
  narrow_ = mesh_to_volume(input_, time);
  peer_.push_back(time);
  if (peer_.size() == 1) judge(*surface.wall, band);
}

double RasterDuel::ours_s() const { return median(ours_); }
double RasterDuel::wall_s() const { return median(wall_); }
double RasterDuel::peer_s() const { return median(peer_); }

}  // namespace vdb_offset::bench
