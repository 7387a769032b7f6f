#include "vdb_offset/io/cad.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <system_error>

#include "io/apart.h"
#include "io/cad_bytes.h"
#include "io/cad_module.h"
#include "io/output_file.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/turn_round.h"

namespace vdb_offset {
namespace {

namespace fs = std::filesystem;

/// Where the module may be: beside what this is linked into, or where it was to be installed.
std::vector<fs::path> module_places() {
  std::vector<fs::path> places;
  Dl_info self{};
  if (::dladdr(reinterpret_cast<const void*>(&has_cad), &self) != 0 && self.dli_fname != nullptr) {
    places.push_back(fs::path(self.dli_fname).parent_path());
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (!error) {
    places.push_back(program / "..");
    places.push_back(program / ".." / VDB_OFFSET_LIBDIR);
  }
  places.emplace_back(VDB_OFFSET_FULL_LIBDIR);
  return places;
}

/// A function of the module, loaded for good: for a process apart. `file` is named in messages.
template <typename Function>
Function* function_of_module(const char* name, const std::string& file) {
  std::string why;
  for (const fs::path& place : module_places()) {
    const fs::path module = place / cad::kModuleName;
    std::error_code error;
    if (!fs::exists(module, error)) continue;
    void* const loaded = ::dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const found = loaded != nullptr ? ::dlsym(loaded, name) : nullptr;
    if (found != nullptr) return reinterpret_cast<Function*>(found);
    if (const char* said = ::dlerror(); said != nullptr) why = said;
  }
  throw IoError(fmt::format("{}: CAD files need {}, which is {}", file, cad::kModuleName,
                            why.empty() ? "not beside the program" : "not to be loaded: " + why));
}

Apart by_opencascade(const fs::path& file, unsigned cpu_seconds) {
  return {file.string(), "OpenCASCADE", "mend it in a CAD program", cpu_seconds};
}

/// A closed part of the model.
struct Part {
  double volume = 0;  // negative where normals point inward
  Box box;
};

std::map<int, Part> closed_parts(const Patches& patches) {
  std::map<int, Part> parts;
  for (const Patch& patch : patches) {
    if (patch.body == 0) continue;
    Part& part = parts[patch.body];
    for (const Vec3& p : patch.points_world) part.box.add(p);
  }
  for (const Patch& patch : patches) {
    if (patch.body == 0) continue;
    Part& part = parts[patch.body];
    const auto point = [&](int n) -> Vec3 {
      return patch.points_world[static_cast<std::size_t>(n)] - part.box.lo;
    };
    for_cells(patch, [&](const std::array<int, 4>& c) {
      const Vec3 diagonal = point(c[2]);
      part.volume += point(c[0]).dot(point(c[1]).cross(diagonal)) / 6;
      part.volume += point(c[0]).dot(diagonal.cross(point(c[3]))) / 6;
    });
  }
  return parts;
}

/// Turns closed parts whose normals point inward, as those of polygons are, but for cavities, which
/// lie within others; how many.
int turn_outward(Patches& patches) {
  const std::map<int, Part> parts = closed_parts(patches);
  const auto is_within = [](const Box& inner, const Box& outer) {
    return (inner.lo.array() >= outer.lo.array()).all() &&
           (inner.hi.array() <= outer.hi.array()).all();
  };
  int turned = 0;
  for (const auto& [body, part] : parts) {
    const bool is_cavity = std::ranges::any_of(parts, [&](const auto& other) {
      return other.first != body && is_within(part.box, other.second.box);
    });
    if (!(part.volume < 0) || is_cavity) continue;
    ++turned;
    for (Patch& patch : patches) {
      if (patch.body == body) turn_round(patch);
    }
  }
  return turned;
}

}  // namespace

void CadOptions::validate() const {
  if (!(size_world >= 0) || !std::isfinite(size_world)) {
    throw InputError(
        fmt::format("CadOptions::size_world = {}, but must be a number >= 0", size_world));
  }
  if (!(turn > 0 && turn <= std::numbers::pi / 2)) {
    throw InputError(fmt::format("CadOptions::turn = {}, but must be in (0, pi/2]", turn));
  }
}

#ifdef VDB_OFFSET_HAS_CAD
bool has_cad() { return true; }
#else
bool has_cad() { return false; }
#endif

void require_step(const fs::path& file) {
  if (!has_cad()) {
    throw IoError(file.string() + ": STEP is not written by this build, which has no OpenCASCADE");
  }
  constexpr unsigned kSeconds = 60;
  const auto find = [&] {
    function_of_module<decltype(cad::vdb_offset_cad_write)>("vdb_offset_cad_write", file.string());
    return std::string();
  };
  run_apart(find, by_opencascade(file, kSeconds));
}

CadSurface read_cad(const std::string& file, const CadOptions& options) {
  options.validate();
  if (!has_cad()) {
    throw IoError(file + ": is a CAD file, and this build is one without OpenCASCADE");
  }
  std::error_code error;
  const auto bytes = fs::file_size(file, error);
  if (error) throw IoError(file + ": cannot be read: " + error.message());
  // A megabyte of STEP takes a second or two.
  const auto seconds = static_cast<unsigned>(120 + std::min<std::uintmax_t>(bytes >> 14U, 100000));
  const auto read = [&] {
    std::string surface;
    function_of_module<decltype(cad::vdb_offset_cad_read)>("vdb_offset_cad_read", file)(
        file, options, surface);
    return surface;
  };
  CadSurface surface = cad::from_bytes(run_apart(read, by_opencascade(file, seconds)));
  for (Patch& patch : surface.patches) patch.loose = patch.body == 0;
  surface.report.turned_parts = turn_outward(surface.patches);
  return surface;
}

void write_step(const fs::path& file, const Patches& patches, const std::string& unit) {
  require_step(file);
  constexpr unsigned kSeconds = 3600;
  OutputFile output(file);
  const auto write = [&] {
    function_of_module<decltype(cad::vdb_offset_cad_write)>("vdb_offset_cad_write", file.string())(
        output.part().string(), file.string(), patches, unit);
    return std::string();
  };
  run_apart(write, by_opencascade(file, kSeconds));
  output.commit();
}

}  // namespace vdb_offset
