#include "volume_input.h"

#include <fmt/format.h>

#include "vdb_offset/blocks/find_interfaces.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/neutral_map.h"
#include "vdb_offset/io/openfoam.h"
#include "vdb_offset/io/su2.h"
#include "vdb_offset/io/topology.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset::command {
namespace {

namespace fs = std::filesystem;

VolumeInput read_cgns_volume(const std::string& file) {
  const CgnsInfo info = inspect_cgns(file);
  return {read_cgns_mesh(file), fmt::format("CGNS {:.4g} in {}", info.version, info.container), {}};
}

/// Interfaces by where points are: the file names boundaries alone.
VolumeInput read_vtk_volume(const std::string& file) {
  VolumeInput input{read_vtm(file), "VTK XML", {}};
  if (!input.mesh.boundary_faces.empty()) find_interfaces(input.mesh);
  return input;
}

VolumeInput read_plot3d_volume(const std::string& file, const Plot3dHint& hint,
                               const std::string& nmf) {
  VolumeInput input;
  input.map = nmf;
  if (nmf.empty()) {
    const fs::path beside = fs::path(file).replace_extension(".nmf");
    std::error_code error;
    if (fs::exists(beside, error)) input.map = beside;
  }
  input.format = "PLOT3D: " + inspect_plot3d(file, hint).dialect.describe();
  input.mesh = read_plot3d_mesh(file, hint);
  if (!input.map.empty()) connect(read_neutral_map(input.map), {input.map, file}, input.mesh);
  return input;
}

}  // namespace

VolumeInput read_volume(const std::string& file, const InputFormat& format,
                        const std::string& nmf) {
  const InputKind kind = format.kind_of(file);
  if (kind != InputKind::Plot3d && !nmf.empty()) {
    throw InputError(file + ": --nmf is for PLOT3D grids; this one has its own connectivity");
  }
  if (kind != InputKind::Topology && !is_vtk(kind)) {
    refuse_strangers(file,
                     "check reads CGNS (.cgns), PLOT3D, VTK (.vtm, .vts, .vtu), SU2 (.su2) "
                     "and cases of OpenFOAM only");
  }
  switch (kind) {
    case InputKind::Cgns:
      return read_cgns_volume(file);
    case InputKind::Plot3d:
      return read_plot3d_volume(file, format.hint(), nmf);
    case InputKind::Vtk:
      return read_vtk_volume(file);
    case InputKind::Vtu:
    case InputKind::Su2:
    case InputKind::OpenFoam:
      break;  // read_cells
    case InputKind::NeutralMap:
      throw InputError(file + ": holds no points; give the PLOT3D grid, and this with --nmf");
    case InputKind::Topology:
      read_topology(file);  // which says of other JSON what it is
      throw InputError(file + ": is a topology document, which holds no cells");
    case InputKind::Airfoil:
    case InputKind::Cad:
    case InputKind::Obj:
    case InputKind::Polygons:
      break;
  }
  throw InputError(file + ": holds curves or a surface, and no cells to check");
}

bool is_of_cells(const std::string& file, InputKind kind) {
  if (kind != InputKind::Cgns) return is_unstructured(kind);
  refuse_strangers(file, "it is no CGNS file");
  return inspect_cgns(file).is_unstructured();
}

CellZone read_cells(const std::string& file, InputKind kind) {
  if (kind == InputKind::Cgns) return read_cgns_cells(file);
  if (kind == InputKind::Vtu) return read_vtu(file);
  return kind == InputKind::Su2 ? read_su2(file) : read_openfoam(file);
}

const char* cell_format(InputKind kind) {
  if (kind == InputKind::Cgns) return "CGNS, unstructured";
  if (kind == InputKind::Vtu) return "VTK XML, unstructured";
  return kind == InputKind::Su2 ? "SU2" : "OpenFOAM polyMesh";
}

}  // namespace vdb_offset::command
