#pragma once

#include <array>
#include <vector>

namespace vdb_offset {

/// The four sides of a patch. Along imin and imax the running index is j, along jmin and jmax it is
/// i. A patch of polygons has its rim as jmin, and no other.
enum class Side { IMin = 0, IMax = 1, JMin = 2, JMax = 3 };

/// A run of points along one side of one patch: points `begin`, `begin +- 1`, ..., `end`
/// (inclusive).
struct SideRange {
  int patch = -1;
  Side side = Side::IMin;
  int begin = 0;
  int end = 0;  ///< smaller than `begin` where the run goes against the side's index

  int cells() const { return begin < end ? end - begin : begin - end; }
};

/// What a run of grid edges along a side is.
enum class EdgeKind {
  Interface,  ///< two sides share it, node for node
  Free,       ///< one side uses it: the surface ends here
  Degenerate  ///< its points are one node: a pole
};

/// A maximal run of grid edges that has one kind and one pair of users.
struct Edge {
  EdgeKind kind = EdgeKind::Free;
  SideRange first;   ///< begin < end
  SideRange second;  ///< Interface: meets `first` begin to begin, end to end; else patch = -1
  std::array<int, 2> vertices{-1, -1};  ///< indices into Topology::vertices, at begin and end
  int boundary = -1;  ///< that it lies on, -1 for none; inside the wall an internal one
};

/// Vertices, edges and faces (a face is a patch, by its index), built once from the welded nodes.
struct Topology {
  std::vector<int> vertices;   ///< node of each vertex: where edges end
  std::vector<Edge> edges;     ///< every grid edge of every patch side lies in exactly one
  std::vector<int> component;  ///< connected component of each patch, from 0
  int components = 0;
};

}  // namespace vdb_offset
