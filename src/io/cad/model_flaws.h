#pragma once

#include "io/cad/cad_shape.h"

namespace vdb_offset::cad {

/// What is wrong with a model as it is sewn, in words: closed shells and solids of the file that
/// are open, edges that lie far off the surface of their face, kinks within faces.
std::vector<std::string> flaws_of(const Model& model);

}  // namespace vdb_offset::cad
