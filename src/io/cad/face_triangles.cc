#include "io/cad/face_triangles.h"

#include <BRepMesh_DataStructureOfDelaun.hxx>
#include <BRepMesh_Delaun.hxx>
#include <BRepMesh_MeshTool.hxx>
#include <NCollection_IncAllocator.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace vdb_offset::cad {
namespace {

/// The plane's points, those of the loops first.
struct Points {
  std::vector<Vec2> flat;
  Vec3List world;
  std::vector<std::array<int, 2>> links;  ///< of the loops, the face on their left
  double step = 0;                        ///< mean length of these
};

Points loop_points(const Face& face, const SharedEdges& edges) {
  Points points;
  for (const std::vector<EdgeUse>& loop : face.loops) {
    Border line;
    // A pole's line in the plane has no points but its ends: what stands between them would be
    // joined to the same point over and over.
    for (const EdgeUse& use : loop) {
      line.append(face.nodes({use}, edges));
      // Both ends are the point that the edges beside it end in.
      if (use.is_pole()) line.world.back() = line.world[line.world.size() - 2];
    }
    if (loop.front().is_pole()) line.world[0] = line.world[1] = line.world.back();
    const auto first = static_cast<int>(points.flat.size());
    const auto count = static_cast<int>(line.cells());
    for (int k = 0; k < count; ++k) {
      points.flat.push_back(line.flat[static_cast<std::size_t>(k)]);
      points.world.push_back(line.world[static_cast<std::size_t>(k)]);
      points.links.push_back({first + k, first + (k + 1) % count});
    }
  }
  for (const auto& [a, b] : points.links) {
    points.step +=
        (points.flat[static_cast<std::size_t>(b)] - points.flat[static_cast<std::size_t>(a)])
            .norm();
  }
  points.step /= static_cast<double>(points.links.size());
  return points;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double area(const Points& points) {
  double sum = 0;
  for (const auto& [a, b] : points.links) {
    sum +=
        cross(points.flat[static_cast<std::size_t>(a)], points.flat[static_cast<std::size_t>(b)]);
  }
  return sum / 2;
}

/// Within the loops, and no nearer to them than `gap`.
bool is_inside(const Points& points, const Vec2& p, double gap) {
  bool inside = false;
  for (const auto& [from, to] : points.links) {
    const Vec2& a = points.flat[static_cast<std::size_t>(from)];
    const Vec2& b = points.flat[static_cast<std::size_t>(to)];
    const Vec2 along = b - a;
    const double t =
        std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    if ((a + t * along - p).norm() < gap) return false;
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + along.x() * (p.y() - a.y()) / along.y()) inside = !inside;
  }
  return inside;
}

/// Points of a lattice of equal triangles between the loops.
void add_inner_points(const Face& face, const CadOptions& options, Points& points) {
  const double step = std::min(points.step, options.size_world);
  Vec2 lo = points.flat.front();
  Vec2 hi = lo;
  for (const Vec2& p : points.flat) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  const double row = step * std::sqrt(0.75);
  constexpr double kMost = 4e6;
  if ((hi - lo).x() / step * ((hi - lo).y() / row) > kMost) return;
  constexpr double kGap = 0.6;  // of the step
  const std::size_t first = points.flat.size();
  std::vector<Vec2> inner;
  for (int j = 1; lo.y() + row * j < hi.y(); ++j) {
    for (int i = 0; lo.x() + step * i < hi.x(); ++i) {
      const Vec2 p = lo + Vec2(step * (i + 0.5 * (j % 2)), row * j);
      if (is_inside(points, p, kGap * step)) inner.push_back(p);
    }
  }
  points.flat.insert(points.flat.end(), inner.begin(), inner.end());
  for (std::size_t n = first; n < points.flat.size(); ++n) {
    points.world.push_back(face.plane.point_world(points.flat[n]));
  }
}

using Triangles = std::vector<std::array<int, 3>>;

/// Triangles of points, around each counter-clockwise.
Triangles triangulate(const Points& points) {
  // Its tolerances are lengths: the plane is made some thousand long.
  double extent = 1e-300;
  for (const Vec2& p : points.flat) extent = std::max(extent, (p - points.flat.front()).norm());
  const Handle(NCollection_IncAllocator) memory = new NCollection_IncAllocator();
  const Handle(BRepMesh_DataStructureOfDelaun) mesh =
      new BRepMesh_DataStructureOfDelaun(memory, static_cast<int>(points.flat.size()));
  IMeshData::VectorOfInteger order(static_cast<int>(points.flat.size()), memory);
  for (std::size_t n = 0; n < points.flat.size(); ++n) {
    const Vec2 p = (points.flat[n] - points.flat.front()) * (1000 / extent);
    const bool is_fixed = n < points.links.size();
    order.Append(mesh->AddNode(BRepMesh_Vertex(gp_XY(p.x(), p.y()), static_cast<int>(n),
                                               is_fixed ? BRepMesh_Frontier : BRepMesh_Free),
                               true));
  }
  for (const auto& [a, b] : points.links) {
    mesh->AddLink(BRepMesh_Edge(a + 1, b + 1, BRepMesh_Frontier));
  }
  const BRepMesh_Delaun mesher(mesh, order);
  BRepMesh_MeshTool(mesh).EraseFreeLinks();
  Triangles triangles;
  for (IMeshData::IteratorOfMapOfInteger it(mesh->ElementsOfDomain()); it.More(); it.Next()) {
    int corner[3] = {};
    mesh->ElementNodes(mesh->GetElement(it.Key()), corner);
    triangles.push_back({corner[0] - 1, corner[1] - 1, corner[2] - 1});
  }
  std::ranges::sort(triangles);
  return triangles;
}

double area(const Points& points, const Triangles& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec2& at = points.flat[static_cast<std::size_t>(a)];
    sum += cross(points.flat[static_cast<std::size_t>(b)] - at,
                 points.flat[static_cast<std::size_t>(c)] - at);
  }
  return sum / 2;
}

/// Points that are one in space (along seams and at poles) once; triangles that this flattens are
/// left out.
Patch patch_of(const Points& points, const Triangles& triangles, bool is_turned) {
  Patch patch;
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::map<Vec3, int, decltype(less)> known(less);
  const auto number = [&](int point) {
    const Vec3& at = points.world[static_cast<std::size_t>(point)];
    const auto [found, is_new] = known.emplace(at, static_cast<int>(known.size()));
    if (is_new) patch.points_world.push_back(at);
    return found->second;
  };
  for (const auto& [a, b, c] : triangles) {
    const int p = number(a);
    const int q = number(is_turned ? c : b);
    const int r = number(is_turned ? b : c);
    if (p != q && q != r && r != p) patch.faces.push_back({p, q, r, r});
  }
  patch.ni = static_cast<int>(patch.points_world.size());
  return patch;
}

}  // namespace

Patch triangles_of(const Face& face, const SharedEdges& edges, const CadOptions& options) {
  if (face.loops.empty()) return {};
  Points points = loop_points(face, edges);
  const double whole = area(points);
  if (points.flat.size() < 3 || !(whole > 0)) return {};
  add_inner_points(face, options, points);
  const Triangles triangles = triangulate(points);
  constexpr double kMissing = 1e-6;
  if (std::abs(area(points, triangles) - whole) > kMissing * whole) return {};
  return patch_of(points, triangles, face.plane.is_turned());
}

}  // namespace vdb_offset::cad
