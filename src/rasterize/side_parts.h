#pragma once

#include <memory>
#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A ball of places: its centre, how far the wall is from there, its radius; world units.
struct SideBall {
  Vec3 centre;
  double distance_world;
  double radius_world;
};

/// Closed bodies whose sides do not agree in the space between them: one beside a tank whose
/// outside is behind, one in another. There the side of a place changes where another body becomes
/// nearest, far from any wall.
///
/// Parts are sets of bodies that do agree. Where there are several, they are walls of their own:
/// making them costs as much as the whole wall.
class SideParts {
 public:
  explicit SideParts(const Surface& surface);

  /// There is but one part: sides change at the wall alone.
  bool agree() const { return parts_.empty(); }

  /// All places of a ball that no wall crosses have the side of its centre.
  bool has_one_side(const SideBall& ball) const;

  /// All places of a ball have their nearest place on the same part.
  bool has_one_part(const SideBall& ball) const;

 private:
  std::vector<std::unique_ptr<const Wall>> parts_;
};

}  // namespace vdb_offset
