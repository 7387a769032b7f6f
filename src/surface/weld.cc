#include "surface/weld.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/parallel.h"
#include "core/sets.h"
#include "surface/point_tree.h"

namespace vdb_offset {

namespace {

struct Points {
  Vec3List position;
  std::vector<double> spacing;  // infinite where every edge at the point is collapsed
  std::vector<int> body = {};   // empty: all are of one
};

void add_spacing(const Patch& patch, std::size_t first, std::vector<double>& spacing) {
  const auto shorten = [&](int a, int b) {
    const double length = (patch.points_world[static_cast<std::size_t>(a)] -
                           patch.points_world[static_cast<std::size_t>(b)])
                              .norm();
    if (length <= 0) return;
    for (const int p : {a, b}) {
      double& s = spacing[first + static_cast<std::size_t>(p)];
      s = std::min(s, length);
    }
  };
  // Edges of polygons' rims, which are not known yet, are those of faces.
  for (const std::array<int, 4>& face : patch.faces) {
    for (std::size_t c = 0; c < 4; ++c) shorten(face[c], face[(c + 1) % 4]);
  }
  if (patch.is_grid()) for_edges(patch, shorten);
}

Points gather(const Patches& patches) {
  Points points;
  for (const Patch& patch : patches) {
    const std::size_t first = points.position.size();
    points.position.insert(points.position.end(), patch.points_world.begin(),
                           patch.points_world.end());
    points.spacing.resize(points.position.size(), std::numeric_limits<double>::infinity());
    points.body.resize(points.position.size(), patch.body);
    add_spacing(patch, first, points.spacing);
  }
  return points;
}

/// Points of a body that are equal bit for bit share an entry: the search below then never sees a
/// crowd at one place.
struct Places {
  Vec3List position;
  std::vector<double> spacing;   // shortest of the points at the place
  std::vector<int> first_point;  // lowest index among the points at the place
  std::vector<int> body;
  std::vector<int> of_point;
};

Places find_places(const Points& points) {
  std::vector<int> order(points.position.size());
  std::iota(order.begin(), order.end(), 0);
  const auto point = [&](int index) -> const Vec3& {
    return points.position[static_cast<std::size_t>(index)];
  };
  const auto body = [&](int index) {
    return points.body.empty() ? 0 : points.body[static_cast<std::size_t>(index)];
  };
  parallel::sort(order.begin(), order.end(), [&](int a, int b) {
    if (body(a) != body(b)) return body(a) < body(b);
    const Vec3& p = point(a);
    const Vec3& q = point(b);
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  });
  Places places;
  places.of_point.resize(order.size());
  for (const int index : order) {
    if (places.position.empty() || places.position.back() != point(index) ||
        places.body.back() != body(index)) {
      places.position.push_back(point(index));
      places.body.push_back(body(index));
      places.spacing.push_back(std::numeric_limits<double>::infinity());
      places.first_point.push_back(index);
    }
    double& spacing = places.spacing.back();
    spacing = std::min(spacing, points.spacing[static_cast<std::size_t>(index)]);
    places.of_point[static_cast<std::size_t>(index)] = static_cast<int>(places.position.size()) - 1;
  }
  return places;
}

/// Sets of points: the lowest one stands for what becomes one node.
Sets join_near(const Places& places, double part, const Progress& progress) {
  Sets sets(places.of_point.size());
  if (!(part > 0)) return sets;
  const PointTree tree(places.position);
  std::vector<PointTree::Found> found;
  for (std::size_t p = 0; p < places.position.size(); ++p) {
    if ((p & 0xfff) == 0) {
      progress.update("surface",
                      static_cast<double>(p) / static_cast<double>(places.position.size()));
    }
    const double reach = part * places.spacing[p];
    if (!(reach > 0) || !std::isfinite(reach)) continue;
    tree.within(places.position[p], reach, found);
    for (const auto& [other, distance2] : found) {
      if (places.body[other] != places.body[p]) continue;
      const double reach2 = part * places.spacing[other];
      if (distance2 > reach2 * reach2) continue;
      sets.join(places.first_point[p], places.first_point[other]);
    }
  }
  return sets;
}

}  // namespace

std::vector<int> weld_points(const Vec3List& points, const std::vector<double>& spacing,
                             double part, const Progress& progress) {
  const Places places = find_places({points, spacing});
  Sets sets = join_near(places, part, progress);
  std::vector<int> lowest;
  lowest.reserve(points.size());
  for (const int place : places.of_point) {
    lowest.push_back(sets.root(places.first_point[static_cast<std::size_t>(place)]));
  }
  return lowest;
}

Welding weld(const Patches& patches, double part, const Progress& progress) {
  const Points points = gather(patches);
  const Places places = find_places(points);
  Sets sets = join_near(places, part, progress);

  Welding result;
  std::vector<int> node_of_lowest(places.of_point.size(), -1);
  std::size_t point = 0;
  for (const Patch& patch : patches) {
    std::vector<int>& nodes = result.patch_nodes.emplace_back();
    for (const Vec3& p : patch.points_world) {
      const auto place = static_cast<std::size_t>(places.of_point[point++]);
      int& node = node_of_lowest[static_cast<std::size_t>(sets.root(places.first_point[place]))];
      if (node < 0) {
        node = static_cast<int>(result.nodes_world.size());
        result.nodes_world.push_back(p);
      }
      nodes.push_back(node);
      const double moved = (p - result.nodes_world[static_cast<std::size_t>(node)]).norm();
      result.moved_max_world = std::max(result.moved_max_world, moved);
    }
  }
  return result;
}

}  // namespace vdb_offset
