#include "sweep/ghosts.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/parallel.h"

namespace vdb_offset {

namespace {

// A ghost lies within sqrt(6) voxels of a voxel in the domain, and so does its image; the corners
// of the cell around that reach sqrt(3) further.
constexpr double kRimVoxels = 4.3;
// So far inside an oblique boundary the steps of the lattice along it are not felt.
constexpr double kInsideVoxels = 6;
constexpr double kOnLattice = 1e-6;  // an image nearer to a voxel than this, in voxels, is it
constexpr double kBeyond = 1e-6;     // as rasterizing has it: less is on the boundary

using Mask = openvdb::MaskTree;

Vec3 position(const openvdb::Coord& c, double h) { return h * Vec3(c.x(), c.y(), c.z()); }

/// Voxels of the band that lie near a boundary.
Mask rim_of(const openvdb::FloatTree& tree, const Band& band) {
  const double h = band.voxel_world;
  const double width = (kRimVoxels + (needs_ghosts(*band.boundaries) ? kInsideVoxels : 0.0)) * h;
  const double half = 0.5 * std::sqrt(3.0) * 7 * h;
  Mask rim;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const Vec3 centre = position(leaf->origin(), h).array() + 3.5 * h;
    if (band.boundaries->side(centre) > half + width) continue;
    auto* mask = static_cast<Mask::LeafNodeType*>(nullptr);
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      if (band.boundaries->side(position(voxel.getCoord(), h)) > width) continue;
      if (mask == nullptr) mask = rim.touchLeaf(leaf->origin());
      mask->setValueOn(voxel.pos());
    }
  }
  return rim;
}

template <typename Tree, typename Body>
void for_leaves(Tree& tree, const Body& body) {
  std::vector<typename Tree::LeafNodeType*> leaves;
  tree.getNodes(leaves);
  parallel::for_ranges(leaves.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) body(n, *leaves[n]);
  });
}

/// What the field holds beyond the exact distance, on the rim.
openvdb::FloatTree errors_on(const Mask& rim, const openvdb::FloatTree& tree, const Band& band) {
  openvdb::FloatTree errors(rim, 0.0F, 0.0F, openvdb::TopologyCopy());
  for_leaves(errors, [&](std::size_t, openvdb::FloatTree::LeafNodeType& leaf) {
    const auto* const phi = tree.probeConstLeaf(leaf.origin());
    int last = -1;
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      const Vec3 p = position(voxel.getCoord(), band.voxel_world);
      const WallPoint nearest = band.wall->closest_from(last, p);
      last = nearest.triangle;
      const double size = std::abs(static_cast<double>(phi->getValue(voxel.pos())));
      voxel.setValue(static_cast<float>(size - nearest.distance_world));
    }
  });
  return errors;
}

/// Values beyond the boundaries; one for each thread.
class Mirror {
 public:
  Mirror(const openvdb::FloatTree& tree, const openvdb::FloatTree& errors, const Band& band)
      : phi_(tree), errors_(errors), band_(band), oblique_(needs_ghosts(*band.boundaries)) {}

  std::optional<float> value(const openvdb::Coord& ghost) {
    const Vec3 p = position(ghost, band_.voxel_world);
    if (band_.boundaries->side(p) >= -kBeyond * band_.voxel_world) return {};
    const Vec3 image = band_.boundaries->fold(p).point_world();
    const Vec3 index = image / band_.voxel_world;
    const Vec3 rounded = index.array().round();
    if ((index - rounded).cwiseAbs().maxCoeff() < kOnLattice) {
      float phi = 0;
      const bool known = phi_.probeValue(coord(rounded), phi);
      return known ? std::optional<float>(phi) : std::nullopt;
    }
    const WallPoint nearest = band_.wall->closest_from(last_, image);
    last_ = nearest.triangle;
    const std::optional<Estimate> error = error_at(image);
    if (!error) return {};
    const double side = error->front ? 1.0 : nearest.side(image);
    return static_cast<float>(side * std::max(0.0, nearest.distance_world + error->value));
  }

 private:
  static openvdb::Coord coord(const Vec3& index) {
    return {static_cast<int>(index.x()), static_cast<int>(index.y()), static_cast<int>(index.z())};
  }

  struct Estimate {
    double value;
    bool front;  // all around it lies before the wall
  };

  /// The field's error at an image, or inside of it where the boundary is oblique.
  std::optional<Estimate> error_at(const Vec3& image) {
    if (oblique_) {
      const Plane tangent = band_.boundaries->nearest(image).tangent(image);
      const double depth = tangent.normal.dot(image - tangent.point_world);
      const double inward = std::max(0.0, kInsideVoxels * band_.voxel_world - depth);
      const auto inside = interpolate((image + inward * tangent.normal) / band_.voxel_world);
      const auto here = interpolate(image / band_.voxel_world);
      if (inside) return Estimate{inside->value, here && here->front};
    }
    return interpolate(image / band_.voxel_world);
  }

  /// Of the voxels around a place, in voxels, that are in the domain; nothing if none is.
  std::optional<Estimate> interpolate(const Vec3& index) {
    const Vec3 base = index.array().floor();
    const Vec3 f = index - base;
    double weights = 0;
    double sum = 0;
    bool front = true;
    for (unsigned c = 0; c < 8; ++c) {
      const openvdb::Coord at = coord(base).offsetBy(c >> 2U & 1U, c >> 1U & 1U, c & 1U);
      float error = 0;
      if (!errors_.probeValue(at, error)) continue;
      const double weight = ((c & 4U) != 0 ? f.x() : 1 - f.x()) *
                                ((c & 2U) != 0 ? f.y() : 1 - f.y()) *
                                ((c & 1U) != 0 ? f.z() : 1 - f.z()) +
                            1e-6;
      weights += weight;
      sum += weight * static_cast<double>(error);
      front = front && phi_.getValue(at) >= 0;
    }
    if (weights == 0) return {};
    return Estimate{sum / weights, front};
  }

  openvdb::tree::ValueAccessor<const openvdb::FloatTree> phi_;
  openvdb::tree::ValueAccessor<const openvdb::FloatTree> errors_;
  const Band& band_;
  bool oblique_;
  int last_ = -1;
};

}  // namespace

bool needs_ghosts(const Boundaries& boundaries) {
  return std::any_of(boundaries.list().begin(), boundaries.list().end(), [](const Boundary& b) {
    if (b.is_internal()) return false;
    return !b.is_plane() || b.plane().normal.cwiseAbs().maxCoeff() != 1;
  });
}

Ghosts find_ghosts(const openvdb::FloatTree& tree, const Band& band) {
  Mask beyond = rim_of(tree, band);
  const openvdb::FloatTree errors = errors_on(beyond, tree, band);
  openvdb::tools::dilateActiveValues(beyond, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                     openvdb::tools::IGNORE_TILES);
  openvdb::tools::dilateActiveValues(beyond, 1, openvdb::tools::NN_FACE,
                                     openvdb::tools::IGNORE_TILES);
  beyond.topologyDifference(tree);
  Ghosts ghosts(beyond.leafCount());
  for_leaves(beyond, [&](std::size_t n, const Mask::LeafNodeType& leaf) {
    Mirror mirror(tree, errors, band);
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
      const std::optional<float> phi = mirror.value(voxel.getCoord());
      if (phi) ghosts[n].push_back({voxel.getCoord(), *phi});
    }
  });
  return ghosts;
}

void add_ghosts(const Ghosts& ghosts, openvdb::FloatTree& tree) {
  for (const std::vector<Ghost>& some : ghosts) {
    if (some.empty()) continue;
    openvdb::FloatTree::LeafNodeType& leaf = *tree.touchLeaf(some.front().at);
    for (const Ghost& ghost : some) leaf.setValueOn(ghost.at, ghost.phi);
  }
}

}  // namespace vdb_offset
