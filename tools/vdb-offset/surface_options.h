#pragma once

#include <string>
#include <vector>

#include "inputs.h"
#include "options.h"

namespace vdb_offset::command {

/// The options of the surface stage.
std::vector<OptionField> surface_fields();

/// "x=0:symmetry" or "0,0,1/0,0.5,1". Throws InputError with the forms that are read.
NamedPlane parse_plane(const std::string& text);

/// "hub:distance=0.1,first-cell=1e-4" or "inlet:layers=off". Throws InputError with the forms.
FamilyLayers parse_family(const std::string& text);

/// "hub:inviscid-wall". Throws InputError with the kinds.
NamedCondition parse_named_condition(const std::string& text);

/// A surface's file, and its name, which is the file's if none is given.
struct ShapeText {
  std::string file, name;
};
/// "fuselage.xyz:body". Throws InputError with the forms; `option` says of what.
ShapeText parse_shape(const std::string& option, const std::string& text);

/// The patches of the file, lengths of a CAD file converted to the unit; if there is none yet, its
/// own becomes it.
NamedShape read_shape(const ShapeText& text, const InputFormat& format, std::string& length_unit);

}  // namespace vdb_offset::command
