#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset::bench {

/// The narrow band that both sides rasterize, voxels to either side.
inline constexpr int kNarrowVoxels = 3;

/// Triangles in voxels: the lattice's edge is 1.
struct Input {
  std::string name;
  Vec3List vertices;
  std::vector<Wall::Triangle> triangles;
  bool closed = false;

  /// The same as a surface of ours; builds the hierarchy. An rvalue gives its lists away.
  Surface surface() const& {
    Input copy = *this;
    return std::move(copy).surface();
  }
  Surface surface() &&;
};

/// An input that is made when it is its turn, and the bands that are swept on it, voxels.
struct InputCase {
  std::string name;
  std::vector<int> bands;
  std::function<Input()> make;
};

/// Those of the comparison. `bwb`: its PLOT3D file.
std::vector<InputCase> input_cases(const std::string& bwb);

/// A sphere of 161,376 triangles about a point off the lattice.
Input sphere(double radius_voxels);

}  // namespace vdb_offset::bench
