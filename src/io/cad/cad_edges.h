#pragma once

#include <Geom2d_Curve.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <vector>

#include "io/cad/cad_shape.h"

namespace vdb_offset::cad {

/// An edge of the model, with the nodes that all its faces share.
struct SharedEdge {
  std::vector<double> parameter;  ///< of samples along its curve
  std::vector<double> asked;      ///< cells that length and turning ask for up to each of them
  double length_world = 0;
  int cells = 1;
  std::vector<double> node_parameter;
  Vec3List nodes_world;
};

/// Cells that a line of points asks for: by length, and by how it turns. The points may be near
/// each other, in world units; the sums up to each point.
std::vector<double> cells_asked(const Vec3List& line_world, const CadOptions& options);

/// All edges of a model; poles aside.
class SharedEdges {
 public:
  /// `options` with a size.
  SharedEdges(const Model& model, const CadOptions& options);

  int index(const TopoDS_Edge& edge) const { return map_.FindIndex(edge) - 1; }
  SharedEdge& operator[](int edge) { return edges_[static_cast<std::size_t>(edge)]; }
  const SharedEdge& operator[](int edge) const { return edges_[static_cast<std::size_t>(edge)]; }

  /// Puts `cells` + 1 nodes on each edge: on the surface of one of its faces.
  void place_nodes(const Model& model);

 private:
  TopTools_IndexedMapOfShape map_;
  std::vector<SharedEdge> edges_;
};

}  // namespace vdb_offset::cad
