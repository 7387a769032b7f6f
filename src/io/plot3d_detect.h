#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/plot3d_cursor.h"
#include "vdb_offset/io/plot3d.h"

namespace vdb_offset {

/// What to do about a file that does not fit, for messages.
inline constexpr std::string_view kPlot3dAdvice =
    "check that the file is whole, or force the dialect with --input-format";

/// A dialect that fits, its sizes, and a cursor at the first block's data.
template <class Cursor>
struct Plot3dCandidate {
  Plot3dDialect dialect;
  std::vector<Plot3dBlockSize> blocks;
  Cursor data;
};

/// The dialect that plot3d.h's rules choose for the file that `start` stands at the front of.
/// Throws IoError, with `name`, if none fits. For both cursors of plot3d_cursor.h.
template <class Cursor>
Plot3dCandidate<Cursor> detect_plot3d(const std::string& name, const Cursor& start,
                                      const Plot3dHint& hint);

}  // namespace vdb_offset
