#include "vdb_offset/surface/wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

#include "core/large_vector.h"
#include "core/parallel.h"
#include "surface/bvh.h"
#include "surface/pseudonormals.h"
#include "surface/space_order.h"
#include "surface/triangle.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

struct Wall::Data {
  Vec3List vertices;
  LargeVector<Triangle> triangles;  // as the hierarchy has them: neighbours stand together
  LargeVector<TriangleGeometry> geometry;
  std::unique_ptr<const Bvh> bvh;
  Box bounds;
  double rounding = 0;  // of a nearest place, world
  mutable std::once_flag normals_made;
  mutable Pseudonormals made_normals;

  void index(const std::vector<Triangle>& given);
  const Pseudonormals& normals() const;
  WallPoint search(const Vec3& query, double limit, Feature& feature) const;
  WallPoint search_from(int guess, const Vec3& query, Feature& feature) const;
  double distance2(int triangle, const Vec3& query) const;
  WallPoint describe(WallPoint result, Feature feature) const;
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

/// Whether the triangle's bounding box is within `reach` of a box.
bool is_near(const TriangleGeometry& g, const Box& box, double reach) {
  Box own;
  own.add(g.a);
  own.add(Vec3(g.a + g.ab));
  own.add(Vec3(g.a + g.ac));
  const Vec3 gap = (own.lo - box.hi).cwiseMax(box.lo - own.hi).cwiseMax(0.0);
  return gap.squaredNorm() <= reach * reach;
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

void Wall::Data::index(const std::vector<Triangle>& given) {
  LargeVector<Box> boxes(given.size());
  for (std::size_t t = 0; t < given.size(); ++t) {
    for (const int v : given[t]) boxes[t].add(vertices[at(v)]);
    bounds.add(boxes[t]);
  }
  rounding = kCoordinateRounding * bounds.lo.cwiseAbs().cwiseMax(bounds.hi.cwiseAbs()).maxCoeff();
  constexpr std::size_t kAhead = 12;
  LargeVector<int> order;
  auto hierarchy = std::make_unique<Bvh>(boxes, order);
  triangles.reserve(given.size());
  geometry.reserve(given.size());
  for (std::size_t n = 0; n < order.size(); ++n) {
    // Corners may stand anywhere: fetched some triangles ahead, they are not waited for.
    const int ahead = order[std::min(n + kAhead, order.size() - 1)];
    __builtin_prefetch(&given[at(order[std::min(n + 2 * kAhead, order.size() - 1)])]);
    for (const int v : given[at(ahead)]) __builtin_prefetch(&vertices[at(v)]);
    triangles.push_back(given[at(order[n])]);
    geometry.push_back(geometry_of(vertices, triangles.back()));
  }
  hierarchy->add_tilted(geometry);
  bvh = std::move(hierarchy);
}

WallPoint Wall::Data::search(const Vec3& query, double limit, Feature& feature) const {
  WallPoint found;
  if (!query.allFinite()) return found;
  double best2 = limit * limit;
  bvh->nearest(query, best2, [&](std::uint32_t first, std::uint32_t last, double& b2) {
    for (std::uint32_t p = first; p < last; ++p) {
      if (plane_is_beyond(geometry[p], query, b2, rounding)) continue;
      const TrianglePoint candidate = closest_on_triangle(geometry[p], query);
      const double d2 = (candidate.point_world - query).squaredNorm();
      if (d2 > b2 || (d2 == b2 && found.triangle >= 0)) continue;
      b2 = d2;
      found.triangle = static_cast<int>(p);
      found.point_world = candidate.point_world;
      feature = candidate.feature;
    }
  });
  if (found.triangle >= 0) found.distance_world = std::sqrt(best2);
  return found;
}

double Wall::Data::distance2(int triangle, const Vec3& query) const {
  return (closest_on_triangle(geometry[at(triangle)], query).point_world - query).squaredNorm();
}

WallPoint Wall::Data::search_from(int guess, const Vec3& query, Feature& feature) const {
  if (guess >= 0 && query.allFinite()) {
    // The bound is a distance to the wall, so what is nearest lies within it, rounding apart.
    const double limit = std::sqrt(distance2(guess, query)) * (1 + 1e-12);
    const WallPoint found = search(query, limit, feature);
    if (found.triangle >= 0) return found;
  }
  return search(query, std::numeric_limits<double>::infinity(), feature);
}

/// Isolated: a thread that waits here for parts of the work must not take up another query, which
/// would wait for this one.
const Pseudonormals& Wall::Data::normals() const {
  std::call_once(normals_made, [&] {
    parallel::isolate([&] { made_normals = pseudonormals({vertices, triangles, geometry}); });
  });
  return made_normals;
}

/// Adds the pseudonormal.
WallPoint Wall::Data::describe(WallPoint result, Feature feature) const {
  if (result.triangle < 0) return result;
  const Pseudonormals& n = normals();
  const auto t = at(result.triangle);
  const auto edge = [&](std::size_t e) {
    result.normal = n.edge_normal(t, e);
    result.on_free_edge = n.edge_free(t, e);
  };
  const auto vertex = [&](std::size_t c) {
    result.normal = n.vertex[at(triangles[t][c])];
    result.on_free_edge = n.vertex_free[at(triangles[t][c])] != 0;
  };
  switch (feature) {
    case Feature::Face:
      result.normal = n.triangle[t];
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
  data->index(triangles);
  data_ = std::move(data);
}

Wall::~Wall() = default;
Wall::Wall(Wall&&) noexcept = default;
Wall& Wall::operator=(Wall&&) noexcept = default;

WallPoint Wall::closest(const Vec3& query_world, double limit_world) const {
  Feature feature{};
  const WallPoint found = data_->search(query_world, limit_world, feature);
  return data_->describe(found, feature);
}

WallPoint Wall::closest_place(const Vec3& query_world, double limit_world) const {
  Feature feature{};
  return data_->search(query_world, limit_world, feature);
}

WallPoint Wall::closest_from(int guess, const Vec3& query_world) const {
  Feature feature{};
  const WallPoint found = data_->search_from(guess, query_world, feature);
  return data_->describe(found, feature);
}

std::vector<double> Wall::true_distance(const Vec3List& queries_world) const {
  std::vector<double> distances(queries_world.size());
  const std::vector<std::uint32_t> order = order_in_space(queries_world);
  parallel::for_pieces(order.size(), 512, [&](std::size_t begin, std::size_t end) {
    WallPoint last;
    Feature feature{};
    for (std::size_t q = begin; q < end; ++q) {
      last = data_->search_from(last.triangle, queries_world[order[q]], feature);
      distances[order[q]] = last.distance_world;
    }
  });
  return distances;
}

void Wall::near_box(const Box& box_world, double reach_world,
                    std::vector<TriangleRun>& runs) const {
  const auto add = [&](std::uint32_t first, std::uint32_t last, const Box& box) {
    runs.push_back({first, last, box});
    return false;
  };
  data_->bvh->near_box(box_world, reach_world, add);
}

bool Wall::is_near_box(const Box& box_world, double reach_world) const {
  const auto any = [&](std::uint32_t first, std::uint32_t last, const Box&) {
    for (std::uint32_t p = first; p < last; ++p) {
      if (is_near(data_->geometry[p], box_world, reach_world)) return true;
    }
    return false;
  };
  return data_->bvh->near_box(box_world, reach_world, any);
}

WallPoint Wall::closest_on(int triangle, const Vec3& query_world) const {
  const TrianglePoint nearest = closest_on_triangle(data_->geometry[at(triangle)], query_world);
  WallPoint result;
  result.distance_world = (query_world - nearest.point_world).norm();
  result.point_world = nearest.point_world;
  result.triangle = triangle;
  return data_->describe(result, nearest.feature);
}

double Wall::distance2(int triangle, const Vec3& query_world) const {
  return data_->distance2(triangle, query_world);
}

const Vec3List& Wall::vertices() const { return data_->vertices; }
std::span<const Wall::Triangle> Wall::triangles() const { return data_->triangles; }
std::span<const TriangleGeometry> Wall::geometry() const { return data_->geometry; }
const Vec3& Wall::vertex_normal(int vertex) const { return data_->normals().vertex[at(vertex)]; }
const Vec3& Wall::triangle_normal(int triangle) const {
  return data_->normals().triangle[at(triangle)];
}
const Box& Wall::bounds() const { return data_->bounds; }

double Wall::area() const {
  double sum = 0;
  for (const TriangleGeometry& g : data_->geometry) sum += 0.5 * doubled_area(g).norm();
  return sum;
}

std::size_t Wall::bytes() const {
  const std::size_t per_triangle =
      sizeof(Triangle) + sizeof(Vec3) + sizeof(std::array<int, 3>) + sizeof(TriangleGeometry);
  return data_->triangles.size() * per_triangle + data_->vertices.size() * (2 * sizeof(Vec3) + 1) +
         data_->bvh->bytes();
}

}  // namespace vdb_offset
