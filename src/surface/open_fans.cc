// Sharp edges cut the cells around a node into sectors. Each sector gets a node of its own, the row
// between two sectors the fan's; patches' points then follow their sectors, and the fans' sides are
// sides like any others.

#include "surface/open_fans.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "surface/sharp_edges.h"
#include "surface/stars.h"
#include "surface/topology.h"

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Turns a unit vector by a part of the angle to another, which is not opposite.
Vec3 turned(const Vec3& from, const Vec3& to, double part) {
  const Vec3 axis = from.cross(to);
  const double sine = axis.norm();
  if (!(sine > 0)) return from;
  const double angle = part * std::atan2(sine, from.dot(to));
  return (std::cos(angle) * from + std::sin(angle) / sine * axis.cross(from)).normalized();
}

/// The way out in the middle of a corner, between the middles of its three arcs.
Vec3 middle_of(const Vec3List& normals) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t n = 0; n < 3; ++n) sum += turned(normals[n], normals[(n + 1) % 3], 0.5);
  return sum.normalized();
}

class Opener {
 public:
  Opener(Surface& surface, int columns, std::vector<int>& component)
      : surface_(surface),
        columns_(columns),
        component_(component),
        topology_(build_topology(surface.patches, surface.patch_nodes, surface.node_boundaries)),
        stars_(find_stars(surface, topology_, columns % 2 == 0)),
        sector_nodes_(stars_.list.size()),
        rows_(stars_.list.size()) {}

  void open() {
    if (stars_.list.empty()) return;
    for (const Patch& patch : surface_.patches) used_names_.insert(patch.name);
    surface_.fans.direction.assign(surface_.nodes_world.size(), Vec3::Zero());
    patches_before_ = surface_.patches.size();
    list_fans();
    for (std::size_t n = 0; n < stars_.list.size(); ++n) open_sectors(n);
    for (const Fan& fan : fans_) add_fan(fan);
    for (std::size_t n = 0; n < stars_.list.size(); ++n) {
      if (stars_.list[n].opening == Opening::Corner) add_corner(n);
    }
    surface_.fans.patches = static_cast<int>(surface_.patches.size() - patches_before_);
    if (surface_.fans.patches == 0) surface_.fans.direction.clear();
  }

 private:
  /// A run of grid edges that opens: its nodes by star and the two sectors there.
  struct Place {
    std::size_t star;
    std::size_t left, right;  // sectors
  };
  struct Fan {
    int left_patch, right_patch;
    std::vector<Place> places;
  };

  struct CornerRays {
    std::array<std::size_t, 3> sector{0, 1, 2};
    std::array<std::vector<int>, 3> arc, spoke;
  };

  void list_fans();
  void open_sectors(std::size_t star);
  void add_fan(const Fan& fan);
  void add_corner(std::size_t star);
  CornerRays corner_rays(std::size_t star);
  std::vector<int> corner_nodes(std::size_t star, const CornerRays& rays, std::size_t c);
  int add_node(std::size_t star, const Vec3& direction);
  Vec3 direction(const Star& star, std::array<std::size_t, 2> sectors, double part) const;
  std::vector<int> row(std::size_t star, std::size_t left, std::size_t right);
  void add_patch(Patch patch, std::vector<int> nodes, int beside);
  std::string free_name(const std::string& kind, int number);
  std::size_t sector_at(const Star& star, const PatchPoint& point) const;
  bool is_closed(std::size_t star) const { return stars_.list[star].opening == Opening::Closed; }

  Surface& surface_;
  int columns_;
  std::vector<int>& component_;
  Topology topology_;
  Stars stars_;
  std::vector<Fan> fans_;
  std::vector<std::vector<int>> sector_nodes_;  // of each star
  std::vector<std::map<std::pair<std::size_t, std::size_t>, std::vector<int>>> rows_;
  std::set<std::string> used_names_;
  std::size_t patches_before_ = 0;
};

std::size_t Opener::sector_at(const Star& star, const PatchPoint& point) const {
  for (std::size_t n = 0; n < star.points.size(); ++n) {
    const bool same = star.points[n].patch == point.patch && star.points[n].index == point.index;
    if (same) return star.sector_of[n];
  }
  return 0;
}

/// Maximal parts of runs that are sharp and have an open end. The left side is that on whose left
/// hand it lies, going along the run and seen from outside.
void Opener::list_fans() {
  for (const SharpRun& run : stars_.runs) {
    const bool first_is_left = runs_along(run.edge->first);
    const std::array<int, 2> ends{run.edge->first.patch, run.edge->second.patch};
    const auto place = [&](int s) {
      const auto star = at(stars_.of_node[at(run_node(surface_, run, s))]);
      const auto [a, b] = run_points(surface_, run, s);
      const std::size_t first = sector_at(stars_.list[star], a);
      const std::size_t second = sector_at(stars_.list[star], b);
      return first_is_left ? Place{star, first, second} : Place{star, second, first};
    };
    bool is_open = false;
    for (int s = 0; s < run.edge->first.cells(); ++s) {
      const bool before = is_open;
      is_open = false;
      if (run.sharp[at(s)] == 0) continue;
      const Place from = place(s);
      const Place to = place(s + 1);
      if (is_closed(from.star) && is_closed(to.star)) continue;
      is_open = true;
      if (!before) {
        fans_.push_back({ends[first_is_left ? 0 : 1], ends[first_is_left ? 1 : 0], {from}});
      }
      fans_.back().places.push_back(to);
    }
  }
}

int Opener::add_node(std::size_t star, const Vec3& direction) {
  const int base = stars_.list[star].node;
  const auto node = static_cast<int>(surface_.nodes_world.size());
  surface_.nodes_world.push_back(Vec3(surface_.nodes_world[at(base)]));
  if (!surface_.node_boundaries.empty()) {
    surface_.node_boundaries.push_back(BoundarySet{surface_.node_boundaries[at(base)]});
  }
  surface_.fans.node_at.push_back(base);
  surface_.fans.direction.push_back(direction);
  return node;
}

/// The way out at a part of a row's whole angle, which is smaller near a closed end.
Vec3 Opener::direction(const Star& star, std::array<std::size_t, 2> sectors, double part) const {
  const bool whole = star.opening == Opening::Corner || star.steps >= kFanClosing;
  const double angle = whole ? 1.0 : static_cast<double>(star.steps) / kFanClosing;
  return turned(star.normals[sectors[0]], star.normals[sectors[1]], 0.5 + (part - 0.5) * angle);
}

/// A node for each sector, the wall's own for the first; patches' points follow.
void Opener::open_sectors(std::size_t index) {
  const Star& star = stars_.list[index];
  if (star.opening == Opening::Closed) return;
  std::vector<int>& nodes = sector_nodes_[index];
  for (std::size_t s = 0; s < star.normals.size(); ++s) {
    const Vec3 out =
        star.opening == Opening::Row ? direction(star, {s, 1 - s}, 0) : star.normals[s];
    if (s == 0) surface_.fans.direction[at(star.node)] = out;
    nodes.push_back(s == 0 ? star.node : add_node(index, out));
  }
  for (std::size_t n = 0; n < star.points.size(); ++n) {
    const PatchPoint& point = star.points[n];
    surface_.patch_nodes[at(point.patch)][at(point.index)] = nodes[star.sector_of[n]];
  }
}

/// The N + 1 nodes from one sector to another; at a closed star they are one.
std::vector<int> Opener::row(std::size_t index, std::size_t left, std::size_t right) {
  const Star& star = stars_.list[index];
  const auto count = at(columns_) + 1;
  if (star.opening == Opening::Closed) return std::vector<int>(count, star.node);
  if (left > right) {
    std::vector<int> nodes = row(index, right, left);
    std::reverse(nodes.begin(), nodes.end());
    return nodes;
  }
  std::vector<int>& nodes = rows_[index][{left, right}];
  if (!nodes.empty()) return nodes;
  nodes.push_back(sector_nodes_[index][left]);
  for (int n = 1; n < columns_; ++n) {
    const double part = static_cast<double>(n) / columns_;
    nodes.push_back(add_node(index, direction(star, {left, right}, part)));
  }
  nodes.push_back(sector_nodes_[index][right]);
  return nodes;
}

/// "fan 3"
std::string Opener::free_name(const std::string& kind, int number) {
  std::string name = fmt::format("{} {}", kind, number);
  while (!used_names_.insert(name).second) name += "'";
  return name;
}

void Opener::add_patch(Patch patch, std::vector<int> nodes, int beside) {
  for (const int node : nodes) patch.points_world.push_back(surface_.nodes_world[at(node)]);
  surface_.patches.push_back(std::move(patch));
  surface_.patch_nodes.push_back(std::move(nodes));
  component_.push_back(component_[at(beside)]);
}

void Opener::add_fan(const Fan& fan) {
  Patch patch;
  patch.name = free_name("fan", ++surface_.report.fans);
  const std::string& family = surface_.patches[at(fan.left_patch)].family;
  if (surface_.patches[at(fan.right_patch)].family == family) patch.family = family;
  patch.ni = columns_ + 1;
  patch.nj = static_cast<int>(fan.places.size());
  std::vector<int> nodes;
  for (const Place& place : fan.places) {
    const std::vector<int> across = row(place.star, place.left, place.right);
    nodes.insert(nodes.end(), across.begin(), across.end());
  }
  add_patch(std::move(patch), std::move(nodes), fan.left_patch);
}

/// The arcs between a corner's sectors, counter-clockwise from outside, and the spokes from their
/// middles to the centre.
Opener::CornerRays Opener::corner_rays(std::size_t index) {
  const Star& star = stars_.list[index];
  CornerRays rays;
  if (star.normals[0].cross(star.normals[1]).dot(star.normals[2]) < 0) {
    std::swap(rays.sector[1], rays.sector[2]);
  }
  const int half = columns_ / 2;
  const Vec3 middle = middle_of(star.normals);
  const int centre = add_node(index, middle);
  for (std::size_t c = 0; c < 3; ++c) {
    rays.arc[c] = row(index, rays.sector[c], rays.sector[(c + 1) % 3]);
    std::vector<int>& spoke = rays.spoke[c];
    spoke.push_back(rays.arc[c][at(half)]);
    const Vec3 from = surface_.fans.direction[at(spoke[0])];
    for (int j = 1; j < half; ++j) {
      spoke.push_back(add_node(index, turned(from, middle, static_cast<double>(j) / half)));
    }
    spoke.push_back(centre);
  }
  return rays;
}

/// The nodes of the patch at one sector of a corner, i towards the next sector, j towards the one
/// before.
std::vector<int> Opener::corner_nodes(std::size_t index, const CornerRays& rays, std::size_t c) {
  const int half = columns_ / 2;
  const std::vector<int>& before = rays.arc[(c + 2) % 3];
  std::vector<int> nodes(rays.arc[c].begin(), rays.arc[c].begin() + half + 1);
  for (int j = 1; j < half; ++j) {
    const int left = before[at(columns_ - j)];
    const int right = rays.spoke[c][at(j)];
    const Vec3 from = surface_.fans.direction[at(left)];
    const Vec3 to = surface_.fans.direction[at(right)];
    nodes.push_back(left);
    for (int i = 1; i < half; ++i) {
      nodes.push_back(add_node(index, turned(from, to, static_cast<double>(i) / half)));
    }
    nodes.push_back(right);
  }
  const std::vector<int>& last = rays.spoke[(c + 2) % 3];
  nodes.insert(nodes.end(), last.begin(), last.end());
  return nodes;
}

/// Three patches, one at each sector, that meet in the middle.
void Opener::add_corner(std::size_t index) {
  const Star& star = stars_.list[index];
  const int number = ++surface_.report.fan_corners;
  const CornerRays rays = corner_rays(index);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto point = std::ranges::find(star.sector_of, rays.sector[c]);
    const int beside = star.points[at(static_cast<int>(point - star.sector_of.begin()))].patch;
    Patch patch;
    patch.name = free_name(fmt::format("corner {} part", number), static_cast<int>(c) + 1);
    patch.family = surface_.patches[at(beside)].family;
    patch.ni = patch.nj = columns_ / 2 + 1;
    add_patch(std::move(patch), corner_nodes(index, rays, c), beside);
  }
}

}  // namespace

void open_fans(Surface& surface, int columns, std::vector<int>& component) {
  split_at_sharp_edges(surface, component);
  Opener(surface, columns, component).open();
}

}  // namespace vdb_offset
