#include "io/cad/face_sides.h"

#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace vdb_offset::cad {
namespace {

std::vector<EdgeUse> loop_of(const TopoDS_Wire& wire, const TopoDS_Face& face,
                             const SharedEdges& edges) {
  std::vector<EdgeUse> loop;
  for (BRepTools_WireExplorer it(wire, face); it.More(); it.Next()) {
    const TopoDS_Edge& edge = it.Current();
    EdgeUse use;
    use.forward = edge.Orientation() != TopAbs_REVERSED;
    if (!BRep_Tool::Degenerated(edge)) use.edge = edges.index(edge);
    use.curve = BRep_Tool::CurveOnSurface(edge, face, use.first, use.last);
    if (use.curve.IsNull()) return {};
    loop.push_back(std::move(use));
  }
  return loop;
}

int edges_in(const TopoDS_Wire& wire) {
  int count = 0;
  for (TopExp_Explorer it(wire, TopAbs_EDGE); it.More(); it.Next()) ++count;
  return count;
}

/// Ends of a pole's side: the point of its vertex is that of the surface there.
Border pole_line(const Face& face, const EdgeUse& use, std::size_t cells) {
  Border line;
  const Vec2 from = face.plane.flat(use.curve->Value(use.forward ? use.first : use.last));
  const Vec2 to = face.plane.flat(use.curve->Value(use.forward ? use.last : use.first));
  const Vec3 at = face.plane.point_world(from);
  for (std::size_t k = 0; k <= cells; ++k) {
    line.flat.emplace_back(from + (to - from) * (double(k) / double(cells)));
    line.world.push_back(at);
  }
  return line;
}

Border edge_line(const Face& face, const EdgeUse& use, const std::vector<double>& at,
                 const Vec3List* nodes_world) {
  Border line;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const gp_Pnt2d uv = use.curve->Value(std::clamp(at[k], use.first, use.last));
    line.flat.push_back(face.plane.flat(uv));
    line.world.push_back(nodes_world != nullptr ? (*nodes_world)[k] : face.plane.point_world(uv));
  }
  return use.forward ? line : line.reversed();
}

}  // namespace

Border Border::reversed() const {
  return {{flat.rbegin(), flat.rend()}, {world.rbegin(), world.rend()}};
}

Border Border::part(std::size_t from, std::size_t to) const {
  const auto a = static_cast<std::ptrdiff_t>(from);
  const auto b = static_cast<std::ptrdiff_t>(to) + 1;
  return {{flat.begin() + a, flat.begin() + b}, {world.begin() + a, world.begin() + b}};
}

void Border::append(const Border& next) {
  const std::ptrdiff_t from = flat.empty() ? 0 : 1;
  flat.insert(flat.end(), next.flat.begin() + from, next.flat.end());
  world.insert(world.end(), next.world.begin() + from, next.world.end());
}

std::vector<double> Border::parts() const {
  std::vector<double> sum{0.0};
  for (std::size_t k = 1; k < world.size(); ++k) {
    sum.push_back(sum.back() + (world[k] - world[k - 1]).norm());
  }
  const double total = sum.back();
  for (std::size_t k = 0; k < sum.size(); ++k) {
    sum[k] = total > 0 ? sum[k] / total : double(k) / double(sum.size() - 1);
  }
  return sum;
}

Face::Face(const NamedFace& face, const SharedEdges& edges, double world_per_cad)
    : named(&face), plane(face.face, world_per_cad) {
  const TopoDS_Face forward = TopoDS::Face(face.face.Oriented(TopAbs_FORWARD));
  const TopoDS_Wire outer = BRepTools::OuterWire(forward);
  if (outer.IsNull()) return;
  loops.push_back(loop_of(outer, forward, edges));
  for (TopExp_Explorer it(forward, TopAbs_WIRE); it.More(); it.Next()) {
    const TopoDS_Wire wire = TopoDS::Wire(it.Current());
    if (!wire.IsSame(outer)) loops.push_back(loop_of(wire, forward, edges));
    const auto found = wire.IsSame(outer) ? loops.front().size() : loops.back().size();
    // A wire that does not hang together.
    if (std::cmp_not_equal(found, edges_in(wire)) || found == 0) {
      loops.clear();
      return;
    }
  }
}

Border Face::sampled(const Side& side, const SharedEdges& edges) const {
  Border line;
  for (const EdgeUse& use : side) {
    line.append(use.is_pole() ? pole_line(*this, use, 1)
                              : edge_line(*this, use, edges[use.edge].parameter, nullptr));
  }
  return line;
}

Border Face::nodes(const Side& side, const SharedEdges& edges, std::size_t pole_cells) const {
  Border line;
  for (const EdgeUse& use : side) {
    if (use.is_pole()) {
      line.append(pole_line(*this, use, pole_cells));
    } else {
      const SharedEdge& edge = edges[use.edge];
      line.append(edge_line(*this, use, edge.node_parameter, &edge.nodes_world));
    }
  }
  return line;
}

Border Face::straight(const Border& from, std::size_t at, const Border& to, std::size_t to_at,
                      std::size_t cells) const {
  Border line;
  for (std::size_t k = 0; k <= cells; ++k) {
    const double part = double(k) / double(cells);
    line.flat.emplace_back(from.flat[at] + part * (to.flat[to_at] - from.flat[at]));
    line.world.push_back(plane.point_world(line.flat.back()));
  }
  line.world.front() = from.world[at];
  line.world.back() = to.world[to_at];
  return line;
}

int cells_of(const Side& side, const SharedEdges& edges) {
  int cells = 0;
  for (const EdgeUse& use : side) cells += use.is_pole() ? 0 : edges[use.edge].cells;
  return cells;
}

bool is_point(const Side& side) {
  return std::ranges::all_of(side, [](const EdgeUse& use) { return use.is_pole(); });
}

std::vector<double> turns(const Face& face, const std::vector<EdgeUse>& loop,
                          const SharedEdges& edges) {
  std::vector<Border> lines;
  for (const EdgeUse& use : loop) lines.push_back(face.sampled({use}, edges));
  std::vector<double> turn;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::size_t next = (k + 1) % loop.size();
    if (loop[k].is_pole() || loop[next].is_pole()) {
      turn.push_back(std::numbers::pi / 2);
      continue;
    }
    const Vec3List& line = lines[k].world;
    const Vec3 before = line.back() - line[line.size() - 2];
    const Vec3 after = lines[next].world[1] - lines[next].world[0];
    const Vec3 normal = face.plane.normal(lines[k].flat.back()).normalized();
    turn.push_back(std::atan2(before.cross(after).dot(normal), before.dot(after)));
  }
  return turn;
}

}  // namespace vdb_offset::cad
