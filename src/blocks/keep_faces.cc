#include "blocks/keep_faces.h"

#include <vector>

#include "blocks/lower_columns.h"
#include "blocks/window_repair.h"
#include "vdb_offset/march/face_room.h"

namespace vdb_offset {

int keep_faces_apart(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh) {
  const std::vector<double> room = face_room(surface, mesh.layers, 1 - part_of_room(mesh.layers));
  return room.empty() ? 0 : lower_columns(surface, graph, room, mesh.layers);
}

}  // namespace vdb_offset
