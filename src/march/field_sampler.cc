// Equations 10 to 12 of Wang, Guibault, Camarero, and their figure 4.

#include "march/field_sampler.h"

#include <cmath>

namespace vdb_offset {

FieldSampler::FieldSampler(const DistanceField& field)
    : accessor_(field.phi->getConstAccessor()),
      voxel_world_(field.voxel_world),
      inverse_voxel_(1 / field.voxel_world),
      flat_(field.flat) {}

/// Value and gradient at one corner of a cell; false outside the band.
bool FieldSampler::load_corner(const openvdb::Coord& at, std::size_t corner) {
  float value = 0;
  if (!accessor_.probeValue(at, value)) return false;
  phi_[corner] = value;
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Coord step;
    step[axis] = 1;
    float below = 0;
    float above = 0;
    const bool has_below = accessor_.probeValue(at - step, below);
    const bool has_above = accessor_.probeValue(at + step, above);
    // One-sided at the band's rim.
    const double lower = has_below ? below : value;
    const double upper = has_above ? above : value;
    const int span = (has_below ? 1 : 0) + (has_above ? 1 : 0);
    gradient_[corner][axis] = span > 0 ? (upper - lower) * inverse_voxel_ / span : 0.0;
  }
  return true;
}

void FieldSampler::load(const openvdb::Coord& cell) {
  cell_ = cell;
  loaded_ = true;
  inside_ = true;
  for (std::size_t c = 0; c < 8 && inside_; ++c) {
    if (flat_ && (c & 1U) != 0) {  // the slice is all there is along z
      phi_[c] = phi_[c - 1];
      gradient_[c] = gradient_[c - 1];
      continue;
    }
    inside_ = load_corner(
        cell.offsetBy((c & 4U) != 0 ? 1 : 0, (c & 2U) != 0 ? 1 : 0, (c & 1U) != 0 ? 1 : 0), c);
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
  for (std::size_t c = 0; c < 8; ++c) {
    const double weight = ((c & 4U) != 0 ? f.x() : 1 - f.x()) *
                          ((c & 2U) != 0 ? f.y() : 1 - f.y()) * ((c & 1U) != 0 ? f.z() : 1 - f.z());
    sample.phi_world += weight * phi_[c];
    sample.gradient += weight * gradient_[c];
  }
  return sample;
}

}  // namespace vdb_offset
