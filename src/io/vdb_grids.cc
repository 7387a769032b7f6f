#include "io/vdb_grids.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <vector>

#include "core/parallel.h"

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

/// A grid on the active voxels of phi; `fill(leaf)` fills a leaf.
template <typename Grid, typename Fill>
typename Grid::Ptr on_voxels_of(const DistanceField& field,
                                const typename Grid::ValueType& background,
                                const Progress& progress, const Fill& fill) {
  using Tree = typename Grid::TreeType;
  const auto tree = std::make_shared<Tree>(field.phi->tree(), background, openvdb::TopologyCopy());
  openvdb::tree::LeafManager<Tree> leaves(*tree);
  parallel::for_ranges({progress, "io"}, leaves.leafCount(), 16,
                       [&](std::size_t begin, std::size_t end) {
                         for (std::size_t n = begin; n < end; ++n) fill(leaves.leaf(n));
                       });
  return Grid::create(tree);
}

/// A triangle of the wall by its corners, without the quad's centre that it may have.
struct NumberedTriangle {
  Wall::Triangle nodes;
  int number;
};

/// The number of each cell, in the order of the patches.
std::vector<int> cell_numbers(const Surface& surface,
                              const std::vector<std::vector<int>>& face_numbers) {
  std::vector<int> numbers;
  int next = 0;
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    if (p < face_numbers.size() && face_numbers[p].size() == surface.patches[p].cells()) {
      numbers.insert(numbers.end(), face_numbers[p].begin(), face_numbers[p].end());
      next = std::max(next, 1 + *std::ranges::max_element(face_numbers[p]));
    } else {
      const auto cells = static_cast<int>(surface.patches[p].cells());
      for (int c = 0; c < cells; ++c) numbers.push_back(next++);
    }
  }
  return numbers;
}

/// The number of the cell that each triangle of the wall is of. Those of quads begin at its centre,
/// and centres stand behind the nodes in the order of the cells that have one.
class TriangleNumbers {
 public:
  TriangleNumbers(const Surface& surface, const std::vector<std::vector<int>>& face_numbers)
      : surface_(surface), of_cell_(cell_numbers(surface, face_numbers)) {
    std::size_t cell = 0;
    for (std::size_t p = 0; p < surface.patches.size(); ++p) add(p, cell);
    const auto less = [](const NumberedTriangle& a, const NumberedTriangle& b) {
      return std::tie(a.nodes, a.number) < std::tie(b.nodes, b.number);
    };
    parallel::sort(triangles_.begin(), triangles_.end(), less);
    for (const Wall::Triangle& t : surface.wall->triangles()) numbers_.push_back(find(t));
  }

  int of(int triangle) const { return numbers_[static_cast<std::size_t>(triangle)]; }

 private:
  void add(std::size_t p, std::size_t& cell) {
    const Patch& patch = surface_.patches[p];
    for_cells(patch, [&](const std::array<int, 4>& corner) {
      const int number = of_cell_[cell++];
      if (patch.is_grid() || corner[2] != corner[3]) {
        quads_.push_back(number);
        return;
      }
      const auto node = [&](std::size_t c) {
        return surface_.patch_nodes[p][static_cast<std::size_t>(corner[c])];
      };
      triangles_.push_back({{node(0), node(1), node(2)}, number});
    });
  }

  int find(const Wall::Triangle& t) const {
    if (t[0] >= surface_.wall_nodes)
      return quads_[static_cast<std::size_t>(t[0] - surface_.wall_nodes)];
    return std::ranges::lower_bound(triangles_, t, {}, &NumberedTriangle::nodes)->number;
  }

  const Surface& surface_;
  std::vector<int> of_cell_;
  std::vector<int> quads_;                   // numbers of cells with a centre
  std::vector<NumberedTriangle> triangles_;  // cells without
  std::vector<int> numbers_;                 // of the wall's triangles
};

}  // namespace

openvdb::Vec3SGrid::Ptr normal_grid(const DistanceField& field, float sign,
                                    const Progress& progress) {
  const auto voxel = static_cast<float>(field.voxel_world);
  const auto fill = [&](openvdb::Vec3STree::LeafNodeType& leaf) {
    const auto phi = field.phi->getConstAccessor();
    for (auto it = leaf.beginValueOn(); it; ++it) {
      it.setValue(sign * direction(phi, it.getCoord(), voxel));
    }
  };
  auto grid = on_voxels_of<openvdb::Vec3SGrid>(field, openvdb::Vec3s(0), progress, fill);
  grid->setVectorType(openvdb::VEC_COVARIANT_NORMALIZE);
  return grid;
}

openvdb::Int32Grid::Ptr feature_grid(const DistanceField& field, const VdbWriteOptions& options,
                                     const Progress& progress) {
  const TriangleNumbers numbers(*options.feature_of, options.face_numbers);
  const Wall& wall = *options.feature_of->wall;
  const double h = field.voxel_world;
  const auto fill = [&](openvdb::Int32Tree::LeafNodeType& leaf) {
    int last = -1;
    for (auto it = leaf.beginValueOn(); it; ++it) {
      const openvdb::Coord c = it.getCoord();
      const Vec3 p = h * Vec3(c.x(), c.y(), c.z());
      last = wall.closest_from(last, p).triangle;
      it.setValue(numbers.of(last));
    }
  };
  return on_voxels_of<openvdb::Int32Grid>(field, -1, progress, fill);
}

}  // namespace vdb_offset
