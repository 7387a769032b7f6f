#pragma once

#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace vdb_offset::cad {

/// What a file holds, as OpenCASCADE reads it. Its lengths, `_cad`, are millimetres, or of a model
/// that would be very small or large units in which it is not; of a BREP file those of the file.
struct Contents {
  TopoDS_Shape shape;
  std::string unit;          ///< of the file, as "mm"; empty: none
  double world_per_cad = 1;  ///< its unit of length to that of the file
  /// The file's name for a face or a body, and its colour as "#rrggbb"; empty: none.
  std::function<std::string(const TopoDS_Shape&)> name_of;
  std::function<std::string(const TopoDS_Shape&)> colour_of;
  /// What the file calls closed that a face is of, as "closed shell #16"; empty: nothing.
  std::function<std::string(const TopoDS_Shape&)> closed_of;
  std::vector<std::string> losses;  ///< faces that are not in the shape, in words
};

/// Of the box around a shape; 0 where it has no size, or no end.
double longest_side(const TopoDS_Shape& shape);

/// Throws IoError naming the file.
Contents read_contents(const std::string& file);

/// A unit of length.
struct Length {
  std::string_view in_file;  ///< as files call it, in small letters
  std::string_view name;
  double mm;
  const char* step_name;  ///< as OpenCASCADE's STEP writer calls it
};

/// By either name; millimetres for one that is not known.
const Length& length_of(std::string_view name);

/// Keeps OpenCASCADE from printing, for good.
void keep_quiet();

}  // namespace vdb_offset::cad
