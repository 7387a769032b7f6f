#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/march/spacing.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// What the patches of one family, or one patch, want. Where patches meet the smaller wish holds,
/// and grows from there by the grading of heights; first cells by 1.2 from node to node.
struct FamilyLayers {
  std::string name;                        ///< of a family or a patch
  std::optional<double> distance_world;    ///< thickness instead of the common one, > 0
  std::optional<double> first_cell_world;  ///< first cell instead of the common one, > 0

  /// No layers: its neighbours end on it where they meet it at an angle (of 26 degrees or more at
  /// the shared nodes), and taper to nothing where they go on smoothly (see `make_mesh`, `march`).
  bool off = false;

  bool is_of(const Patch& patch) const {
    return name == patch.family || name == patch.name || name == patch.part_of;
  }
  void validate() const;
};

/// Throws InputError for a family that is of no patch, with the names that there are.
void check_names(const std::vector<FamilyLayers>& families, const Patches& patches);

struct MarchOptions {
  /// Runge-Kutta step along a column, in voxels.  Range: [0.01, 2].  Independent of the layers.
  /// Halving it doubles the march's time and its memory for each column under way.
  double step_voxels = 0.5;
  /// Part of the free height that a column leaves before it meets a facing wall's front; less of it
  /// is left to neither side.  Range: [0, 0.9].
  double gap_margin = 0.1;
  /// Angle by which columns lean outward at free edges on no boundary, radians.  Range: [0, 1].
  /// Its effect on nodes beside fades over kSplayReach distances. 0: they stand upright.
  double splay = std::numbers::pi / 6;
  /// Whether heights are lowered until they do not step between neighbours; if not, every column
  /// is as long as it can be.
  bool graded = true;
  /// Families or patches with layers of their own.
  std::vector<FamilyLayers> families = {};

  void validate() const;
};

/// Why a column ended.
enum class Stop : std::uint8_t {
  Reached = 0,   ///< at the distance asked for
  Collided = 1,  ///< met the front of a facing wall; or phi no longer rises, or there is no way out
  LeftBand = 2,  ///< it ran out of the band
  Limited = 3,   ///< shorter than it could be, so that heights do not step between neighbours
  Internal = 4,  ///< on an internal surface
  Repaired = 5   ///< the blocks' repair moved its end off the height or surface that it was at
};

struct MarchReport {
  int nodes = 0;
  int reached = 0;
  int collided = 0;
  int left_band = 0;
  int limited = 0;
  int internal = 0;
  double distance_error_max = 0;  ///< relative to the distance, over reached nodes, true distance
};

/// Way from a free edge over which columns lean, along grid lines, over the distance asked for.
inline constexpr double kSplayReach = 2;
/// Height where layers taper to nothing, and the way over which they do, over the height beside.
inline constexpr double kTaperEnd = 0.01;
inline constexpr double kTaperLength = 2;

/// The columns: for each node its points at levels 0 .. N.
struct Layers {
  LayerSpacing spacing;                   ///< of columns that reach the full distance
  Vec3List points_world;                  ///< nodes x (N + 1), levels of one node together
  std::vector<Stop> stop;                 ///< of each node
  std::vector<int> ends_on = {};          ///< the internal surface that each node's column ends
                                          ///< on, of the surface's boundaries, or -1; empty: none
  std::vector<double> height_world;       ///< true distance reached by each node
  std::vector<double> room_world;         ///< that it could reach: what is free, or is asked for
  std::vector<double> asked_world;        ///< that is asked for
  std::vector<double> first_asked_world;  ///< first cell that is asked for
  std::vector<double> first_cell_world;   ///< true distance of level 1 of each node
  double distance_world = 0;
  MarchReport report;

  int levels() const { return spacing.layers + 1; }
  /// Heights of a node's levels, by the spacing law: `levels()`, from 0.
  std::vector<double> heights(std::size_t node) const;
  int ended_on(int node) const {
    return ends_on.empty() ? -1 : ends_on[static_cast<std::size_t>(node)];
  }
  const Vec3& at(int node, int level) const {
    return points_world[static_cast<std::size_t>(node) * static_cast<std::size_t>(levels()) +
                        static_cast<std::size_t>(level)];
  }
};

/// March every node along grad phi and read the layers off its column.
///
/// Direction: central differences at voxels, trilinear to the point, normalised; within
/// kSeedReachVoxels of the wall the exact nearest features decide. Fourth-order Runge-Kutta.
/// Off a convex node the column is the straight line to about where that would end, if the true
/// distance there is the line's length: then the line is a gradient line of the true distance.
/// Where columns run into the medial axis they stop if the walls on both sides face each other, and
/// go on along it in a concave corner, where it begins at the wall.
/// Heights: a column that meets a facing wall keeps `gap_margin` of its free height away from it;
/// a node whose cells no direction sees all has none. Where layers over whole faces would meet
/// others their columns are lowered (see `face_room`). Then heights are lowered until neighbours
/// differ by the growth ratio (1.2 at least) or a quarter of the edge between them, whichever is
/// more, and by the edge at most. Layers are squeezed into that, first cells kept if they fit.
/// Towards the surface's `taper_nodes` heights sink to that of N first cells, at most
/// kTaperEnd of what they were, over a way of kTaperLength heights along grid lines, smoothly at
/// both ends: at a slope of 0.75 at most.
/// Accuracy  end points at true distance d to 1e-6 d; level heights (true distance) to 1e-6 of the
///           spacing law where the distance rises smoothly along the column; a turn of phi located
///           to a tenth of a voxel.
/// Cost      about 10 microseconds a node for a straight column, else about 100 at d = 12 voxels;
///           24 bytes a point; a column into a focal point, where all of the wall is as near,
///           looks at all of it some forty times.
/// Threads   nodes side by side, bitwise the same result for any count.
/// Throws    InputError for options out of range; Cancelled.
Layers march(const Surface& surface, const DistanceField& field, const LayerSpacing& spacing,
             const MarchOptions& options = {}, const Progress& progress = {});

}  // namespace vdb_offset
