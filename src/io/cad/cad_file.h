#pragma once

#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace vdb_offset::cad {

/// What a file holds, as OpenCASCADE reads it: in millimetres.
struct Contents {
  TopoDS_Shape shape;
  std::string unit;  ///< of the file, as "mm"; empty: none
  double unit_mm = 1;
  /// The file's name for a face or a body, and its colour as "#rrggbb"; empty: none.
  std::function<std::string(const TopoDS_Shape&)> name_of;
  std::function<std::string(const TopoDS_Shape&)> colour_of;
  /// What the file calls closed that a face is of, as "closed shell #16"; empty: nothing.
  std::function<std::string(const TopoDS_Shape&)> closed_of;
  std::vector<std::string> losses;  ///< faces that are not in the shape, in words
};

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
