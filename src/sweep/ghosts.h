#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

/// A voxel beyond a boundary, with what its mirror image in the domain holds.
struct Ghost {
  openvdb::Coord at;
  float phi;
};
using Ghosts = std::vector<std::vector<Ghost>>;  ///< those of a leaf together

/// Whether voxels in the domain have upwind neighbours beyond the boundaries: where these stand
/// oblique to the axes. Such a band is to be swept again, with the ghosts as seeds.
bool needs_ghosts(const Boundaries& boundaries);

/// The voxels beyond the band's boundaries that the gradient in the domain reads, two deep.
///
/// In       `tree`: the field in the domain alone, solved.
/// Accuracy where the mirror maps voxels to voxels the same bits; elsewhere the exact distance of
///          the image, plus the field's error, which is smooth where the distance has a kink. With
///          oblique boundaries the error is taken some voxels inside, where their steps are not
///          felt.
/// Cost     an exact distance for each of about eight layers of voxels at the boundary.
Ghosts find_ghosts(const openvdb::FloatTree& tree, const Band& band);

/// Makes them active voxels of a tree.
void add_ghosts(const Ghosts& ghosts, openvdb::FloatTree& tree);

}  // namespace vdb_offset
