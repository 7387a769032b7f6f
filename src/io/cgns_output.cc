#include "io/cgns_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <limits>

#include "vdb_offset/core/error.h"
#include "vdb_offset/core/version.h"

namespace vdb_offset {
namespace {

constexpr std::array<const char*, 3> kCoordinates{"CoordinateX", "CoordinateY", "CoordinateZ"};

// What the library takes for nodes beside the coordinates, by far.
constexpr std::uint64_t kFileBytes = 64 << 10U;
constexpr std::uint64_t kZoneBytes = 32 << 10U;
constexpr std::uint64_t kPlaceBytes = 8 << 10U;

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

CgnsOutput::CgnsOutput(const std::filesystem::path& file, const Content& content,
                       const CgnsWriteOptions& options)
    : lock_(cgns_mutex()), name_(file.string()), output_(file) {
  try {
    open(content, options);
  } catch (...) {
    give_up();
    throw;
  }
}

CgnsOutput::~CgnsOutput() { give_up(); }

void CgnsOutput::open(const Content& content, const CgnsWriteOptions& options) {
  const std::uint64_t bytes = kFileBytes + content.points * sizeof(Vec3) +
                              content.zones * kZoneBytes + content.places * kPlaceBytes;
  reserve(bytes, /*keep_size=*/false);
  check(cg_set_file_type(CG_FILE_HDF5));
  int index = -1;
  check(cg_open(output_.part().c_str(), CG_MODE_WRITE, &index));
  index_ = index;
  reserve(bytes, /*keep_size=*/true);  // opening made the file anew
  check(cg_base_write(index_, "Base", content.cell_dimension, 3, &base_));
  write_units(options.length_unit);
}

/// HDF5 does not get over a write that fails: what it could not write makes its end crash. So the
/// room is taken first, on file systems that can.
void CgnsOutput::reserve(std::uint64_t bytes, bool keep_size) const {
  const int file = ::open(output_.part().c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  const int mode = keep_size ? FALLOC_FL_KEEP_SIZE : 0;
  const int error = ::fallocate(file, mode, 0, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
  ::close(file);
  if (error != ENOSPC && error != EDQUOT && error != EFBIG) return;
  throw IoError(
      fmt::format("{}: there is no room for its {} bytes: {}", name_, bytes, std::strerror(error)));
}

/// Closing writes what is left: room is made for it by what will be removed anyway.
void CgnsOutput::give_up() noexcept {
  if (index_ < 0) return;
  if (::truncate(output_.part().c_str(), 0) == 0) cg_close(index_);
  index_ = -1;
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
  check(cg_close(index_));
  index_ = -1;
  output_.commit();
}

}  // namespace vdb_offset
