#pragma once

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vdb_offset/surface/example.h"

/// Built-in surfaces under test, welded without any tolerance, and their measures.
namespace vdb_offset::example_test {

inline constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
inline constexpr double kPi = std::numbers::pi;

/// A surface welded on exact coordinates: no tolerance anywhere.
struct Mesh {
  using Key = std::array<double, 3>;
  std::map<Key, int> ids;
  Vec3List nodes;
  std::vector<std::array<int, 4>> quads;              // counter-clockwise about the normal
  std::map<std::pair<int, int>, int> directed_edges;  // uses of each grid edge in each sense

  explicit Mesh(const Patches& patches) {
    for (const Patch& patch : patches) add(patch);
  }

  int node(const Vec3& p) {
    const auto [it, fresh] =
        ids.try_emplace(Key{p.x(), p.y(), p.z()}, static_cast<int>(nodes.size()));
    if (fresh) nodes.push_back(p);
    return it->second;
  }
  const Vec3& point(int id) const { return nodes[static_cast<std::size_t>(id)]; }

  void add(const Patch& patch) {
    for (int j = 0; j + 1 < patch.nj; ++j) {
      for (int i = 0; i + 1 < patch.ni; ++i) {
        const std::array<int, 4> quad{node(patch.at(i, j)), node(patch.at(i + 1, j)),
                                      node(patch.at(i + 1, j + 1)), node(patch.at(i, j + 1))};
        quads.push_back(quad);
        for (std::size_t k = 0; k < 4; ++k) ++directed_edges[{quad[k], quad[(k + 1) % 4]}];
      }
    }
  }

  /// Grid edges whose other sense nobody uses.
  std::vector<std::pair<int, int>> free_edges() const {
    std::vector<std::pair<int, int>> free;
    for (const auto& [edge, uses] : directed_edges) {
      if (!directed_edges.contains({edge.second, edge.first})) free.push_back(edge);
    }
    return free;
  }

  int euler() const {
    const int used = static_cast<int>(directed_edges.size() + free_edges().size());
    return static_cast<int>(nodes.size()) - used / 2 + static_cast<int>(quads.size());
  }
};

/// Connected parts of a graph on the nodes that its edges touch.
template <class Edges>
int parts(const Edges& edges) {
  std::map<int, int> parent;
  const auto root = [&](int a) {
    while (parent.try_emplace(a, a).first->second != a) a = parent[a] = parent[parent[a]];
    return a;
  };
  for (const auto& [a, b] : edges) parent[root(a)] = root(b);
  int count = 0;
  for (const auto& [node, up] : parent) count += node == up ? 1 : 0;
  return count;
}

/// Volume behind the normals by the divergence theorem; each quad is four triangles about its mean.
inline double volume(const Mesh& mesh) {
  double six = 0;
  for (const auto& quad : mesh.quads) {
    Vec3 mean = Vec3::Zero();
    for (const int id : quad) mean += 0.25 * mesh.point(id);
    for (std::size_t k = 0; k < 4; ++k) {
      six += mesh.point(quad[k]).cross(mesh.point(quad[(k + 1) % 4])).dot(mean);
    }
  }
  return six / 6;
}

/// Least sine of a quad's corner angle, negative where the corner is folded over.
inline double worst_corner(const Mesh& mesh) {
  double worst = 1;
  for (const auto& quad : mesh.quads) {
    const Vec3 normal = (mesh.point(quad[2]) - mesh.point(quad[0]))
                            .cross(mesh.point(quad[3]) - mesh.point(quad[1]))
                            .normalized();
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 out = mesh.point(quad[(k + 1) % 4]) - mesh.point(quad[k]);
      const Vec3 in = mesh.point(quad[(k + 3) % 4]) - mesh.point(quad[k]);
      worst = std::min(worst, out.normalized().cross(in.normalized()).dot(normal));
    }
  }
  return worst;
}

inline double naca_half_thickness(double x) {
  return 5 * 0.12 *
         (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * std::pow(x, 3) -
          0.1015 * std::pow(x, 4));
}

inline ExampleOptions with(bool closed, double fillet) {
  ExampleOptions options;
  options.closed = closed;
  options.fillet = fillet;
  return options;
}

inline ExampleOptions notch(double degrees) {
  ExampleOptions options;
  options.angle = degrees * kPi / 180;
  return options;
}

inline ExampleOptions tips(int count) {
  ExampleOptions options;
  options.tips = count;
  return options;
}

inline constexpr std::array<int, 5> kPoints{3, 5, 9, 17, 33};

inline Patches make(std::string_view name, int points, ExampleOptions options = {}) {
  options.points = points;
  return make_example(name, options);
}

inline const Patch& named(const Patches& patches, std::string_view name) {
  const auto it =
      std::find_if(patches.begin(), patches.end(), [&](const Patch& p) { return p.name == name; });
  REQUIRE(it != patches.end());
  return *it;
}

/// Order of convergence of `value(points)` to `exact`, from 17 to 33 points a side.
template <class Value>
double order(const Value& value, double exact) {
  return std::log2(std::abs(value(17) - exact) / std::abs(value(33) - exact));
}

}  // namespace vdb_offset::example_test
