// Baerentzen and Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005.

#include "surface/pseudonormals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>

#include "core/parallel.h"
#include "surface/triangle.h"

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

void find_normals(const WallMesh& mesh, Pseudonormals& normals) {
  const std::size_t count = mesh.triangles.size();
  normals.triangle.resize(count);
  LargeVector<std::array<double, 3>> angles(count);
  parallel::for_ranges(count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const TriangleGeometry& g = mesh.geometry[n];
      const Vec3 cross = doubled_area(g);
      const double doubled = cross.norm();
      normals.triangle[n] = unit(cross);
      const Vec3 bc = g.ac - g.ab;
      angles[n] = {std::atan2(doubled, g.ab.dot(g.ac)), std::atan2(doubled, -g.ab.dot(bc)),
                   std::atan2(doubled, g.ac.dot(bc))};
    }
  });
  // In order, so that the sums do not depend on the threads.
  normals.vertex.assign(mesh.vertices.size(), Vec3::Zero());
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      normals.vertex[at(mesh.triangles[n][c])] += angles[n][c] * normals.triangle[n];
    }
  }
  for (Vec3& normal : normals.vertex) normal = unit(normal);
}

void find_edges(const WallMesh& mesh, Pseudonormals& normals) {
  const std::span<const Wall::Triangle> triangles = mesh.triangles;
  // Uses of edges, in buckets by their lower vertex: cheaper than one long sort.
  struct Use {
    int hi, triangle, edge;
  };
  const auto lower = [&](const Wall::Triangle& t, std::size_t e) {
    return at(std::min(t[e], t[(e + 1) % 3]));
  };
  LargeVector<std::size_t> first(mesh.vertices.size() + 2, 0);
  for (const Wall::Triangle& t : triangles) {
    for (std::size_t e = 0; e < 3; ++e) ++first[lower(t, e) + 2];
  }
  for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
  LargeVector<Use> uses(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const int hi = std::max(triangles[t][e], triangles[t][(e + 1) % 3]);
      uses[first[lower(triangles[t], e) + 1]++] = {hi, static_cast<int>(t), static_cast<int>(e)};
    }
  }
  normals.beyond.resize(triangles.size());
  std::mutex shared;
  const auto join = [&](const Use* begin, const Use* end) {
    const auto beyond = [&](const Use* use) -> int& {
      return normals.beyond[at(use->triangle)][at(use->edge)];
    };
    if (end - begin == 1) {
      beyond(begin) = Pseudonormals::kFree;
    } else if (end - begin == 2) {
      beyond(begin) = begin[1].triangle;
      beyond(begin + 1) = begin->triangle;
    } else {
      Vec3 sum = Vec3::Zero();
      for (const Use* use = begin; use < end; ++use) sum += normals.triangle[at(use->triangle)];
      const std::lock_guard guard(shared);
      normals.shared.push_back(unit(sum));
      const int entry = ~static_cast<int>(normals.shared.size());
      for (const Use* use = begin; use < end; ++use) beyond(use) = entry;
    }
  };
  parallel::for_ranges(mesh.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Use* use = uses.data() + first[v];
      Use* const last = uses.data() + first[v + 1];
      std::sort(use, last, [](const Use& a, const Use& b) {
        return std::tie(a.hi, a.triangle, a.edge) < std::tie(b.hi, b.triangle, b.edge);
      });
      while (use < last) {
        const Use* const start = use;
        while (use < last && use->hi == start->hi) ++use;
        join(start, use);
      }
    }
  });
}

void mark_free_vertices(const WallMesh& mesh, Pseudonormals& normals) {
  const std::span<const Wall::Triangle> triangles = mesh.triangles;
  normals.vertex_free.assign(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (!normals.edge_free(t, e)) continue;
      normals.vertex_free[at(triangles[t][e])] = 1;
      normals.vertex_free[at(triangles[t][(e + 1) % 3])] = 1;
    }
  }
}

}  // namespace

Vec3 Pseudonormals::edge_normal(std::size_t t, std::size_t e) const {
  const int other = beyond[t][e];
  if (other == kFree) return unit(triangle[t]);
  if (other < kFree) return shared[at(~other - 1)];
  return unit(triangle[t] + triangle[at(other)]);
}

Pseudonormals pseudonormals(const WallMesh& mesh) {
  Pseudonormals normals;
  find_normals(mesh, normals);
  find_edges(mesh, normals);
  mark_free_vertices(mesh, normals);
  return normals;
}

}  // namespace vdb_offset
