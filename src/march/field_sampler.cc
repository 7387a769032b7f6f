// Equations 10 to 12 of Wang, Guibault, Camarero, and their figure 4.

#include "march/field_sampler.h"

#include <cmath>

namespace vdb_offset {

FieldSampler::FieldSampler(const DistanceField& field)
    : accessor_(field.phi->getConstAccessor()),
      voxel_world_(field.voxel_world),
      inverse_voxel_(1 / field.voxel_world),
      flat_(field.flat) {}

FieldSampler::Block FieldSampler::find(const openvdb::Coord& cell) {
  constexpr int kLog2 = Leaf::LOG2DIM;
  Block block;
  const openvdb::Coord lo = cell.offsetBy(-1);
  unsigned across = 0;  // the axes along which the block reaches into a next tile
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int at = lo[static_cast<int>(axis)];
    for (unsigned k = 0; k < 4; ++k) {
      const int index = at + static_cast<int>(k);
      const unsigned bit = 4U >> axis;
      block.tile[axis][k] = (index >> kLog2) == (at >> kLog2) ? 0 : bit;
      const unsigned local = static_cast<unsigned>(index) & (Leaf::DIM - 1);
      block.offset[axis][k] = local << (kLog2 * static_cast<int>(2 - axis));
    }
    across |= block.tile[axis][3];
  }
  for (unsigned t = 0; t < 8; ++t) {
    if ((t & ~across) != 0) continue;
    const openvdb::Coord in = lo.offsetBy((t & 4U) != 0 ? 3 : 0, (t & 2U) != 0 ? 3 : 0,  //
                                          (t & 1U) != 0 ? 3 : 0);
    block.leaf[t] = accessor_.probeConstLeaf(in);
    block.dense = block.dense && block.leaf[t] != nullptr && block.leaf[t]->isDense();
  }
  return block;
}

/// Value and gradient at one corner of a cell; false outside the band.
bool FieldSampler::load_corner(const Block& block, std::size_t corner) {
  std::array<unsigned, 3> at{(corner & 4U) != 0 ? 2U : 1U, (corner & 2U) != 0 ? 2U : 1U,
                             (corner & 1U) != 0 ? 2U : 1U};
  const auto probe = [&](double& value) {
    const Leaf* const leaf =
        block.leaf[block.tile[0][at[0]] | block.tile[1][at[1]] | block.tile[2][at[2]]];
    const unsigned offset =
        block.offset[0][at[0]] + block.offset[1][at[1]] + block.offset[2][at[2]];
    if (leaf == nullptr || !leaf->isValueOn(offset)) return false;
    value = leaf->getValue(offset);
    return true;
  };
  double value = 0;
  if (!probe(value)) return false;
  corner_[corner][3] = value;
  for (unsigned axis = 0; axis < 3; ++axis) {
    // One-sided at the band's rim.
    double lower = value;
    double upper = value;
    --at[axis];
    const bool has_below = probe(lower);
    at[axis] += 2;
    const bool has_above = probe(upper);
    --at[axis];
    const int span = (has_below ? 1 : 0) + (has_above ? 1 : 0);
    corner_[corner][axis] = span > 0 ? (upper - lower) * inverse_voxel_ / span : 0.0;
  }
  return true;
}

/// The same for all corners, where no voxel can be missing.
void FieldSampler::load_dense(const Block& block) {
  std::array<const float*, 8> values{};
  for (std::size_t t = 0; t < 8; ++t) {
    if (block.leaf[t] != nullptr) values[t] = block.leaf[t]->buffer().data();
  }
  const auto value = [&](unsigned x, unsigned y, unsigned z) -> double {
    const float* const tile = values[block.tile[0][x] | block.tile[1][y] | block.tile[2][z]];
    return tile[block.offset[0][x] + block.offset[1][y] + block.offset[2][z]];
  };
  const double scale = 0.5 * inverse_voxel_;
  for (unsigned c = 0; c < 8; ++c) {
    const unsigned x = 1 + (c >> 2U);
    const unsigned y = 1 + (c >> 1U & 1U);
    const unsigned z = 1 + (c & 1U);
    corner_[c] = {scale * (value(x + 1, y, z) - value(x - 1, y, z)),
                  scale * (value(x, y + 1, z) - value(x, y - 1, z)),
                  scale * (value(x, y, z + 1) - value(x, y, z - 1)), value(x, y, z)};
  }
}

void FieldSampler::load(const openvdb::Coord& cell) {
  cell_ = cell;
  loaded_ = true;
  inside_ = true;
  const Block block = find(cell);
  if (block.dense && !flat_) return load_dense(block);
  for (std::size_t c = 0; c < 8 && inside_; ++c) {
    if (flat_ && (c & 1U) != 0) {  // the slice is all there is along z
      corner_[c] = corner_[c - 1];
      continue;
    }
    inside_ = load_corner(block, c);
  }
}

FieldSample FieldSampler::at(const Vec3& point_world) {
  const Vec3 index = point_world * inverse_voxel_;
  FieldSample sample;
  if (!(index.cwiseAbs().maxCoeff() < 1e9)) return sample;
  const Vec3 base = index.array().floor();
  const openvdb::Coord cell(static_cast<int>(base.x()), static_cast<int>(base.y()),
                            static_cast<int>(base.z()));
  if (!loaded_ || cell != cell_) load(cell);
  if (!inside_) return sample;
  sample.inside = true;
  const Vec3 f = index - base;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (std::size_t c = 0; c < 8; ++c) {
    const double weight = ((c & 4U) != 0 ? f.x() : 1 - f.x()) *
                          ((c & 2U) != 0 ? f.y() : 1 - f.y()) * ((c & 1U) != 0 ? f.z() : 1 - f.z());
    sum += weight * corner_[c];
  }
  sample.gradient = sum.head<3>();
  sample.phi_world = sum[3];
  return sample;
}

}  // namespace vdb_offset
