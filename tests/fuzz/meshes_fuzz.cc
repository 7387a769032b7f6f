// A libFuzzer target for readers of meshes, curves and documents: bytes are read or refused by
// name, and nothing else happens.
//
//   meshes_fuzz --format=plot3d|plot3d-mesh|nmf|su2|cgns|vts|vtm|vtu|topology|airfoil|curves
//   [options] FOLDER...

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "io/airfoil_parse.h"
#include "io/neutral_parse.h"
#include "io/obj_parse.h"
#include "io/plot3d_parse.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/su2.h"
#include "vdb_offset/io/topology.h"
#include "vdb_offset/io/vtk.h"

namespace {

using namespace vdb_offset;

std::string format = "plot3d";
const std::string kName = "fuzz";

/// For readers of files: in memory where there is such a folder, and gone at the end.
class Scratch {
 public:
  Scratch() {
    std::string name = "/dev/shm/meshes_fuzz.XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::filesystem::path write(std::string_view bytes, const char* name) const {
    std::ofstream(folder_ / name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return folder_ / name;
  }

 private:
  std::filesystem::path folder_;
};

void check(bool sound) {
  if (!sound) std::abort();
}

void check(const Patches& patches) {
  for (const Patch& patch : patches) {
    check(patch.points_world.size() ==
          static_cast<std::size_t>(patch.ni) * static_cast<std::size_t>(patch.nj));
    for (const Vec3& p : patch.points_world) check(p.allFinite());
  }
}

void check(const ZoneMesh& mesh) {
  for (const Zone& zone : mesh.zones) check(zone.points_world.size() == zone.point_count());
}

void check(const CellZone& mesh) {
  const auto points = static_cast<std::int64_t>(mesh.points_world.size());
  for (const std::int32_t corner : mesh.cells.points) check(corner >= 0 && corner < points);
}

/// Whatever a file holds, every reader of CGNS is asked for it.
void read_cgns_as_all(const std::filesystem::path& file) {
  const auto ask = [&](const auto& read) {
    try {
      read();
    } catch (const Error&) {
      return;
    }
  };
  ask([&] { inspect_cgns(file); });
  ask([&] { check(read_cgns(file)); });
  ask([&] { check(read_cgns_mesh(file)); });
  ask([&] { check(read_cgns_cells(file)); });
}

void read(std::string_view bytes) {
  static const Scratch scratch;
  if (format == "plot3d") check(read_plot3d_bytes(bytes, kName));
  if (format == "plot3d-mesh") check(read_plot3d_mesh_bytes(bytes, kName));
  if (format == "nmf") read_neutral_map_bytes(bytes, kName);
  if (format == "su2") check(read_su2(scratch.write(bytes, "fuzz.su2")));
  if (format == "cgns") read_cgns_as_all(scratch.write(bytes, "fuzz.cgns"));
  if (format == "vts") check(read_vtm(scratch.write(bytes, "fuzz.vts")));
  if (format == "vtm") check(read_vtm(scratch.write(bytes, "fuzz.vtm")));
  if (format == "vtu") check(read_vtu(scratch.write(bytes, "fuzz.vtu")));
  if (format == "topology") read_topology(scratch.write(bytes, "fuzz.json"));
  if (format == "curves") check(read_obj_curves_bytes(bytes, kName));
  AirfoilInfo info;
  if (format == "airfoil") check(read_airfoil_bytes(bytes, kName, info));
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view kOption = "--format=";
  for (int n = 1; n < *count; ++n) {
    const std::string_view argument = (*arguments)[n];
    if (argument.starts_with(kOption)) format = argument.substr(kOption.size());
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    read({reinterpret_cast<const char*>(data), size});
  } catch (const Error&) {
    return 0;
  }
  return 0;
}
