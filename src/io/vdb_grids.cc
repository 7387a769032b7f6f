#include "io/vdb_grids.h"

#include <openvdb/tree/LeafManager.h>

#include <cmath>

namespace vdb_offset {

namespace {

/// A neighbour's distance, on the side of `centre`. Signed distance is 1-Lipschitz: a larger step
/// between neighbours is the jump of sign beyond a free edge, not the wall.
float same_branch(float neighbour, float centre, float voxel) {
  if (std::abs(neighbour - centre) <= 1.5F * voxel) return neighbour;
  return std::copysign(neighbour, centre);
}

openvdb::Vec3s direction(const openvdb::FloatGrid::ConstAccessor& phi, const openvdb::Coord& at,
                         float voxel) {
  const float centre = phi.getValue(at);
  openvdb::Vec3s gradient(0);
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Coord step(0);
    step[axis] = 1;
    float below = centre;
    float above = centre;
    const bool has_below = phi.probeValue(at - step, below);
    const bool has_above = phi.probeValue(at + step, above);
    below = has_below ? same_branch(below, centre, voxel) : centre;
    above = has_above ? same_branch(above, centre, voxel) : centre;
    gradient[axis] = (above - below) * (has_below && has_above ? 0.5F : 1.0F);
  }
  const float length = gradient.length();
  return length > 0 ? gradient / length : openvdb::Vec3s(0);
}

/// A grid on the active voxels of phi; `make(leaf)` fills a leaf.
template <typename Grid, typename Fill>
typename Grid::Ptr on_voxels_of(const DistanceField& field,
                                const typename Grid::ValueType& background, const Fill& fill) {
  using Tree = typename Grid::TreeType;
  const auto tree = std::make_shared<Tree>(field.phi->tree(), background, openvdb::TopologyCopy());
  openvdb::tree::LeafManager<Tree> leaves(*tree);
  leaves.foreach ([&](typename Tree::LeafNodeType& leaf, std::size_t) { fill(leaf); });
  return Grid::create(tree);
}

}  // namespace

openvdb::Vec3SGrid::Ptr normal_grid(const DistanceField& field, float sign) {
  const auto voxel = static_cast<float>(field.voxel_world);
  const auto fill = [&](openvdb::Vec3STree::LeafNodeType& leaf) {
    const auto phi = field.phi->getConstAccessor();
    for (auto it = leaf.beginValueOn(); it; ++it) {
      it.setValue(sign * direction(phi, it.getCoord(), voxel));
    }
  };
  auto grid = on_voxels_of<openvdb::Vec3SGrid>(field, openvdb::Vec3s(0), fill);
  grid->setVectorType(openvdb::VEC_COVARIANT_NORMALIZE);
  return grid;
}

openvdb::Int32Grid::Ptr feature_grid(const DistanceField& field, const Surface& surface) {
  const Wall& wall = *surface.wall;
  const double h = field.voxel_world;
  const auto fill = [&](openvdb::Int32Tree::LeafNodeType& leaf) {
    int last = -1;
    for (auto it = leaf.beginValueOn(); it; ++it) {
      const openvdb::Coord c = it.getCoord();
      const Vec3 p = h * Vec3(c.x(), c.y(), c.z());
      last = wall.closest_from(last, p).triangle;
      // A quad's triangles begin at its centre, and centres follow the nodes in the quads' order.
      const int centre = wall.triangles()[static_cast<std::size_t>(last)][0];
      it.setValue(centre - surface.wall_nodes);
    }
  };
  return on_voxels_of<openvdb::Int32Grid>(field, -1, fill);
}

}  // namespace vdb_offset
