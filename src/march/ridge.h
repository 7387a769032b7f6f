#pragma once

#include <optional>
#include <vector>

#include "march/wall_search.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// A point of the medial axis on a straight line: as far from the one part of the wall as from the
/// other.
struct Ridge {
  double s_world;       ///< length along the line
  double height_world;  ///< true distance there
  Vec3 point_world;
  Vec3 away_near;  ///< unit, from the foot on the part that the line comes from
  Vec3 away_far;   ///< unit, from the foot on the other part

  /// d phi / d s along the medial axis, where it rises fastest: sin a in a wedge of inner angle 2a.
  double rise() const { return 0.5 * (away_near + away_far).norm(); }
};

struct Line {
  Vec3 from_world;
  Vec3 direction;  ///< unit
  double length_world;
};

/// The first ridge that a line crosses, to 1e-3 of its length and of the distance at its start;
/// none where what is nearest turns by less than 2 acos(kRidgeRise), as on a smooth wall, or where
/// it turns without a jump. Cost about 12 distance queries.
std::optional<Ridge> find_ridge(WallSearch& search, const Line& line);

/// A ridge that rises faster than this is no obstacle to a column.
constexpr double kRidgeRise = 0.98;
/// Cosine of the angle within which what is nearest turns on one front.
constexpr double kSameFront = 2 * kRidgeRise * kRidgeRise - 1;

/// Whether two walls face each other at the ridge: going down the ridge the distance has a least
/// value away from the wall. In a concave corner it falls to zero instead, or, where the corner is
/// rounded, the ridge ends. Cost about 50 distance queries.
bool faces(WallSearch& search, const Ridge& ridge);

/// A way up a ridge.
struct Climb {
  std::vector<Ridge> ridges;  ///< in steps
  bool meets = false;         ///< a third part of the wall is as near at the last one, and faces
  bool opens = false;         ///< there is no obstacle behind the last one
};

/// Up a concave corner's ridge, the steepest way, in steps of a length at most, to where a third
/// part of the wall is as near, to 1e-3 of a step, to a height, or to where it opens into what is
/// no ridge; nothing where it ends before. Cost about 20 distance queries a step.
std::optional<Climb> climb(WallSearch& search, const Ridge& ridge, double step_world,
                           double height_world);
/// The ridge that a point is on or within a length of, going towards the foot that is not nearest;
/// `up` is the way along it.
std::optional<Ridge> ridge_beside(WallSearch& search, const Line& up);

}  // namespace vdb_offset
