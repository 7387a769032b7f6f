#include "io/cad/cad_edges.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vdb_offset::cad {
namespace {

constexpr int kSamples = 256;

/// Angle between the chords before and after each point but the ends.
double turn_at(const Vec3List& line, std::size_t k) {
  if (k == 0 || k + 1 >= line.size()) return 0;
  const Vec3 before = line[k] - line[k - 1];
  const Vec3 after = line[k + 1] - line[k];
  return std::atan2(before.cross(after).norm(), before.dot(after));
}

/// Lets wanted lengths grow by no more than a fifth of the way along a line.
void grade(const Vec3List& line, std::vector<double>& wanted) {
  constexpr double kSlope = 0.2;
  for (std::size_t k = 1; k < wanted.size(); ++k) {
    const double way = kSlope * (line[k] - line[k - 1]).norm();
    wanted[k] = std::min(wanted[k], wanted[k - 1] + way);
  }
  for (std::size_t k = wanted.size() - 1; k-- > 0;) {
    const double way = kSlope * (line[k + 1] - line[k]).norm();
    wanted[k] = std::min(wanted[k], wanted[k + 1] + way);
  }
}

Vec3List points_on(const TopoDS_Edge& edge, double world_per_cad, std::vector<double>& at) {
  const BRepAdaptor_Curve curve(edge);
  Vec3List line;
  for (int k = 0; k <= kSamples; ++k) {
    at.push_back(std::lerp(curve.FirstParameter(), curve.LastParameter(), double(k) / kSamples));
    const gp_Pnt p = curve.Value(at.back());
    line.emplace_back(Vec3(p.X(), p.Y(), p.Z()) * world_per_cad);
  }
  return line;
}

/// Where `asked` reaches `cells` equal parts of its sum.
std::vector<double> divide(const SharedEdge& edge) {
  std::vector<double> at{edge.parameter.front()};
  std::size_t k = 0;
  for (int node = 1; node < edge.cells; ++node) {
    const double target = edge.asked.back() * node / edge.cells;
    while (k + 2 < edge.asked.size() && edge.asked[k + 1] < target) ++k;
    const double step = edge.asked[k + 1] - edge.asked[k];
    const double part = step > 0 ? std::clamp((target - edge.asked[k]) / step, 0.0, 1.0) : 0.5;
    at.push_back(std::lerp(edge.parameter[k], edge.parameter[k + 1], part));
  }
  at.push_back(edge.parameter.back());
  return at;
}

}  // namespace

std::vector<double> cells_asked(const Vec3List& line_world, const CadOptions& options) {
  constexpr double kShortest = 0.02;  // of the size, but for what would not be round any more
  constexpr double kRound = std::numbers::pi / 4;
  std::vector<double> wanted(line_world.size(), options.size_world);
  for (std::size_t k = 1; k + 1 < line_world.size(); ++k) {
    const double way = ((line_world[k + 1] - line_world[k - 1]) / 2).norm();
    const double turn = turn_at(line_world, k);
    // A kink is a corner of the curve, which no short cells make round.
    if (turn <= 0 || turn > std::numbers::pi / 6) continue;
    const double shortest = std::min(kShortest * options.size_world, way * kRound / turn);
    wanted[k] = std::min(wanted[k], std::max(way * options.turn / turn, shortest));
  }
  if (wanted.size() > 2) {
    wanted.front() = std::min(wanted.front(), wanted[1]);
    wanted.back() = std::min(wanted.back(), wanted[wanted.size() - 2]);
  }
  grade(line_world, wanted);
  std::vector<double> asked{0.0};
  for (std::size_t k = 1; k < line_world.size(); ++k) {
    const double length = (line_world[k] - line_world[k - 1]).norm();
    asked.push_back(asked.back() + 2 * length / (wanted[k] + wanted[k - 1]));
  }
  return asked;
}

SharedEdges::SharedEdges(const Model& model, const CadOptions& options) {
  TopExp::MapShapes(model.shape, TopAbs_EDGE, map_);
  edges_.resize(static_cast<std::size_t>(map_.Extent()));
  for (int e = 1; e <= map_.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(map_(e).Oriented(TopAbs_FORWARD));
    SharedEdge& shared = edges_[static_cast<std::size_t>(e - 1)];
    if (BRep_Tool::Degenerated(edge)) continue;
    const Vec3List line = points_on(edge, model.world_per_cad, shared.parameter);
    for (std::size_t k = 1; k < line.size(); ++k) {
      shared.length_world += (line[k] - line[k - 1]).norm();
    }
    shared.asked = cells_asked(line, options);
    constexpr double kMost = 1e6;
    shared.cells = static_cast<int>(std::clamp(std::ceil(shared.asked.back() - 1e-6), 1.0, kMost));
  }
}

void SharedEdges::place_nodes(const Model& model) {
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(model.shape, TopAbs_VERTEX, vertices);
  Vec3List vertex_world(static_cast<std::size_t>(vertices.Extent()));
  std::vector<bool> is_placed(vertex_world.size());
  for (const NamedFace& named : model.faces) {
    const BRepAdaptor_Surface surface(named.face, false);
    for (TopExp_Explorer it(named.face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Current().Oriented(TopAbs_FORWARD));
      SharedEdge& shared = edges_[static_cast<std::size_t>(index(edge))];
      if (BRep_Tool::Degenerated(edge) || !shared.nodes_world.empty()) continue;
      double first = 0, last = 0;
      const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, named.face, first, last);
      shared.node_parameter = divide(shared);
      for (const double t : shared.node_parameter) {
        const gp_Pnt2d uv = curve->Value(std::clamp(t, first, last));
        const gp_Pnt p = surface.Value(uv.X(), uv.Y());
        shared.nodes_world.emplace_back(Vec3(p.X(), p.Y(), p.Z()) * model.world_per_cad);
      }
      const auto meet = [&](const TopoDS_Vertex& vertex, Vec3& node) {
        const int found = vertices.FindIndex(vertex);
        if (found == 0) return;
        const auto v = static_cast<std::size_t>(found - 1);
        if (!is_placed[v]) vertex_world[v] = node;
        is_placed[v] = true;
        node = vertex_world[v];
      };
      meet(TopExp::FirstVertex(edge), shared.nodes_world.front());
      meet(TopExp::LastVertex(edge), shared.nodes_world.back());
    }
  }
}

}  // namespace vdb_offset::cad
