#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Edges of one cell alone that a tolerance leaves, or nothing where the surface is none with it.
using JudgeWeld = std::function<std::optional<std::size_t>(double)>;

/// What another tolerance than `weld` would do for a surface that is none: of those that leave the
/// fewest edges of one cell the largest smaller one, else the least larger one. To stand behind the
/// message; empty where none makes it sound. Smaller ones are tried only where points moved.
std::string weld_advice(double weld, bool has_moved, const JudgeWeld& judge);

/// The same for patches that cannot be oriented; nothing of polygons, whose faces are gone.
std::string weld_advice(const Patches& unwelded, double weld);

}  // namespace vdb_offset
