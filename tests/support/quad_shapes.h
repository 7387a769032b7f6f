#pragma once

// Quad meshes whose layouts are known.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "vdb_offset/surface/polygons.h"

namespace vdb_offset::test {

/// Adds quads by their places; equal places are one point.
class QuadBuilder {
 public:
  void add(const std::array<Vec3, 4>& corners) {
    std::array<int, 4> face{};
    for (std::size_t c = 0; c < 4; ++c) {
      const Vec3& x = corners[c];
      const auto size = static_cast<int>(mesh.points_world.size());
      const auto [known, is_new] = index_.try_emplace({x.x(), x.y(), x.z()}, size);
      if (is_new) mesh.points_world.push_back(x);
      face[c] = known->second;
    }
    mesh.add(face);
  }
  PolygonMesh mesh;

 private:
  std::map<std::array<double, 3>, int> index_;
};

/// Cells of the plane z = 0 of size 1, where `has` says so; normals along z.
inline PolygonMesh cells(int ni, int nj, const std::function<bool(int, int)>& has) {
  QuadBuilder builder;
  for (int j = 0; j < nj; ++j) {
    for (int i = 0; i < ni; ++i) {
      if (!has(i, j)) continue;
      builder.add({Vec3(i, j, 0), Vec3(i + 1, j, 0), Vec3(i + 1, j + 1, 0), Vec3(i, j + 1, 0)});
    }
  }
  return std::move(builder.mesh);
}

inline PolygonMesh sheet(int ni, int nj) {
  return cells(ni, nj, [](int, int) { return true; });
}

/// Every point moved.
inline PolygonMesh bent(PolygonMesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& x : mesh.points_world) x = map(x);
  return mesh;
}

/// The box from -1 to 1 with n x n quads a face, normals outward.
inline PolygonMesh cube(int n) {
  QuadBuilder builder;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const auto point = [&](int i, int j) {
        Vec3 x;
        x[axis] = side;
        x[(axis + (side > 0 ? 1 : 2)) % 3] = 2.0 * i / n - 1;
        x[(axis + (side > 0 ? 2 : 1)) % 3] = 2.0 * j / n - 1;
        return x;
      };
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          builder.add({point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)});
        }
      }
    }
  }
  return std::move(builder.mesh);
}

/// ni x nj quads closed along i, with `point` of i in [0, ni) and j in [0, nj]; or along j too,
/// where j = nj is j = 0 moved on by `twist` along i, and `has` leaves quads out.
struct Round {
  int ni, nj;
  bool both = false;
  int twist = 0;
  std::function<bool(int, int)> has = [](int, int) { return true; };
};

inline PolygonMesh round_mesh(const Round& shape, const std::function<Vec3(int, int)>& point) {
  PolygonMesh mesh;
  const int rows = shape.both ? shape.nj : shape.nj + 1;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < shape.ni; ++i) mesh.points_world.push_back(point(i, j));
  }
  const auto index = [&](int i, int j) {
    const int on = shape.both && j == shape.nj ? i + shape.twist : i;
    return j % rows * shape.ni + on % shape.ni;
  };
  for (int j = 0; j < shape.nj; ++j) {
    for (int i = 0; i < shape.ni; ++i) {
      if (!shape.has(i, j)) continue;
      mesh.add(
          std::array<int, 4>{index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return mesh;
}

/// A tube of radius 1 about z, one unit a row; normals outward.
inline PolygonMesh tube(int ni, int nj) {
  return round_mesh({ni, nj}, [&](int i, int j) {
    const double angle = 2 * std::numbers::pi * i / ni;
    return Vec3(std::cos(angle), std::sin(angle), j);
  });
}

/// A torus of radii 3 and 1, i round the tube: its lines j = const come back moved by `twist`.
inline PolygonMesh torus(const Round& shape) {
  return round_mesh(shape, [&](int i, int j) {
    const double v = 2 * std::numbers::pi * j / shape.nj;
    const double u = 2 * std::numbers::pi * (i + 1.0 * shape.twist * j / shape.nj) / shape.ni;
    const double r = 3 + std::cos(u);
    return Vec3(r * std::cos(v), -r * std::sin(v), std::sin(u));
  });
}

/// n quads round one point in the plane z = 0.
inline PolygonMesh star(int n) {
  QuadBuilder builder;
  const auto tip = [&](int k, double radius) {
    const double angle = std::numbers::pi * (k % (2 * n)) / n;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  for (int k = 0; k < n; ++k) {
    builder.add({Vec3::Zero(), tip(2 * k, 1), tip(2 * k + 1, 1.5), tip(2 * k + 2, 1)});
  }
  return std::move(builder.mesh);
}

/// The surface of boxes of cubes in a room of 6 x 6 x 6, joined.
inline PolygonMesh random_body(std::mt19937& random) {
  std::set<std::array<int, 3>> cubes;
  for (int box = 0; box < 4; ++box) {
    std::array<int, 3> low{};
    std::array<int, 3> high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = static_cast<int>(random() % 4);
      high[a] = low[a] + 1 + static_cast<int>(random() % 3);
    }
    for (int i = low[0]; i < high[0]; ++i) {
      for (int j = low[1]; j < high[1]; ++j) {
        for (int k = low[2]; k < high[2]; ++k) cubes.insert({i, j, k});
      }
    }
  }
  QuadBuilder builder;
  for (const std::array<int, 3>& cube : cubes) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<int, 3> beside = cube;
        beside[static_cast<std::size_t>(axis)] += 2 * side - 1;
        if (cubes.contains(beside)) continue;
        const Vec3 low = Vec3(cube[0], cube[1], cube[2]) + side * Vec3::Unit(axis);
        const Vec3 u = Vec3::Unit((axis + (side == 1 ? 1 : 2)) % 3);
        const Vec3 v = Vec3::Unit((axis + (side == 1 ? 2 : 1)) % 3);
        builder.add({low, low + u, low + u + v, low + v});
      }
    }
  }
  return std::move(builder.mesh);
}

/// The same mesh with points, faces and the corners of faces in another order.
inline PolygonMesh renumbered(const PolygonMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> point(mesh.points_world.size());
  std::iota(point.begin(), point.end(), 0);
  std::shuffle(point.begin(), point.end(), random);
  std::vector<std::size_t> order(mesh.faces());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  PolygonMesh result;
  result.points_world.resize(point.size());
  for (std::size_t p = 0; p < point.size(); ++p) {
    result.points_world[static_cast<std::size_t>(point[p])] = mesh.points_world[p];
  }
  for (const std::size_t f : order) {
    std::array<int, 4> face{};
    const std::size_t turn = random() % 4;
    for (std::size_t c = 0; c < 4; ++c) {
      face[c] = point[static_cast<std::size_t>(mesh.face(f)[(c + turn) % 4])];
    }
    result.add(face);
  }
  return result;
}

}  // namespace vdb_offset::test
