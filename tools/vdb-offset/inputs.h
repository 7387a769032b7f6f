#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "cad_input.h"
#include "polygon_input.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/io/polygons.h"
#include "vdb_offset/io/topology.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::command {

/// What is read: walls, curves, meshes; the last four, and maps, for 'info' and 'check' alone. An
/// .obj file holds curves or polygons.
enum class InputKind {
  Plot3d,
  Cgns,
  Airfoil,
  Obj,
  Polygons,
  Cad,
  NeutralMap,
  Topology,
  Vtk,
  Vtu,
  Su2,
  OpenFoam
};

/// Whether a mesh of that kind is of cells without blocks (CellZone).
inline bool is_unstructured(InputKind kind) {
  return kind == InputKind::Vtu || kind == InputKind::Su2 || kind == InputKind::OpenFoam;
}

/// Whether files of that kind are XML.
inline bool is_vtk(InputKind kind) { return kind == InputKind::Vtk || kind == InputKind::Vtu; }

/// --input-format: a kind, or words of PLOT3D; empty: a file's extension tells (.cgns, .dat, .obj,
/// .stl, .ply, .off, .step, .iges, .brep, .nmf, .json, .vtm, .vts, .vtu, .su2, .foam; a folder is a
/// case of OpenFOAM).
class InputFormat {
 public:
  /// Throws InputError for words that are none.
  explicit InputFormat(const std::string& words, const CadOptions& cad = {});

  InputKind kind_of(const std::string& file) const;
  const Plot3dHint& hint() const { return hint_; }
  /// The patches of one file, with notes for the user. Throws IoError.
  Patches read(const std::string& file, PolygonUse& use, std::vector<std::string>& notes) const;
  /// The polygons of one file of kind Obj or Polygons; nothing where it holds curves.
  std::optional<PolygonMesh> polygons(const std::string& file, std::vector<std::string>& notes,
                                      std::vector<std::string>& warnings) const;
  /// Of such a file.
  PolygonFormat polygon_format(const std::string& file) const;

 private:
  std::string words_;
  Plot3dHint hint_;
  CadOptions cad_;
};

/// Throws IoError, with `advice`, for text files of other programs that begin with a character that
/// no grid begins with.
void refuse_strangers(const std::string& file, std::string_view advice);

/// `info` of a CGNS file, as lines and as JSON's text; its surface not among them.
std::string cgns_lines(const std::string& file, const CgnsInfo& info);
std::string cgns_json(const std::string& file, const CgnsInfo& info);
std::size_t cells_of(const CgnsZoneInfo& zone);

/// `info` of a topology document's relations, as lines and as JSON's text; its surface not among
/// them.
std::string topology_lines(const std::string& file, const TopologyDocument& document);
std::string topology_json(const std::string& file, const TopologyDocument& document);

/// `info` of a volume mesh of VTK, SU2 or OpenFOAM, as lines or as JSON.
std::string describe_volume(const std::string& file, InputKind kind, bool json);

/// `info` of a neutral map, as lines or as JSON.
std::string describe_neutral_map(const std::string& file, bool json);

bool are_curves(const Patches& patches);

/// `info` of curves, as lines or as JSON; the kind is not PLOT3D.
std::string describe_curves_file(const std::string& file, InputKind kind, bool json);
/// The part of it about the curves themselves; the second as JSON's text.
std::string describe_curves(const Patches& patches);
std::string curves_json(const Patches& patches);

}  // namespace vdb_offset::command
