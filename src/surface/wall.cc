// Baerentzen and Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005.

#include "vdb_offset/surface/wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "core/parallel.h"
#include "surface/bvh.h"
#include "surface/space_order.h"
#include "surface/triangle.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

struct Wall::Data {
  Vec3List vertices;
  std::vector<Triangle> triangles;  // as the hierarchy has them: neighbours stand together
  Vec3List triangle_normals;
  Vec3List vertex_normals;
  std::vector<std::array<Vec3, 3>> edge_normals;  // of edges ab, bc, ca
  std::vector<std::array<bool, 3>> edge_free;     // used by one triangle
  std::vector<char> vertex_free;                  // on the open boundary
  std::vector<TriangleGeometry> geometry;
  std::unique_ptr<const Bvh> bvh;
  Box bounds;
  double area = 0;
  double rounding = 0;  // of a nearest place, world

  void find_normals();
  void find_edges();
  void mark_free_vertices();
  void index();
  WallPoint describe(int triangle, const TrianglePoint& nearest, const Vec3& query) const;
};

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Whether a triangle's plane alone is farther off than the root of `limit2`: cheap, and near a
/// focal point of the wall, where no box is, nearly always true. No triangle is passed over whose
/// distance, as computed, would be the least: the normal is off by eps |ab| |ac|, the height by
/// that times |q|, and the nearest place by `rounding`, some eps of the coordinates.
bool plane_is_beyond(const TriangleGeometry& t, const Vec3& p, double limit2, double rounding) {
  constexpr double kBlur = 4e-15;  // 32 roundings of 1.1e-16; there are about 15
  const Vec3 q = p - t.a;
  const Vec3 normal = t.ab.cross(t.ac);
  const double most_area = t.ab.cwiseAbs().sum() * t.ac.cwiseAbs().sum();
  const double error = most_area * (kBlur * q.cwiseAbs().sum() + rounding);
  const double height = std::abs(normal.dot(q)) - error;
  return height > 0 && height * height > (1 + 1e-9) * limit2 * normal.squaredNorm();
}

TriangleGeometry geometry_of(const Vec3List& v, const Wall::Triangle& t) {
  return {v[at(t[0])], v[at(t[1])] - v[at(t[0])], v[at(t[2])] - v[at(t[0])]};
}

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

void check_finite(const Vec3List& vertices) {
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    if (!vertices[n].allFinite()) {
      throw InputError("wall vertex " + std::to_string(n) + " is not a finite point",
                       {static_cast<std::int64_t>(n)});
    }
  }
}

}  // namespace

void Wall::Data::find_normals() {
  triangle_normals.resize(triangles.size());
  std::vector<std::array<double, 3>> angles(triangles.size());
  std::vector<double> areas(triangles.size());
  parallel::for_ranges(triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const TriangleGeometry& g = geometry[n];
      const Vec3 cross = doubled_area(g);
      const double doubled = cross.norm();
      areas[n] = 0.5 * doubled;
      triangle_normals[n] = unit(cross);
      const Vec3 bc = g.ac - g.ab;
      angles[n] = {std::atan2(doubled, g.ab.dot(g.ac)), std::atan2(doubled, -g.ab.dot(bc)),
                   std::atan2(doubled, g.ac.dot(bc))};
    }
  });
  // In order, so that the sums do not depend on the threads.
  vertex_normals.assign(vertices.size(), Vec3::Zero());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    area += areas[n];
    for (std::size_t c = 0; c < 3; ++c) {
      vertex_normals[at(triangles[n][c])] += angles[n][c] * triangle_normals[n];
    }
  }
  for (Vec3& normal : vertex_normals) normal = unit(normal);
}

void Wall::Data::find_edges() {
  // Uses of edges, in buckets by their lower vertex: cheaper than one long sort.
  struct Use {
    int hi, triangle, edge;
  };
  const auto lower = [&](const Triangle& t, std::size_t e) {
    return at(std::min(t[e], t[(e + 1) % 3]));
  };
  std::vector<std::size_t> first(vertices.size() + 2, 0);
  for (const Triangle& t : triangles) {
    for (std::size_t e = 0; e < 3; ++e) ++first[lower(t, e) + 2];
  }
  for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
  std::vector<Use> uses(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const int hi = std::max(triangles[t][e], triangles[t][(e + 1) % 3]);
      uses[first[lower(triangles[t], e) + 1]++] = {hi, static_cast<int>(t), static_cast<int>(e)};
    }
  }
  edge_normals.resize(triangles.size());
  edge_free.assign(triangles.size(), {false, false, false});
  const auto join = [&](const Use* begin, const Use* end) {
    Vec3 sum = Vec3::Zero();
    for (const Use* use = begin; use < end; ++use) sum += triangle_normals[at(use->triangle)];
    const Vec3 normal = unit(sum);
    for (const Use* use = begin; use < end; ++use) {
      edge_normals[at(use->triangle)][at(use->edge)] = normal;
      edge_free[at(use->triangle)][at(use->edge)] = end - begin == 1;
    }
  };
  parallel::for_ranges(vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
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

void Wall::Data::mark_free_vertices() {
  vertex_free.assign(vertices.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (!edge_free[t][e]) continue;
      vertex_free[at(triangles[t][e])] = 1;
      vertex_free[at(triangles[t][(e + 1) % 3])] = 1;
    }
  }
}

void Wall::Data::index() {
  std::vector<Box> boxes(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const int v : triangles[t]) boxes[t].add(vertices[at(v)]);
  }
  std::vector<int> order;
  bvh = std::make_unique<const Bvh>(boxes, order);
  std::vector<Triangle> ordered;
  ordered.reserve(triangles.size());
  geometry.reserve(triangles.size());
  for (const int t : order) {
    ordered.push_back(triangles[at(t)]);
    geometry.push_back(geometry_of(vertices, ordered.back()));
  }
  triangles = std::move(ordered);
}

WallPoint Wall::Data::describe(int triangle, const TrianglePoint& nearest,
                               const Vec3& query) const {
  WallPoint result;
  result.distance_world = (query - nearest.point_world).norm();
  result.point_world = nearest.point_world;
  result.triangle = triangle;
  const auto t = at(triangle);
  const auto edge = [&](std::size_t e) {
    result.normal = edge_normals[t][e];
    result.on_free_edge = edge_free[t][e];
  };
  const auto vertex = [&](std::size_t c) {
    result.normal = vertex_normals[at(triangles[t][c])];
    result.on_free_edge = vertex_free[at(triangles[t][c])] != 0;
  };
  switch (nearest.feature) {
    case Feature::Face:
      result.normal = triangle_normals[t];
      break;
    case Feature::VertexA:
      vertex(0);
      break;
    case Feature::VertexB:
      vertex(1);
      break;
    case Feature::VertexC:
      vertex(2);
      break;
    case Feature::EdgeAB:
      edge(0);
      break;
    case Feature::EdgeBC:
      edge(1);
      break;
    case Feature::EdgeCA:
      edge(2);
      break;
  }
  return result;
}

Wall::Wall(Vec3List vertices, std::vector<Triangle> triangles) {
  auto data = std::make_unique<Data>();
  check_finite(vertices);
  std::erase_if(triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  if (triangles.empty()) throw InputError("the wall has no triangle with three different corners");
  data->vertices = std::move(vertices);
  data->triangles = std::move(triangles);
  for (const Triangle& t : data->triangles) {
    for (const int v : t) data->bounds.add(data->vertices[at(v)]);
  }
  data->rounding = kCoordinateRounding *
                   data->bounds.lo.cwiseAbs().cwiseMax(data->bounds.hi.cwiseAbs()).maxCoeff();
  data->index();
  data->find_normals();
  data->find_edges();
  data->mark_free_vertices();
  data_ = std::move(data);
}

Wall::~Wall() = default;
Wall::Wall(Wall&&) noexcept = default;
Wall& Wall::operator=(Wall&&) noexcept = default;

WallPoint Wall::closest(const Vec3& query_world, double limit_world) const {
  if (!query_world.allFinite()) return {};
  double best2 = limit_world * limit_world;
  std::uint32_t best = UINT32_MAX;
  TrianglePoint nearest{};
  data_->bvh->nearest(query_world, best2, [&](std::uint32_t first, std::uint32_t last, double& b2) {
    for (std::uint32_t p = first; p < last; ++p) {
      if (plane_is_beyond(data_->geometry[p], query_world, b2, data_->rounding)) continue;
      const TrianglePoint candidate = closest_on_triangle(data_->geometry[p], query_world);
      const double d2 = (candidate.point_world - query_world).squaredNorm();
      if (d2 > b2 || (d2 == b2 && best != UINT32_MAX)) continue;
      b2 = d2;
      best = p;
      nearest = candidate;
    }
  });
  if (best == UINT32_MAX) return {};
  return data_->describe(static_cast<int>(best), nearest, query_world);
}

WallPoint Wall::closest_from(int guess, const Vec3& query_world) const {
  if (guess < 0 || !query_world.allFinite()) return closest(query_world);
  // The bound is a distance to the wall, so what is nearest lies within it, rounding apart.
  const WallPoint found =
      closest(query_world, std::sqrt(distance2(guess, query_world)) * (1 + 1e-12));
  return found.triangle >= 0 ? found : closest(query_world);
}

std::vector<double> Wall::true_distance(const Vec3List& queries_world) const {
  std::vector<double> distances(queries_world.size());
  const std::vector<std::uint32_t> order = order_in_space(queries_world);
  parallel::for_pieces(order.size(), 512, [&](std::size_t begin, std::size_t end) {
    WallPoint last;
    for (std::size_t q = begin; q < end; ++q) {
      last = closest_from(last.triangle, queries_world[order[q]]);
      distances[order[q]] = last.distance_world;
    }
  });
  return distances;
}

void Wall::near_box(const Box& box_world, double reach_world, std::vector<int>& triangles) const {
  data_->bvh->near_box(box_world, reach_world, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t p = first; p < last; ++p) {
      const TriangleGeometry& g = data_->geometry[p];
      Box box;
      box.add(g.a);
      box.add(Vec3(g.a + g.ab));
      box.add(Vec3(g.a + g.ac));
      const Vec3 gap = (box.lo - box_world.hi).cwiseMax(box_world.lo - box.hi).cwiseMax(0.0);
      if (gap.squaredNorm() <= reach_world * reach_world) {
        triangles.push_back(static_cast<int>(p));
      }
    }
  });
}

WallPoint Wall::closest_on(int triangle, const Vec3& query_world) const {
  const TrianglePoint nearest = closest_on_triangle(data_->geometry[at(triangle)], query_world);
  return data_->describe(triangle, nearest, query_world);
}

double Wall::distance2(int triangle, const Vec3& query_world) const {
  const TriangleGeometry& g = data_->geometry[at(triangle)];
  return (closest_on_triangle(g, query_world).point_world - query_world).squaredNorm();
}

const Vec3List& Wall::vertices() const { return data_->vertices; }
const std::vector<Wall::Triangle>& Wall::triangles() const { return data_->triangles; }
const std::vector<TriangleGeometry>& Wall::geometry() const { return data_->geometry; }
const Vec3& Wall::vertex_normal(int vertex) const { return data_->vertex_normals[at(vertex)]; }
const Vec3& Wall::triangle_normal(int triangle) const {
  return data_->triangle_normals[at(triangle)];
}
const Box& Wall::bounds() const { return data_->bounds; }
double Wall::area() const { return data_->area; }

std::size_t Wall::bytes() const {
  const std::size_t per_triangle = sizeof(Triangle) + sizeof(Vec3) + sizeof(std::array<Vec3, 3>) +
                                   sizeof(std::array<bool, 3>) + sizeof(TriangleGeometry);
  return data_->triangles.size() * per_triangle + data_->vertices.size() * (2 * sizeof(Vec3) + 1) +
         data_->bvh->bytes();
}

}  // namespace vdb_offset
