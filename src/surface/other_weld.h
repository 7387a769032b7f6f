#pragma once

#include <functional>
#include <string>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// What another tolerance than `weld` would do for a surface that is none: the largest of some
/// smaller ones for which `is_sound` holds, else the least of some larger ones. To stand behind the
/// message; empty where none does. Smaller ones are asked for only where points moved.
std::string weld_advice(double weld, bool has_moved, const std::function<bool(double)>& is_sound);

/// The same for patches that cannot be oriented; nothing of polygons, whose faces are gone.
std::string weld_advice(const Patches& unwelded, double weld);

}  // namespace vdb_offset
