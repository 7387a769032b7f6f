#pragma once

#include <vector>

#include "io/cad/cad_edges.h"
#include "io/cad/face_plane.h"

namespace vdb_offset::cad {

/// An edge as a face goes along it, the face on its left; or a pole.
struct EdgeUse {
  int edge = -1;  ///< -1: a pole
  bool forward = true;
  Handle(Geom2d_Curve) curve;  ///< in the face's parameters
  double first = 0, last = 0;  ///< its ends

  bool is_pole() const { return edge < 0; }
};

/// Edges one after another that make up one side of a face; none: the side is a point.
using Side = std::vector<EdgeUse>;

/// A line of points of a face.
struct Border {
  std::vector<Vec2> flat;
  Vec3List world;

  std::size_t cells() const { return flat.size() - 1; }
  Border reversed() const;
  /// Points `from` to `to`, both of them.
  Border part(std::size_t from, std::size_t to) const;
  void append(const Border& next);  ///< which begins where this one ends
  /// The length up to each point as a part of the whole; of a point, equal parts.
  std::vector<double> parts() const;
};

/// A face as it is cut into sides.
struct Face {
  const NamedFace* named = nullptr;
  FacePlane plane;
  std::vector<std::vector<EdgeUse>> loops;  ///< the outer one first

  Face(const NamedFace& face, const SharedEdges& edges, double world_per_cad);

  /// Of samples, for what is planned; poles have none but their ends.
  Border sampled(const Side& side, const SharedEdges& edges) const;
  /// Of nodes; poles get `pole_cells`.
  Border nodes(const Side& side, const SharedEdges& edges, std::size_t pole_cells = 1) const;
  /// Straight in the plane, between places that are points already.
  Border straight(const Border& from, std::size_t at, const Border& to, std::size_t to_at,
                  std::size_t cells) const;
};

int cells_of(const Side& side, const SharedEdges& edges);
bool is_point(const Side& side);

/// How far a loop turns to the left where each use ends, radians; about poles a right angle.
std::vector<double> turns(const Face& face, const std::vector<EdgeUse>& loop,
                          const SharedEdges& edges);

}  // namespace vdb_offset::cad
