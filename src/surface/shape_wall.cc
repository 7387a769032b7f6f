#include "surface/shape_wall.h"

#include <cstddef>
#include <utility>

#include "vdb_offset/surface/surface.h"
#include "vdb_offset/surface/turn_round.h"

namespace vdb_offset {

namespace {

Surface shape_surface(const Patches& patches, double scale) {
  SurfaceOptions plain;
  plain.open_edges = OpenEdges::Splay;
  plain.scale = scale;
  return build_surface(patches, plain);
}

/// Patches that hang together.
struct Sheet {
  Patches patches;
  std::shared_ptr<const Wall> wall = nullptr;
  double inward = 0;  ///< of cells at the free edges nearest to it; below 0: they lie behind it
};

std::vector<Sheet> sheets_of(const Surface& shape) {
  std::vector<Sheet> sheets(static_cast<std::size_t>(shape.topology.components));
  for (std::size_t p = 0; p < shape.patches.size(); ++p) {
    const auto component = static_cast<std::size_t>(shape.topology.component[p]);
    sheets[component].patches.push_back(shape.patches[p]);
  }
  if (sheets.size() == 1) {
    sheets.front().wall = shape.wall;
    return sheets;
  }
  for (Sheet& sheet : sheets) sheet.wall = shape_surface(sheet.patches, 1).wall;
  return sheets;
}

}  // namespace

std::shared_ptr<const Wall> shape_wall(const NamedShape& named, double scale) {
  return shape_surface(named.patches, scale).wall;
}

std::shared_ptr<const Wall> turned_shape(const NamedShape& named, double scale,
                                         const ShapeRim& rim) {
  const Surface shape = shape_surface(named.patches, scale);
  std::vector<Sheet> sheets = sheets_of(shape);
  double all = 0;
  for (const FreeEdge* edge : rim.edges) {
    const Vec3 middle = 0.5 * (rim.finder.node(edge->a) + rim.finder.node(edge->b));
    WallPoint nearest;
    Sheet* owner = nullptr;
    for (Sheet& sheet : sheets) {
      const WallPoint here = sheet.wall->closest(middle);
      if (owner != nullptr && here.distance_world >= nearest.distance_world) continue;
      nearest = here;
      owner = &sheet;
    }
    owner->inward += nearest.normal.dot(edge->inward);
    all += nearest.normal.dot(edge->inward);
  }
  Patches patches;
  bool is_turned = false;
  for (Sheet& sheet : sheets) {
    const bool is_behind = (sheet.inward != 0 ? sheet.inward : all) < 0;
    is_turned = is_turned || is_behind;
    for (Patch& patch : sheet.patches) {
      if (is_behind) turn_round(patch);
      patches.push_back(std::move(patch));
    }
  }
  return is_turned ? shape_surface(patches, 1).wall : shape.wall;
}

}  // namespace vdb_offset
