#include "vdb_offset/blocks/zone_mesh.h"

namespace vdb_offset {

std::size_t ZoneMesh::cells() const {
  std::size_t sum = 0;
  for (const Zone& zone : zones) sum += zone.cell_count();
  return sum;
}

std::size_t ZoneMesh::points() const {
  std::size_t sum = 0;
  for (const Zone& zone : zones) sum += zone.point_count();
  return sum;
}

Zone zone_of(const MultiBlock& mesh, std::size_t index) {
  const Block& block = mesh.blocks[index];
  Zone zone{block.name, block.family, block.ni, block.nj, block.nk};
  zone.points_world.reserve(zone.point_count());
  for (int k = 0; k < block.nk; ++k) {
    for (const int column : block.columns) zone.points_world.push_back(mesh.layers.at(column, k));
  }
  return zone;
}

ZoneMesh zone_mesh(const MultiBlock& mesh) {
  ZoneMesh out{{}, mesh.interfaces, mesh.boundary_faces};
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) out.zones.push_back(zone_of(mesh, b));
  return out;
}

}  // namespace vdb_offset
