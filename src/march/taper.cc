// Where layers run out on a smooth wall they thin out over a few heights, as the outer level of a
// mesh does that ends without a step. A side that stood open would be a wall of the flow.
//
// With t the part of the way that is gone, a height h becomes e + (h - e) t^2 (3 - 2 t): flat at
// both ends, and no steeper than 1.5 over kTaperLength. Its end e is not nothing: all layers find
// room in it as thick as first cells, so that those stay as asked for, and cells stay valid.

#include "march/taper.h"

#include <algorithm>
#include <limits>

#include "march/room.h"

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The nodes that taper, those of fans and of the other side too.
std::vector<int> ends_of(const Surface& surface) {
  std::vector<int> ends;
  for (std::size_t n = 0; n < surface.nodes_world.size(); ++n) {
    const std::size_t stands = surface.stands_at(n) % at(surface.wall_nodes);
    if (std::ranges::binary_search(surface.taper_nodes, static_cast<int>(stands))) {
      ends.push_back(static_cast<int>(n));
    }
  }
  return ends;
}

double tapered(double height, double part, double first_cells) {
  const double end = std::min(first_cells, kTaperEnd * height);
  return end + (height - end) * part * part * (3 - 2 * part);
}

}  // namespace

void taper(const Surface& surface, Layers& layers) {
  if (surface.taper_nodes.empty()) return;
  std::vector<double>& heights = layers.height_world;
  const double reach = kTaperLength * *std::ranges::max_element(heights);
  const Links links = links_of(surface);
  for (const Way& way : ways_from(links, ends_of(surface), reach)) {
    double& height = heights[at(way.node)];
    const double part = std::min(1.0, way.length_world / (kTaperLength * height));
    const double first_cells = layers.spacing.layers * layers.first_asked_world[at(way.node)];
    if (height > 0) height = tapered(height, part, first_cells);
  }
  // Where heights beside differ, so do the ways over which they sink.
  constexpr double kAny = std::numeric_limits<double>::infinity();
  grade(links, {.ratio = kAny, .steepest = kOfHeights.steepest}, heights);
}

}  // namespace vdb_offset
