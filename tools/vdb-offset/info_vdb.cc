#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <nlohmann/json.hpp>

#include "command.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

struct GridInfo {
  std::string name;
  std::string type;
  std::string grid_class;
  openvdb::Vec3d voxel_size;
  std::uint64_t active_voxels = 0;
  std::uint64_t bytes = 0;
  openvdb::Vec3d lo, hi;  ///< world: centres of the outermost active voxels
};

GridInfo look_at(const openvdb::GridBase& grid) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  GridInfo out{grid.getName(),
               grid.valueType(),
               openvdb::GridBase::gridClassToString(grid.getGridClass()),
               grid.voxelSize(),
               grid.activeVoxelCount(),
               grid.memUsage(),
               {},
               {}};
  if (!box.empty()) {
    out.lo = grid.indexToWorld(box.min());
    out.hi = grid.indexToWorld(box.max());
  }
  return out;
}

std::vector<GridInfo> read_grids(const std::string& name) {
  openvdb::initialize();
  std::vector<GridInfo> out;
  try {
    openvdb::io::File file(name);
    file.open(false);
    // One grid at a time, so that memory holds no more than the largest.
    for (auto at = file.beginName(); at != file.endName(); ++at) {
      out.push_back(look_at(*file.readGrid(at.gridName())));
    }
  } catch (const openvdb::Exception& error) {
    throw IoError(fmt::format("{}: OpenVDB cannot read it: {}", name, error.what()));
  }
  // OpenVDB takes a file that ends inside its header for one without grids.
  if (out.empty()) throw IoError(name + ": holds no grid; it may have been cut short");
  return out;
}

Json to_json(const openvdb::Vec3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json to_json(const GridInfo& grid) {
  return {{"name", grid.name},
          {"type", grid.type},
          {"class", grid.grid_class},
          {"voxel_size", to_json(grid.voxel_size)},
          {"active_voxels", grid.active_voxels},
          {"bounds", {{"min", to_json(grid.lo)}, {"max", to_json(grid.hi)}}},
          {"bytes", grid.bytes}};
}

std::string to_text(const GridInfo& grid) {
  return fmt::format(
      "grid       '{}': {}, {}, voxel {:.6g} x {:.6g} x {:.6g}, {} active voxels, {}\n"
      "           ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n",
      grid.name, grid.type, grid.grid_class, grid.voxel_size.x(), grid.voxel_size.y(),
      grid.voxel_size.z(), grid.active_voxels, format_bytes(static_cast<double>(grid.bytes)),
      grid.lo.x(), grid.lo.y(), grid.lo.z(), grid.hi.x(), grid.hi.y(), grid.hi.z());
}

}  // namespace

std::string describe_vdb(const std::string& file, bool json) {
  const std::vector<GridInfo> grids = read_grids(file);
  if (!json) {
    std::string out = fmt::format("file       {}\nformat     OpenVDB\n", file);
    for (const GridInfo& grid : grids) out += to_text(grid);
    return out;
  }
  Json out = {{"file", file}, {"format", "openvdb"}, {"grids", Json::array()}};
  for (const GridInfo& grid : grids) out["grids"].push_back(to_json(grid));
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vdb_offset::command
