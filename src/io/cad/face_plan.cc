#include "io/cad/face_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/cad/face_grid.h"

namespace vdb_offset::cad {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kCorner = 30 * kDegree;      // what turns more is a corner
constexpr double kReentrant = -20 * kDegree;  // beyond: no grid line ends at such a corner
constexpr double kShortSide = 0.2;            // of the others: it is across from a point

double length_of(const Side& side, const SharedEdges& edges) {
  double length = 0;
  for (const EdgeUse& use : side) length += use.is_pole() ? 0 : edges[use.edge].length_world;
  return length;
}

/// The sides between the uses that `corners` says end at one.
std::vector<Side> sides_between(const std::vector<EdgeUse>& loop,
                                const std::vector<bool>& corners) {
  const auto first = static_cast<std::size_t>(std::ranges::find(corners, true) - corners.begin());
  std::vector<Side> sides(1);
  for (std::size_t n = 1; n <= loop.size(); ++n) {
    const std::size_t k = (first + n) % loop.size();
    sides.back().push_back(loop[k]);
    if (corners[k] && n < loop.size()) sides.emplace_back();
  }
  return sides;
}

/// A third corner for a loop of two: where edges meet nearest to the middle of the longer side.
bool add_far_corner(std::vector<Side>& sides, const SharedEdges& edges) {
  const double lengths[2] = {length_of(sides[0], edges), length_of(sides[1], edges)};
  const int longer = lengths[1] > lengths[0] ? 1 : 0;
  if (lengths[1 - longer] > kShortSide * lengths[longer]) return false;
  const Side side = sides[static_cast<std::size_t>(longer)];
  std::size_t best = 0;
  double best_off = 0.25 * lengths[longer];
  double length = 0;
  for (std::size_t k = 0; k + 1 < side.size(); ++k) {
    length += length_of({side[k]}, edges);
    const double off = std::abs(length - 0.5 * lengths[longer]);
    if (off < best_off) {
      best_off = off;
      best = k + 1;
    }
  }
  if (best == 0) return false;
  const auto cut = side.begin() + static_cast<std::ptrdiff_t>(best);
  sides = {Side(cut, side.end()), sides[static_cast<std::size_t>(1 - longer)],
           Side(side.begin(), cut)};
  return true;
}

/// Turns three sides so that the second is the shortest.
void shortest_second(std::vector<Side>& sides, const SharedEdges& edges) {
  const auto shortest =
      std::ranges::min_element(sides, {}, [&](const Side& side) { return length_of(side, edges); });
  std::ranges::rotate(sides, shortest);
  std::ranges::rotate(sides, sides.end() - 1);
}

Plan plan_three(std::vector<Side> sides, const SharedEdges& edges) {
  shortest_second(sides, edges);
  const double longest = std::max(length_of(sides[0], edges), length_of(sides[2], edges));
  const bool is_wedge = length_of(sides[1], edges) < kShortSide * longest;
  return {is_wedge ? Shape::Wedge : Shape::Midpoint, std::move(sides)};
}

Plan plan_loop(const std::vector<EdgeUse>& loop, const std::vector<double>& turn,
               const SharedEdges& edges) {
  std::vector<bool> corners(loop.size());
  for (std::size_t k = 0; k < loop.size(); ++k) corners[k] = turn[k] > kCorner;
  auto count = std::ranges::count(corners, true);
  // Four edges make four sides, though one of their corners is a little one.
  const auto is_some_corner = [](double t) { return t > kCorner / 3; };
  if (loop.size() == 4 && count == 3 && std::ranges::all_of(turn, is_some_corner)) {
    corners.assign(4, true);
    count = 4;
  }
  if (count == 0) return {Shape::Disc, {loop}};
  std::vector<Side> sides = sides_between(loop, corners);
  if (count == 4) return {Shape::Quad, std::move(sides)};
  if (count == 2 && add_far_corner(sides, edges)) return {Shape::Wedge, std::move(sides)};
  if (count <= 2) {
    Side all;
    for (const Side& side : sides) all.insert(all.end(), side.begin(), side.end());
    return {Shape::Disc, {std::move(all)}};
  }
  if (count == 3) return plan_three(std::move(sides), edges);
  return count == 5 ? Plan{Shape::Midpoint, std::move(sides)} : Plan{};
}

/// The lines of samples around a patch of four sides.
Borders sampled_borders(const Face& face, const Plan& plan, const SharedEdges& edges) {
  const Border right = face.sampled(plan.sides[1], edges);
  const Border bottom = face.sampled(plan.sides[0], edges);
  const Border top = face.sampled(plan.sides[2], edges).reversed();
  if (plan.shape == Shape::Quad) {
    return {bottom, right, top, face.sampled(plan.sides[3], edges).reversed()};
  }
  return {bottom, right, top, face.straight(bottom, 0, top, 0, 1)};
}

/// Most cells that one of the lines between two sides asks for.
int asked_across(const Face& face, const Blend& blend, bool along_i, const CadOptions& options) {
  constexpr int kSteps = 64;
  double most = 0;
  for (const double across : {0.25, 0.5, 0.75}) {
    Vec3List line;
    for (int k = 0; k <= kSteps; ++k) {
      const double along = double(k) / kSteps;
      line.push_back(
          face.plane.point_world(along_i ? blend.at(along, across) : blend.at(across, along)));
    }
    most = std::max(most, cells_asked(line, options).back());
  }
  constexpr double kMost = 1e5;
  return static_cast<int>(std::ceil(std::min(most, kMost) - 0.01));
}

/// Adds cells where they are longest.
void raise(const Side& side, int wanted, SharedEdges& edges) {
  int missing = wanted - cells_of(side, edges);
  const auto length = [&](const EdgeUse& use) {
    return use.is_pole() ? -1 : edges[use.edge].length_world / edges[use.edge].cells;
  };
  for (; missing > 0; --missing) {
    const auto longest = std::ranges::max_element(side, {}, length);
    if (longest->is_pole()) return;
    // Most of a large number at once, for a side of one edge.
    const int step = side.size() == 1 ? missing : 1;
    edges[longest->edge].cells += step;
    missing -= step - 1;
  }
}

bool equal_sides(const Side& a, const Side& b, SharedEdges& edges) {
  if (a.empty() || b.empty() || is_point(a) || is_point(b)) return false;
  const int cells = std::max(cells_of(a, edges), cells_of(b, edges));
  const bool is_equal = cells_of(a, edges) == cells_of(b, edges);
  raise(a, cells, edges);
  raise(b, cells, edges);
  return !is_equal;
}

/// Midpoint subdivision: an even sum, and cells on both sides of each cut.
bool settle_midpoint(const Plan& plan, SharedEdges& edges) {
  int sum = 0;
  for (const Side& side : plan.sides) sum += cells_of(side, edges);
  const auto fewest = std::ranges::min_element(
      plan.sides, {}, [&](const Side& side) { return cells_of(side, edges); });
  if (sum % 2 != 0) {
    raise(*fewest, cells_of(*fewest, edges) + 1, edges);
    return true;
  }
  for (std::size_t k = 0; k < plan.sides.size(); ++k) {
    const int before = cells_before_cut(plan, k, edges);
    if (before >= 1) continue;
    raise(*fewest, cells_of(*fewest, edges) + 2, edges);
    return true;
  }
  return false;
}

/// Makes one face's counts fit its shape; whether any was changed.
bool settle_face(const Plan& plan, SharedEdges& edges) {
  const auto& sides = plan.sides;
  switch (plan.shape) {
    case Shape::Quad: {
      const bool changed = equal_sides(sides[0], sides[2], edges);
      return equal_sides(sides[1], sides[3], edges) || changed;
    }
    case Shape::Wedge:
      return equal_sides(sides[0], sides[2], edges);
    case Shape::Ring:
      return equal_sides(sides[0], sides[1], edges);
    case Shape::Midpoint:
      return settle_midpoint(plan, edges);
    case Shape::Disc: {
      constexpr int kFewest = 8;
      const int cells = cells_of(sides[0], edges);
      const int wanted = std::max(kFewest, cells + cells % 2);
      raise(sides[0], wanted, edges);
      return wanted != cells;
    }
    case Shape::Triangles:
      break;
  }
  return false;
}

}  // namespace

Plan plan_face(const Face& face, const SharedEdges& edges) {
  if (face.loops.empty() || face.loops.size() > 2) return {};
  const std::vector<double> turn = turns(face, face.loops.front(), edges);
  if (face.loops.size() == 2) {
    std::vector<double> all = turns(face, face.loops.back(), edges);
    all.insert(all.end(), turn.begin(), turn.end());
    const bool is_smooth = std::ranges::all_of(all, [](double t) { return std::abs(t) < kCorner; });
    return is_smooth ? Plan{Shape::Ring, face.loops} : Plan{};
  }
  if (std::ranges::any_of(turn, [](double t) { return t < kReentrant; })) return {};
  return plan_loop(face.loops.front(), turn, edges);
}

int cells_before_cut(const Plan& plan, std::size_t k, const SharedEdges& edges) {
  const std::size_t count = plan.sides.size();
  int sum = 0;
  for (std::size_t m = 0; m < count; ++m) {
    const int cells = cells_of(plan.sides[(k + 2 * m) % count], edges);
    sum += m % 2 == 0 ? cells : -cells;
  }
  return sum / 2;
}

void settle_cells(const std::vector<Face>& faces, std::vector<Plan>& plans, SharedEdges& edges,
                  const CadOptions& options) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (plans[f].shape != Shape::Quad && plans[f].shape != Shape::Wedge) continue;
    const Borders borders = sampled_borders(faces[f], plans[f], edges);
    const Blend blend(borders);
    const int along_i = asked_across(faces[f], blend, true, options);
    const int along_j = asked_across(faces[f], blend, false, options);
    const bool is_pole_i = is_point(plans[f].sides[0]);
    plans[f].pole_cells = std::max(1, is_pole_i ? along_i : along_j);
    for (const std::size_t side : {0UL, 2UL}) raise(plans[f].sides[side], along_i, edges);
    raise(plans[f].sides[1], along_j, edges);
    if (plans[f].shape == Shape::Quad) raise(plans[f].sides[3], along_j, edges);
  }
  constexpr int kRounds = 1000;
  constexpr int kTooMany = 1'000'000;
  bool changed = true;
  for (int round = 0; round < kRounds && changed; ++round) {
    changed = false;
    for (const Plan& plan : plans) changed = settle_face(plan, edges) || changed;
    for (Plan& plan : plans) {
      const bool is_far = std::ranges::any_of(
          plan.sides, [&](const Side& side) { return cells_of(side, edges) > kTooMany; });
      if (is_far) plan = {};
    }
  }
  if (!changed) return;
  for (Plan& plan : plans) {
    if (settle_face(plan, edges)) plan = {};
  }
}

}  // namespace vdb_offset::cad
