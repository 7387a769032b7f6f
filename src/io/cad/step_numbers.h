#pragma once

#include <string>

namespace vdb_offset::cad {

/// Throws IoError naming line and entity of the first number in a STEP file that is none (as
/// printf has them, "NAN" or "-1.#IND"), or whose square overflows: OpenCASCADE goes round in
/// circles with such coordinates.
void check_step_numbers(const std::string& file);

}  // namespace vdb_offset::cad
