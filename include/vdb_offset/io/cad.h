#pragma once

#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

struct CadOptions {
  /// Longest edge that is wanted on faces.  World units.  Range: >= 0; 0: a fiftieth of the longest
  /// side of the box around them.
  double size_world = 0;
  /// Most that the surface may turn over one edge.  Radians.  Range: (0, pi/2].  Edges do not
  /// become shorter than a fiftieth of the size for it, unless they would turn by 45 degrees.
  double turn = std::numbers::pi / 12;
  /// Unit of length that points and `size_world` are in, one of a CadReport; empty: the file's. A
  /// file that has none is in it.
  std::string unit = {};

  void validate() const;
};

/// What became of a CAD model's faces.
struct CadReport {
  std::string unit;       ///< of length, of the points; empty: the file has none
  std::string file_unit;  ///< of the file
  int faces = 0;          ///< of the model
  int four_sided = 0;     ///< of these: one patch each; with three sides, a corner is a point
  int split = 0;          ///< of three, five and no corners: several patches each
  int triangulated = 0;   ///< others
  int sewn_edges = 0;     ///< edges that faces came to share
  int healed_faces = 0;   ///< faces that were not valid as the file has them
  int free_edges = 0;     ///< edges of one face
  int turned_parts = 0;   ///< closed ones whose normals pointed inward, cavities apart
  double size_world = 0;  ///< edge length that was used
  /// Loose faces that were left out, since others are there: "face 7 'lid' lies on face 6".
  std::vector<std::string> lying_faces;
  /// Other things to warn of, in words: faces that are not there, closed shells that are open.
  std::vector<std::string> flaws;
};

struct CadSurface {
  Patches patches;
  CadReport report;
};

/// Whether this build reads and writes CAD files (it was built with OpenCASCADE).
bool has_cad();

/// Read a CAD model's faces as patches: STEP (AP203, 214, 242), IGES and BREP.
///
/// Faces are healed where they are not valid, and sewn where edges lie within 1e-6 of the model's
/// size of each other. A loose face that lies on others is left out, and refused where a part of it
/// lies on closed parts. Closed parts are turned so that normals point outward; patches of others
/// are loose, so that what welding closes is too. Faces are split along kinks. Each edge of the
/// model is divided once, by length and curvature, so that patches share its points to the bit. A
/// face of four sides becomes one structured patch: its sides are edges, or chains of edges that go
/// on smoothly, and a seam or a pole is a side as well. One of three sides, where one is short,
/// becomes a patch whose corner across from that is a point; where none is, and of five sides,
/// midpoint subdivision makes three or five patches; a disc becomes five. What is none of these
/// (holes, more corners, folded grids) becomes triangles.
///
/// Out      points in the unit asked for, else the file's; normals (d/di x d/dj) as the model's
///          faces have them: out of a solid. Names are those of faces, else "face 3" (counted from
///          1, those of solids first). Families are names of faces, else their colours
///          ("#rrggbb"), else names of bodies.
/// Accuracy points lie on the model's surfaces to rounding: those on an edge on one of its faces.
/// Throws   InputError for a model without faces, a loose face of which a part lies on closed
///          parts, or a grid of more than 1e8 points; IoError naming the file for one that
///          OpenCASCADE cannot read, and where this build has no CAD.
CadSurface read_cad(const std::string& file, const CadOptions& options = {});

/// Throws IoError naming the file where write_step could not: this build has no CAD, or its module
/// is missing or cannot be loaded. Before a run that is to end in one. A tenth of a second.
void require_step(const std::filesystem::path& file);

/// Write structured patches as B-spline surfaces to STEP (AP214): cubic, through all points, sewn.
///
/// A patch is one face, or several: it is cut along its grid lines at creases (turns of more than
/// 30 degrees, unless the surface goes on turning at least half as much beside them), and where the
/// side of a neighbour ends within one of its own. Parameters are those of the points' distances,
/// the same for all rows that sides tie together: neighbours meet in one curve. Where cuts would
/// wind round and round the surface (four times as many pieces, and 64 more) sides that meet parts
/// of sides are left so, and sewn where their splines part by no more than 1e-4 of the size.
/// `unit` is one of a CadReport; empty: millimetres.
/// By temporary file and rename.
/// Throws   IoError naming the file; InputError for patches of polygons and curves.
void write_step(const std::filesystem::path& file, const Patches& patches,
                const std::string& unit = {});

}  // namespace vdb_offset
