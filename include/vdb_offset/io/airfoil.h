#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// How an airfoil's coordinates are put down in a text file, one point `x y` a line.
enum class AirfoilForm {
  Selig,     ///< one loop, from the trailing edge round the nose and back
  Lednicer,  ///< a line of two counts, the upper surface from the nose back, then the lower
  Halves,    ///< two surfaces as in Lednicer, a blank line between, and no counts
};

/// "Selig, one loop from the trailing edge".
std::string describe(AirfoilForm form);

/// What `info` prints of such a file.
struct AirfoilInfo {
  AirfoilForm form = AirfoilForm::Selig;
  std::string title;         ///< the name line; empty: none
  std::size_t points = 0;    ///< in the file, of the body
  std::size_t repeated = 0;  ///< dropped, because they repeat the point before them
  bool turned = false;       ///< it was clockwise
  bool blunt = false;        ///< has a base
  bool end_added = false;    ///< the last point, missing in the file, is the first one again
  double gap_world = 0.0;    ///< between the file's first and last point
  double chord_world = 0.0;  ///< from the middle of the trailing edge to the farthest point
};

AirfoilInfo inspect_airfoil(const std::filesystem::path& file);

/// Read one body: curves (see Patch) that run counter-clockwise from the trailing edge, z = 0,
/// units as in the file; a clockwise file is turned round.
///
/// In       text, see AirfoilForm; in front of the numbers there may be one line with the name;
///          blanks, tabs and commas separate, `-.5`, `1.0D-3` are numbers; lines that begin with
///          '#', '!' or '%' are passed over. Two surfaces are put together where their first points
///          meet; where the second goes on at the end of the first, they are one loop.
/// Out      "airfoil", of the file's stem as family, and for a blunt trailing edge also
///          "trailing edge", of that family: the straight base, in cells as long as their
///          neighbours, to a whole number of them. They share end points bit for bit. A sharp
///          trailing edge gives one closed curve. Points that repeat the one before them (within
///          1e-9 of the body's size) are dropped.
/// Ends     that are nearer than 1e-5 of the body's size, and a tenth of the edges beside them, are
///          one point (their mean). Else the gap is a base if it turns off by more than 30 degrees
///          at both of its ends and is no longer than a fifth of the body: it goes across. Any
///          other gap is a closing point that the file lacks, and the curve is closed by a straight
///          edge.
/// Memory   a small multiple of the file's length.
/// Throws   IoError naming file, line and value: a number that is none or not finite, counts that
///          do not fit, points that enclose nothing.
Patches read_airfoil(const std::filesystem::path& file);

/// Write a body as Selig's loop, 17 significant digits, "airfoil" and the family as name line; by
/// temporary file and rename. In: "airfoil" alone, closed, or with its base as a second patch,
/// whose inner points are not written (reading makes them again). Throws InputError if `patches` is
/// not that, or not in z = 0.
void write_airfoil(const std::filesystem::path& file, const Patches& patches);

}  // namespace vdb_offset
