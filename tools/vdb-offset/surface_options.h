#pragma once

#include <string>
#include <vector>

#include "options.h"
#include "vdb_offset/io/plot3d.h"

namespace vdb_offset::command {

/// The options of the surface stage.
std::vector<OptionField> surface_fields();

/// "x=0:symmetry" or "0,0,1/0,0.5,1". Throws InputError with the forms that are read.
NamedPlane parse_plane(const std::string& text);

/// "fuselage.xyz:body": the patches of a file, and the name, which is the file's if none is given.
NamedShape read_shape(const std::string& text, const Plot3dHint& hint);

}  // namespace vdb_offset::command
