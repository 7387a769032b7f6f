#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "blocks/untangle.h"
#include "blocks/window.h"
#include "core/most_normal.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/repair.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// What columns of windows are to keep to.
struct WindowGoal {
  double quality = 0;  ///< scaled Jacobian
  double of_room = 1;  ///< part of their free height that columns have at most
};

/// Part of their free height that columns have: less than all by the margin that the march left.
double part_of_room(const Layers& layers);

/// One window on its way to a valid mesh.
class WindowRepair {
 public:
  WindowRepair(const Surface& surface, const MultiBlock& mesh, const Window& window,
               const WindowGoal& goal);

  /// Untangles, looks, and takes more care where it failed, again and again; what is inverted still
  /// is lowered. If more faces are inverted after all than were at first, the window stays as it
  /// was.
  void run(const Progress& progress);

  /// Puts the free columns into the mesh. Returns by how much ends are farther from the wall than
  /// they were asked to, the most, relative.
  double write(MultiBlock& mesh) const;

  int steps() const { return steps_; }
  bool is_positive() const { return positive_; }

 private:
  void leave_internal(std::size_t node, Vec3& end, Layers& layers) const;
  bool mends_inverted_alone() const;  // without what falls short
  bool is_spent() const;              // no more work is worth it
  std::vector<bool> face_is_inverted() const;
  bool work(const Progress& progress);
  Visible way_out(std::size_t slot) const;
  void straighten(std::size_t slot, const Visible& out, double height_world);
  std::vector<std::size_t> to_collapse(const std::vector<int>& halvings) const;
  void raise_around(std::size_t gone, const std::vector<double>& asked,
                    std::vector<double>& heights, std::vector<int>& halvings) const;
  struct State {
    ColumnVector points_world;
    std::vector<std::vector<double>> heights_world;
    std::vector<int> ends_on;
  };
  State state() const;
  void restore(State state);
  double height_left() const;
  void lower(const Progress& progress);
  void lower_columns(int cuts, const Progress& progress);
  bool is_between(std::size_t slot, std::size_t level) const;
  /// Corners in which columns that reach the distance are capped: the sharpest alone, or all.
  enum class Sharp { Most, All };
  std::size_t follows_bisector(std::size_t slot) const;
  std::optional<double> meets_bisector(std::size_t slot, Sharp which) const;
  std::ptrdiff_t cap_sharp_corners(Sharp which);
  bool work_in_corners(const Progress& progress);
  bool sink_to_room();
  void keep_apart(const Progress& progress);
  std::vector<int> failing(bool may_sink);
  enum class Outcome { Mended, Inverted, NoBetter };
  void count(Outcome outcome, const Window& part);
  void mend(const std::vector<int>& rings, const Progress& progress);
  void grade_heights(std::vector<double>& heights_world) const;
  void sink_to(std::vector<double> heights_world);
  void set_height(std::size_t slot, double height_world);
  void put_to(std::size_t slot, double height_world);

  const Surface& surface_;
  const Layers& layers_;
  WindowShape shape_;
  ColumnGraph graph_;  // of the window's slots
  double of_room_;
  std::vector<double> asked_;  // height of each slot, before anything sank
  int steps_ = 0;
  double settled_ = 0;  // work on all of it at first
  bool positive_ = false;
  std::ptrdiff_t inverted_ = std::numeric_limits<std::ptrdiff_t>::max();  // faces, the fewest yet
  int misses_ = 0;  // rounds that left no fewer
};

}  // namespace vdb_offset
