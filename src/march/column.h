#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "march/column_path.h"
#include "march/field_sampler.h"
#include "march/ridge.h"
#include "march/wall_search.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Where a column starts: its node, the way out, and how fast the distance rises there.
struct ColumnStart {
  Vec3 point_world;
  Vec3 direction;                  ///< unit, averaged over the cells at the node
  double spacing_world;            ///< shortest wall edge at the node
  double side;                     ///< +1 along the wall's normals, -1 against
  std::span<const int> triangles;  ///< of the wall, around the node
  std::span<const Vec3> edges;     ///< of the wall's grid, from the node on
  BoundarySet boundaries = 0;      ///< that the node lies on: the column stays within them
  bool in_fan = false;             ///< the direction is the column's own, not an average
  /// Across `direction`: where the column is to lean, as long as the tangent of the angle.
  Vec3 lean = Vec3::Zero();
};

/// The end of a traced column; the path's last knot may lie beyond.
struct ColumnEnd {
  Stop stop = Stop::LeftBand;
  double s_world = 0;
  double height_world = 0;   ///< true distance there
  double slope_at_wall = 1;  ///< d height / d s at s = 0
  int internal = -1;         ///< the internal surface that it ends on
  /// True distance at which it meets the front of a facing wall, or would, going straight on, as
  /// far as the gap margin makes it look; 0: it does not.
  double meets_world = 0;
  bool is_straight = false;  ///< a straight line whose length is the true distance all along
};

/// Before a ridge that is nearer than this many voxels the grid's field bends.
constexpr double kBend = 5;

/// Traces columns along grad phi; one for each thread.
class ColumnTracer {
 public:
  ColumnTracer(const Surface& surface, const DistanceField& field, const MarchOptions& options);

  /// Fill `path` from the wall to where the column stops, at `distance_world` at the latest.
  ColumnEnd trace(const ColumnStart& node, double distance_world, ColumnPath& path);

  /// The end of a traced column at a lesser height.
  ColumnEnd cut(const ColumnPath& path, const ColumnEnd& whole, double height_world);

  /// Point of the path at a length, held within the boundaries.
  Vec3 point(const ColumnPath& path, double s_world) const;
  /// The same of a straight column.
  Vec3 straight_point(const ColumnPath& path, double s_world) const {
    return keep(path.knot(0).point_world + s_world * path.knot(0).tangent);
  }

  /// True distance and its derivative along the path.
  struct Height {
    double height_world;
    double slope;
  };
  Height exact(const ColumnPath& path, double s_world);
  /// The same to the wall around the column's foot alone: never too small.
  Height own(const ColumnPath& path, double s_world) const;
  /// True if the column's own part of the wall is the nearest at its end and half way: then it is
  /// all along, but for what could hide within the column's length minus its height.
  bool stays_home(const ColumnPath& path, const ColumnEnd& end);

 private:
  struct State {
    double phi_world = 0;  // the grid's, times side; the true one near the wall
    bool is_exact = false;
    bool inside = false;
  };

  Vec3 direction(const Vec3& point_world, State* state = nullptr);
  Vec3 blend(const FieldSample& sample, const WallPoint& nearest, const Vec3& point_world) const;
  std::pair<double, double> slope_at_wall(const ColumnStart& start);
  Vec3 chord(const ColumnStart& start);
  bool goes_straight(const ColumnStart& start, ColumnPath& path);
  double start_path(const ColumnStart& start, ColumnPath& path);
  bool step(ColumnPath& path, double length_world, State& state);
  bool arrives(const ColumnPath& path, double from, double to, ColumnEnd& end);
  ColumnEnd locate_turn(ColumnPath& path);
  bool collides(ColumnPath& path, ColumnEnd& end);
  Line gradient_line(const ColumnPath& path, double from);
  void step_back(const ColumnPath& path, double from, ColumnEnd& end);
  void look_ahead(ColumnPath& path, ColumnEnd& end);
  ColumnEnd end_at(const Ridge& ridge, double from, ColumnPath& path);
  std::optional<Ridge> own_corner(const ColumnPath& path, double s_world);
  std::optional<Ridge> sharp_corner(const ColumnPath& path, double s_world);
  void go_up(const Climb& way, double from, ColumnPath& path, ColumnEnd& end);
  void climb_corner(ColumnPath& path, ColumnEnd& end);
  ColumnEnd highest(const ColumnPath& path, double from, double to);
  ColumnEnd follow(ColumnPath& path);

  double leaves(const ColumnPath& path, const Boundary& internal, double last) const;
  std::optional<double> crosses(const ColumnPath& path, const Boundary& internal, double from,
                                double to) const;
  void end_on_internal(const ColumnPath& path, ColumnEnd& end);
  Vec3 hold(const Vec3& point_world) const;
  Vec3 keep(const Vec3& point_world) const;
  Vec3 steer(const Vec3& point_world, const Vec3& direction) const;
  Vec3 leaning(const Vec3& direction) const;
  Vec3 leaning_at(const Vec3& point_world, const Vec3& direction);

  const Boundaries* boundaries_;
  BoundarySet on_ = 0;
  WallSearch search_;
  FieldSampler sampler_;
  double distance_world_;
  double voxel_world_;
  double step_world_;
  double gap_margin_;
  bool may_be_straight_;  // no boundary but planes: its mirror images are a wall like others
  double side_ = 1;
  Vec3 lean_ = Vec3::Zero();     // of the column, as long as the sine of the angle
  Vec3 heading_ = Vec3::Zero();  // of the field at the path's end
  struct Off {
    double s_world;
    Vec3 off;
  };
  std::vector<Off> off_;  // of the field's column from a straight line
  struct Checked {
    double s_world;
    double height_world;
  } checked_{0, 0};        // where the path was last looked at
  double local_rise_ = 1;  // of phi along the concave corner that the column runs into
};

}  // namespace vdb_offset
