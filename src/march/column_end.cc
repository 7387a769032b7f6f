// Where a column ends for what its own wall does not tell: a facing wall's front, an internal
// surface.

#include <algorithm>

#include "march/column.h"
#include "march/ridge.h"
#include "vdb_offset/march/room_at.h"

namespace vdb_offset {

namespace {

// Cosine of the angle within which a column goes the way of the exact distance.
constexpr double kSameWay = 0.99;
// A straight line whose height is less than its length by this part is a gradient line.
constexpr double kGradientLine = 1e-4;
constexpr double kTouch = 0.5;    // voxels beyond the end that the grid's bend may hide
constexpr double kBeside = 2;     // voxels by which the grid's column strays from a corner's ridge
constexpr std::size_t kOnto = 4;  // steps over which it is led onto that
constexpr double kSharp = 0.2;    // rise on the bisector of an inner angle of 23 degrees
constexpr int kMostCorners = 3;   // that a line may cross before a facing wall's front
constexpr double kHairOfPath = 1e-13;  // within which a crossing is located
constexpr double kTurn = 2e-3;         // voxels within which a column is led back over a turn

Vec3 away_from(const WallPoint& nearest, const Vec3& point) {
  return (point - nearest.point_world) / nearest.distance_world;
}

}  // namespace

/// The gradient line of the true distance that a column keeps to: straight from its node where that
/// is one, else straight away from the wall that is nearest at a length before the grid's field
/// bends. In a concave corner, where neither is, the way of the path.
Line ColumnTracer::gradient_line(const ColumnPath& path, double from) {
  const ColumnPath::Knot& node = path.knot(0);
  const Vec3 straight = hold(node.point_world + from * node.tangent);
  if (search_.nearest(straight).distance_world > (1 - kGradientLine) * from) {
    return {straight, node.tangent, 0};
  }
  const Vec3 start = point(path, from);
  const Vec3 away = away_from(search_.nearest(start), start);
  const Vec3 tangent = path.derivative(from).normalized();
  return {start, steer(start, away.dot(tangent) > kSameWay ? away : tangent), 0};
}

/// The end of a column that goes straight on from a length to a ridge: there, or at the distance.
ColumnEnd ColumnTracer::end_at(const Ridge& ridge, double from, ColumnPath& path) {
  const ColumnPath::Knot start{from, path.point(from), path.derivative(from).normalized()};
  while (path.size() > 1 && path.back().s_world > from) path.drop_last();
  if (path.back().s_world < from) path.add(start);
  const Vec3 way = hold(ridge.point_world) - start.point_world;
  if (ridge.s_world > 0) path.add({from + way.norm(), hold(ridge.point_world), way.normalized()});
  const double last = path.back().s_world;
  ColumnEnd end{Stop::Collided, last, ridge.height_world, 1};
  if (ridge.height_world >= distance_world_) arrives(path, from, last, end);
  end.meets_world = ridge.height_world;
  return end;
}

/// Back from a turn of phi, located to parts of a voxel, to where the own wall is the nearest.
void ColumnTracer::step_back(const ColumnPath& path, double from, ColumnEnd& end) {
  const auto away_at = [&](double s) {
    const Vec3 place = point(path, s);
    return away_from(search_.nearest(place), place);
  };
  const Vec3 home = away_at(from);
  const bool in_corner = home.dot(path.derivative(from).normalized()) < kSameWay;
  const auto is_home = [&](double s) { return away_at(s).dot(home) > kSameFront; };
  if (in_corner || is_home(end.s_world)) return;
  double hi = end.s_world;
  const double tolerance = kTurn * std::min(voxel_world_, hi - from);
  for (end.s_world = from; hi - end.s_world > tolerance;) {
    const double s = 0.5 * (end.s_world + hi);
    (is_home(s) ? end.s_world : hi) = s;
  }
  end.height_world = exact(path, end.s_world).height_world;
}

/// The ridge of the concave corner that the column goes along at a length, if it does.
std::optional<Ridge> ColumnTracer::own_corner(const ColumnPath& path, double s_world) {
  const Line up{point(path, s_world), path.derivative(s_world).normalized(),
                kBeside * voxel_world_};
  const auto ridge = ridge_beside(search_, up);
  if (!ridge || faces(search_, *ridge)) return std::nullopt;
  const Vec3 way = ridge->away_near + ridge->away_far;
  return way.dot(up.direction) > kSameFront * way.norm() ? ridge : std::nullopt;
}

/// The ridge beside a column of a corner too sharp for the grid's field.
std::optional<Ridge> ColumnTracer::sharp_corner(const ColumnPath& path, double s_world) {
  const Vec3 place = point(path, s_world);
  const Line away{place, away_from(search_.nearest(place), place), kBeside * voxel_world_};
  const auto ridge = find_ridge(search_, away);
  if (!ridge || ridge->rise() > kSharp || faces(search_, *ridge)) return std::nullopt;
  return ridge;
}

/// The grid's field bends before the end of a column in a concave corner too, and a straight line
/// leaves the corner's ridge where that is curved: so it goes up the ridge itself to where a third
/// wall is as near.
void ColumnTracer::climb_corner(ColumnPath& path, ColumnEnd& end) {
  const auto from = [&](double back) {
    return std::max(end.s_world - back * voxel_world_, 0.5 * end.s_world);
  };
  const auto up = [&](const Ridge& ridge) {
    return climb(search_, ridge, step_world_, distance_world_ / (1 - gap_margin_));
  };
  for (const double back : {2 * kBend, kBend, 0.5 * kBend}) {
    const auto corner = own_corner(path, from(back));
    if (!corner) continue;
    if (const auto way = up(*corner)) go_up(*way, from(back), path, end);
    return;
  }
  if (end.meets_world > 0) return;
  const auto corner = sharp_corner(path, from(kBend));
  const auto way = corner ? up(*corner) : std::nullopt;
  if (way && way->opens) go_up(*way, from(kBend), path, end);
}

/// Leaves the path at a length for the way up a ridge.
void ColumnTracer::go_up(const Climb& way, double from, ColumnPath& path, ColumnEnd& end) {
  while (path.size() > 1 && path.back().s_world > from) path.drop_last();
  const std::size_t last = way.ridges.size() - 1;
  for (std::size_t n = std::min(last, kOnto); n <= last; ++n) {
    const Ridge& ridge = way.ridges[n];
    const Vec3 to = hold(ridge.point_world);
    const double length = (to - path.back().point_world).norm();
    path.add({path.back().s_world + length, to, (ridge.away_near + ridge.away_far).normalized()});
  }
  const double height = way.ridges.back().height_world;
  end = {Stop::Collided, path.back().s_world, height, 1};
  if (height >= distance_world_) arrives(path, from, end.s_world, end);
  if (way.opens) end = follow(path);
  if (way.meets) end.meets_world = height;
}

/// What else the column meets: a ridge that it crossed since it was last looked at, or that lies
/// beyond its end.
void ColumnTracer::look_ahead(ColumnPath& path, ColumnEnd& end) {
  if (end.meets_world > 0) return;
  const double from = std::max(end.s_world - kBend * voxel_world_, 0.5 * end.s_world);
  if (end.stop == Stop::Collided) return step_back(path, from, end);
  double beyond = kTouch * voxel_world_;
  if (end.stop == Stop::Reached) {
    beyond = std::max(beyond, gap_margin_ / (1 - gap_margin_) * distance_world_);
  }
  Line line = gradient_line(path, from);
  line.length_world = end.s_world - from + beyond;
  const auto ridge = find_ridge(search_, line);
  if (!ridge || !faces(search_, *ridge)) return;
  const Vec3 last = point(path, end.s_world);
  const Vec3 away = away_from(search_.nearest(last), last);
  if (away.dot(ridge->away_far) > away.dot(ridge->away_near)) {
    end = end_at(*ridge, from, path);
  } else if (end.stop == Stop::Reached) {
    end.meets_world = ridge->height_world;
  }
}

/// Where a column leaves a surface that its node lies on, for the side that it goes to: 0 for all
/// others, the path's end where it never does.
double ColumnTracer::leaves(const ColumnPath& path, const Boundary& internal, double last) const {
  if (!internal.holds(path.knot(0).point_world)) return 0;
  double s = 1e-12 * last;
  while (s < last && internal.holds(point(path, s))) s *= 2;
  return std::min(s, last);
}

/// Where the path first goes through an internal surface, between two lengths: by chords, ever
/// shorter ones, so that it is the path that does, not a line beside it.
std::optional<double> ColumnTracer::crosses(const ColumnPath& path, const Boundary& internal,
                                            double from, double to) const {
  const double least = kHairOfPath * to;
  std::optional<double> found = internal.crossing(point(path, from), point(path, to));
  while (found && to - from > least) {
    const double middle = 0.5 * (from + to);
    const Vec3 between = point(path, middle);
    if (const auto sooner = internal.crossing(point(path, from), between)) {
      found = sooner;
      to = middle;
    } else {
      found = internal.crossing(between, point(path, to));
      from = middle;
    }
  }
  return found ? std::optional(from + *found * (to - from)) : std::nullopt;
}

/// The first internal surface that the path crosses is its end.
void ColumnTracer::end_on_internal(const ColumnPath& path, ColumnEnd& end) {
  const std::vector<Boundary>& list = boundaries_->list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    if (!list[b].is_internal() || (on_ >> b & 1U) != 0) continue;
    double lo = leaves(path, list[b], end.s_world);
    for (std::size_t k = 1; k < path.size() && lo < end.s_world; ++k) {
      const double hi = std::min(path.knot(k).s_world, end.s_world);
      if (hi <= lo) continue;
      if (const auto s = crosses(path, list[b], lo, hi)) {
        end = {Stop::Internal, *s, exact(path, *s).height_world, 1, static_cast<int>(b)};
        break;
      }
      lo = hi;
    }
  }
}

namespace {

/// From a point away from what is nearest, as far as it is within a distance of that; nothing on
/// the wall.
std::optional<Line> line_away(WallSearch& search, const Vec3& point_world, double reach_world) {
  const WallPoint nearest = search.nearest(point_world);
  if (!(nearest.distance_world > 0)) return std::nullopt;
  return Line{point_world, away_from(nearest, point_world), reach_world - nearest.distance_world};
}

}  // namespace

std::optional<double> room_at(const Surface& surface, const Vec3& point_world, double reach_world) {
  WallSearch search(*surface.wall, surface.boundaries.get());
  auto line = line_away(search, point_world, reach_world);
  if (!line) return std::nullopt;
  const double length = line->length_world;
  for (int n = 0; n < kMostCorners && line->length_world > 0; ++n) {
    const auto ridge = find_ridge(search, *line);
    if (!ridge) return std::nullopt;
    if (faces(search, *ridge)) return ridge->height_world;
    const double on = ridge->s_world + 2e-3 * length;  // over the bisector of a concave corner
    line->from_world += on * line->direction;
    line->length_world -= on;
  }
  return std::nullopt;
}

std::optional<double> bisector_at(const Surface& surface, const Vec3& point_world, double rise,
                                  double reach_world) {
  WallSearch search(*surface.wall, surface.boundaries.get());
  const auto line = line_away(search, point_world, reach_world);
  const auto ridge = line ? find_ridge(search, *line) : std::nullopt;
  if (!ridge || ridge->rise() >= rise || faces(search, *ridge)) return std::nullopt;
  return ridge->height_world;
}

}  // namespace vdb_offset
