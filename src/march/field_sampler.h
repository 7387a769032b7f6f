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
  using Leaf = openvdb::FloatTree::LeafNodeType;
  /// The cell's voxels and their neighbours, four along each axis: in which tile, and where there.
  struct Block {
    std::array<const Leaf*, 8> leaf{};
    std::array<std::array<unsigned, 4>, 3> tile{};
    std::array<std::array<unsigned, 4>, 3> offset{};
    bool dense = true;  ///< all tiles are there, and full
  };

  void load(const openvdb::Coord& cell);
  Block find(const openvdb::Coord& cell);
  void load_dense(const Block& block);
  bool load_corner(const Block& block, std::size_t corner);

  openvdb::FloatGrid::ConstAccessor accessor_;
  double voxel_world_;
  double inverse_voxel_;
  openvdb::Coord cell_;
  bool flat_;
  bool loaded_ = false;
  bool inside_ = false;
  std::array<Eigen::Vector4d, 8> corner_{};  // gradient and phi at the cell's corners, x slowest
};

}  // namespace vdb_offset
