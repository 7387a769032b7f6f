#include "io/cgns_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "vdb_offset/core/error.h"
#include "vdb_offset/core/version.h"

namespace vdb_offset {
namespace {

constexpr std::array<const char*, 3> kCoordinates{"CoordinateX", "CoordinateY", "CoordinateZ"};

LengthUnits_t unit_of(const std::string& text) {
  const auto lower = [](std::string s) {
    std::ranges::transform(
        s, s.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return s;
  };
  constexpr std::array kUnits{CGNS_ENUMV(Meter), CGNS_ENUMV(Centimeter), CGNS_ENUMV(Millimeter),
                              CGNS_ENUMV(Foot), CGNS_ENUMV(Inch)};
  for (const LengthUnits_t unit : kUnits) {
    if (lower(LengthUnitsName[unit]) == lower(text)) return unit;
  }
  throw InputError(fmt::format(
      "write_cgns: '{}' is no unit of length; use Meter, Centimeter, Millimeter, Foot, Inch",
      text));
}

}  // namespace

std::mutex& cgns_mutex() {
  static std::mutex mutex;
  return mutex;
}

void check_cgns_size(const std::filesystem::path& file, const std::string& name,
                     std::size_t points) {
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<cgsize_t>::max());
  if (points <= kMost) return;
  throw IoError(fmt::format(
      "{}: '{}' has {} points, and this libcgns counts to {}; split the patch, or write PLOT3D",
      file.string(), name, points, kMost));
}

CgnsOutput::CgnsOutput(const std::filesystem::path& file, int cell_dimension,
                       const CgnsWriteOptions& options)
    : lock_(cgns_mutex()), name_(file.string()), output_(file) {
  check(cg_set_file_type(CG_FILE_HDF5));
  int index = -1;
  check(cg_open(output_.part().c_str(), CG_MODE_WRITE, &index));
  index_ = index;
  try {
    check(cg_base_write(index_, "Base", cell_dimension, 3, &base_));
    write_units(options.length_unit);
  } catch (...) {
    cg_close(index_);
    throw;
  }
}

CgnsOutput::~CgnsOutput() {
  if (index_ >= 0) cg_close(index_);
}

void CgnsOutput::check(int code) const {
  if (code == CG_OK) return;
  throw IoError(
      fmt::format("{}: libcgns cannot write it: {} (is the disk full?)", name_, cg_get_error()));
}

void CgnsOutput::write_units(const std::string& unit) const {
  check(cg_goto(index_, base_, "end"));
  check(cg_descriptor_write("Creator", (std::string("vdb-offset ") + kVersion).c_str()));
  if (unit.empty()) {
    check(cg_dataclass_write(CGNS_ENUMV(NormalizedByUnknownDimensional)));
    return;
  }
  check(cg_dataclass_write(CGNS_ENUMV(Dimensional)));
  check(cg_units_write(CGNS_ENUMV(Kilogram), unit_of(unit), CGNS_ENUMV(Second), CGNS_ENUMV(Kelvin),
                       CGNS_ENUMV(Degree)));
}

void CgnsOutput::write_coordinates(int zone, const Slab& slab) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    int coordinate = 0;
    check(cg_coord_partial_write(index_, base_, zone, CGNS_ENUMV(RealDouble), kCoordinates[axis],
                                 slab.first.data(), slab.last.data(), slab.coordinates[axis].data(),
                                 &coordinate));
  }
}

void CgnsOutput::say_lengths(int zone) const {
  constexpr std::array<float, 5> kLength{0, 1, 0, 0, 0};  // of mass, length, time, ...
  for (const char* name : kCoordinates) {
    check(cg_goto(index_, base_, "Zone_t", zone, "GridCoordinates_t", 1, name, 0, "end"));
    check(cg_exponents_write(CGNS_ENUMV(RealSingle), kLength.data()));
  }
}

void CgnsOutput::commit() {
  const int index = index_;
  index_ = -1;
  check(cg_close(index));
  output_.commit();
}

}  // namespace vdb_offset
