#pragma once

#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "vdb_offset/io/cad.h"

namespace vdb_offset::cad {

/// A face and what the file calls it.
struct NamedFace {
  TopoDS_Face face;
  std::string name;         ///< empty: none
  std::string family;       ///< empty: none
  int number = 0;           ///< in the file, from 1, those of solids first
  int body = 0;             ///< closed parts count from 1; 0: of an open one
  std::string closed = {};  ///< that it is of, as the file has it: "solid"; empty: nothing
};

/// A model, healed and sewn, without loose faces that lie on closed parts; lengths in millimetres.
struct Model {
  TopoDS_Shape shape;
  std::vector<NamedFace> faces;
  double world_per_cad = 1;  ///< the file's units
  double size_cad = 0;       ///< longest side of the box around it
};

/// An edge of one face, seams and poles aside.
bool is_free(const TopoDS_Edge& edge, const TopTools_ListOfShape& faces);

/// Throws IoError, InputError as `read_cad`; fills the report's unit, faces and mending.
Model read_model(const std::string& file, CadReport& report);

}  // namespace vdb_offset::cad
