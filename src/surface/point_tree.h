#pragma once

#include <cstdint>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Finds points near others; keeps a reference to them.
class PointTree {
 public:
  using Found = std::pair<std::uint32_t, double>;  ///< index, squared distance

  explicit PointTree(const Vec3List& points)
      : cloud_{points}, tree_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(8)) {}
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// Those that are nearer than `reach`, nearest first.
  void within(const Vec3& place, double reach, std::vector<Found>& found) const {
    found.clear();
    tree_.radiusSearch(place.data(), reach * reach, found, {});
  }

 private:
  /// The names are nanoflann's.
  struct Cloud {
    const Vec3List& points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t index, std::size_t axis) const {
      return points[index][static_cast<Eigen::Index>(axis)];
    }
    template <class BoundingBox>
    bool kdtree_get_bbox(BoundingBox& /*box*/) const {
      return false;
    }
  };

  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3> tree_;
};

}  // namespace vdb_offset
