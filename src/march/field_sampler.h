#pragma once

#include <openvdb/openvdb.h>

#include <array>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// phi and its gradient between voxels.
struct FieldSample {
  bool inside = false;  ///< all eight voxels around the point are in the band
  double phi_world = 0;
  Vec3 gradient =
      Vec3::Zero();  ///< central differences at voxels, trilinear between; not normalised
};

/// Reads the field at points; one for each thread. Neighbouring queries in one cell of voxels are
/// cheap.
class FieldSampler {
 public:
  explicit FieldSampler(const DistanceField& field);

  FieldSample at(const Vec3& point_world);
  double voxel_world() const { return voxel_world_; }

 private:
  void load(const openvdb::Coord& cell);
  bool load_corner(const openvdb::Coord& at, std::size_t corner);

  openvdb::FloatGrid::ConstAccessor accessor_;
  double voxel_world_;
  double inverse_voxel_;
  openvdb::Coord cell_;
  bool flat_;
  bool loaded_ = false;
  bool inside_ = false;
  std::array<double, 8> phi_{};  // at the cell's corners, x slowest
  std::array<Vec3, 8> gradient_{};
};

}  // namespace vdb_offset
