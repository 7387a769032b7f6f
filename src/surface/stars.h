#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A point of a patch.
struct PatchPoint {
  int patch;
  int index;
};

/// A topology edge, and which of its grid edges are sharp and convex.
struct SharpRun {
  const Edge* edge;
  std::vector<char> sharp;
};

/// What becomes of a node on sharp edges.
enum class Opening {
  Closed,  ///< nothing: the fans that end here close
  Row,     ///< two sectors, one row of N + 1 nodes between them
  Corner   ///< three sectors, three rows
};

/// A node on sharp edges. These part the patches' cells around it into sectors, each with a normal.
struct Star {
  int node = -1;
  int degree = 0;     ///< sharp edges here
  bool free = false;  ///< on a free edge
  Opening opening = Opening::Closed;
  int steps = std::numeric_limits<int>::max();  ///< grid edges to the nearest closed end of its fan
  std::vector<PatchPoint> points;
  std::vector<std::size_t> sector_of;  ///< of each point
  Vec3List normals;                    ///< of sectors, unit
};

/// All stars of a surface.
struct Stars {
  std::vector<SharpRun> runs;
  std::vector<int> of_node;  ///< -1: none
  std::vector<Star> list;
};

/// Node of point `s` of a run's edge, on its first side.
int run_node(const Surface& surface, const SharpRun& run, int s);
/// The points of both sides there.
std::pair<PatchPoint, PatchPoint> run_points(const Surface& surface, const SharpRun& run, int s);

/// Where sharp edges are, and what opens. Corners open only if `with_corners`.
Stars find_stars(const Surface& surface, const Topology& topology, bool with_corners);

}  // namespace vdb_offset
