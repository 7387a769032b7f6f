#include "surface/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <ranges>
#include <utility>

#include "core/parallel.h"
#include "core/sets.h"
#include "surface/facing_sides.h"
#include "surface/point_tree.h"
#include "surface/single_edges.h"

namespace vdb_offset {

namespace {

struct Points {
  Vec3List position;
  std::vector<double> spacing;  // infinite where every edge at the point is collapsed
  std::vector<int> body = {};   // empty: all are of one
};

constexpr double kRounding = 1e-11;  // of the size
constexpr double kSingle = 3e-7;     // of it: some units in the last place of single precision

/// Below this points are one: poles off by it are collapsed, and bodies given twice are doubled.
double rounding_of(const Patches& patches) {
  Box box;
  for (const Patch& patch : patches) {
    for (const Vec3& p : patch.points_world) box.add(p);
  }
  return kRounding * box.size();
}

/// What numbers of a file are rounded in proportion to: the size, or, where all are single ones,
/// the farthest from 0.
double scale_of_rounding(const Patch& patch) {
  Box box;
  bool is_single = true;
  for (const Vec3& p : patch.points_world) {
    box.add(p);
    is_single = is_single && p == p.cast<float>().cast<double>();
  }
  if (!is_single) return box.size();
  return std::max({box.size(), box.lo.cwiseAbs().maxCoeff(), box.hi.cwiseAbs().maxCoeff()});
}

/// The points of sides that are poles but for what single precision rounds.
std::vector<char> on_poles(const Patch& patch) {
  std::vector<char> is_on(patch.points_world.size(), 0);
  if (!patch.is_grid() || patch.nj < 2) return is_on;
  const double most = kSingle * scale_of_rounding(patch);
  const int ni = patch.ni;
  const int nj = patch.nj;
  const auto mark = [&](int first, int step, int count) {
    Box side;
    const auto at = [&](int n) { return static_cast<std::size_t>(first + n * step); };
    for (int n = 0; n < count; ++n) side.add(patch.points_world[at(n)]);
    if (side.size() > most) return;
    for (int n = 0; n < count; ++n) is_on[at(n)] = 1;
  };
  mark(0, 1, ni);
  mark(ni * (nj - 1), 1, ni);
  mark(0, ni, nj);
  mark(ni - 1, ni, nj);
  return is_on;
}

void add_spacing(const Patch& patch, double rounding, double* spacing) {
  const std::vector<char> is_on_pole = on_poles(patch);
  const auto is_collapsed = [&](int a, int b) {
    return is_on_pole[static_cast<std::size_t>(a)] != 0 &&
           is_on_pole[static_cast<std::size_t>(b)] != 0;
  };
  const auto shorten = [&](int a, int b) {
    const double length = (patch.points_world[static_cast<std::size_t>(a)] -
                           patch.points_world[static_cast<std::size_t>(b)])
                              .norm();
    if (length <= rounding || is_collapsed(a, b)) return;
    for (const int p : {a, b}) spacing[p] = std::min(spacing[p], length);
  };
  // Edges of polygons' rims, which are not known yet, are those of faces.
  for (const std::array<int, 4>& face : patch.faces) {
    for (std::size_t c = 0; c < 4; ++c) shorten(face[c], face[(c + 1) % 4]);
  }
  if (patch.is_grid()) for_edges(patch, shorten);
}

Points gather(const Patches& patches, double rounding) {
  Points points;
  for (const Patch& patch : patches) {
    const std::size_t first = points.position.size();
    points.position.insert(points.position.end(), patch.points_world.begin(),
                           patch.points_world.end());
    points.spacing.resize(points.position.size(), std::numeric_limits<double>::infinity());
    points.body.resize(points.position.size(), patch.body);
    add_spacing(patch, rounding, points.spacing.data() + first);
  }
  return points;
}

using Pair = std::array<int, 2>;

/// Points of a body that are equal bit for bit share an entry: the search below then never sees a
/// crowd at one place.
struct Places {
  double distance(const Pair& pair) const {
    return (position[static_cast<std::size_t>(pair[0])] -
            position[static_cast<std::size_t>(pair[1])])
        .norm();
  }

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

/// Places nearer to each other than both allow, those of each pair by number.
std::vector<Pair> near_pairs(const Places& places, double part, const Progress& progress) {
  std::vector<Pair> pairs;
  if (!(part > 0)) return pairs;
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
      if (other <= p || places.body[other] != places.body[p]) continue;
      const double reach2 = part * places.spacing[other];
      if (distance2 > reach2 * reach2) continue;
      pairs.push_back({static_cast<int>(p), static_cast<int>(other)});
    }
  }
  return pairs;
}

using Cell = FacingSides::Cell;

/// Cells by places.
std::vector<Cell> cells_of(const Patches& patches, const Places& places) {
  std::vector<Cell> cells;
  std::size_t first = 0;
  for (const Patch& patch : patches) {
    for_cells(patch, [&](Cell cell) {
      for (int& corner : cell) corner = places.of_point[first + static_cast<std::size_t>(corner)];
      cells.push_back(cell);
    });
    first += patch.points_world.size();
  }
  return cells;
}

/// Of each place whether the surface has an end there: it is on an edge of one cell alone.
std::vector<bool> ends_of(const std::vector<Cell>& cells, std::size_t places) {
  CellEdges edges;
  for (const Cell& cell : cells) edges.add(cell);
  std::vector<bool> ends(places, false);
  for (const Pair& edge : std::move(edges).single()) {
    for (const int p : edge) ends[static_cast<std::size_t>(p)] = true;
  }
  return ends;
}

/// Leaves out two sides of something thin: places that the surface goes on around, as it does not
/// where patches end beside each other, and rims whose cells face each other.
void keep_sides_apart(const Patches& patches, const Places& places, std::vector<Pair>& pairs) {
  if (pairs.empty()) return;
  std::vector<Cell> cells = cells_of(patches, places);
  const std::vector<bool> ends = ends_of(cells, places.position.size());
  const FacingSides sides(std::move(cells), places.position, FacingSides::Oriented::No);
  std::vector<char> apart(pairs.size(), 0);
  parallel::for_ranges(pairs.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const Pair& pair = pairs[n];
      const bool is_rim =
          std::ranges::any_of(pair, [&](int p) { return ends[static_cast<std::size_t>(p)]; });
      apart[n] = !is_rim || sides.face_each_other(pair[0], pair[1]) ? 1 : 0;
    }
  });
  std::size_t n = 0;
  std::erase_if(pairs, [&](const Pair&) { return apart[n++] != 0; });
}

/// Sets of points: the lowest one stands for what becomes one node.
Sets join(const Places& places, const std::vector<Pair>& pairs) {
  Sets sets(places.of_point.size());
  for (const auto& [a, b] : pairs) {
    sets.join(places.first_point[static_cast<std::size_t>(a)],
              places.first_point[static_cast<std::size_t>(b)]);
  }
  return sets;
}

/// One place of those that pairs join, where the lowest point of them is.
Places joined(const Places& places, const std::vector<Pair>& pairs) {
  Sets sets = join(places, pairs);
  std::vector<int> place_of(places.of_point.size(), -1);  // of the lowest point
  Places out;
  out.of_point.resize(places.of_point.size());
  for (std::size_t point = 0; point < places.of_point.size(); ++point) {
    const auto from = static_cast<std::size_t>(places.of_point[point]);
    const int lowest = sets.root(places.first_point[from]);
    int& place = place_of[static_cast<std::size_t>(lowest)];
    if (place < 0) {
      place = static_cast<int>(out.position.size());
      out.position.push_back(places.position[from]);
      out.spacing.push_back(places.spacing[from]);
      out.first_point.push_back(lowest);
      out.body.push_back(places.body[from]);
    }
    double& spacing = out.spacing[static_cast<std::size_t>(place)];
    spacing = std::min(spacing, places.spacing[from]);
    out.of_point[point] = place;
  }
  return out;
}

/// Joins places nearer to each other than noise where one of them is an end yet, whichever sides
/// they are of: until then cells do not tell where the surface has ends. The other pairs, of the
/// places then.
void join_noise(const Patches& patches, double part, double rounding, Places& places,
                std::vector<Pair>& pairs) {
  if (pairs.empty()) return;
  double single = 0;
  for (const Patch& patch : patches) {
    single = std::max(single, kSingle * scale_of_rounding(patch));
  }
  const std::vector<bool> ends = ends_of(cells_of(patches, places), places.position.size());
  std::vector<Pair> noise;
  std::ranges::copy_if(pairs, std::back_inserter(noise), [&](const Pair& pair) {
    const double spacing = std::min(places.spacing[static_cast<std::size_t>(pair[0])],
                                    places.spacing[static_cast<std::size_t>(pair[1])]);
    const double most = std::max(kWeldNoise * part * spacing, std::min(single, part * spacing));
    const bool is_end =
        std::ranges::any_of(pair, [&](int p) { return ends[static_cast<std::size_t>(p)]; });
    return places.distance(pair) <= (is_end ? std::max(rounding, most) : rounding);
  });
  if (noise.empty()) return;
  Places fewer = joined(places, noise);
  for (Pair& pair : pairs) {
    for (int& place : pair) {
      const int point = places.first_point[static_cast<std::size_t>(place)];
      place = fewer.of_point[static_cast<std::size_t>(point)];
    }
    if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
  }
  std::erase_if(pairs, [](const Pair& pair) { return pair[0] == pair[1]; });
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  places = std::move(fewer);
}

}  // namespace

std::vector<int> weld_points(const Vec3List& points, const std::vector<double>& spacing,
                             double part, const KeepApart& keeps_apart, const Progress& progress) {
  const Places places = find_places({points, spacing});
  std::vector<Pair> pairs = near_pairs(places, part, progress);
  const auto point = [&](int place) { return places.first_point[static_cast<std::size_t>(place)]; };
  if (keeps_apart) {
    std::erase_if(pairs,
                  [&](const Pair& pair) { return keeps_apart(point(pair[0]), point(pair[1])); });
  }
  Sets sets = join(places, pairs);
  std::vector<int> lowest;
  lowest.reserve(points.size());
  for (const int place : places.of_point) {
    lowest.push_back(sets.root(places.first_point[static_cast<std::size_t>(place)]));
  }
  return lowest;
}

Welding weld(const Patches& patches, double part, const Progress& progress) {
  const double rounding = rounding_of(patches);
  const Points points = gather(patches, rounding);
  Places places = find_places(points);
  std::vector<Pair> pairs = near_pairs(places, part, progress);
  join_noise(patches, part, rounding, places, pairs);
  keep_sides_apart(patches, places, pairs);
  Sets sets = join(places, pairs);

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
