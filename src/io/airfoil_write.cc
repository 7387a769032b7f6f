#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "io/output_file.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/airfoil.h"

namespace vdb_offset {
namespace {

bool is_plane_curve(const Patch& patch) {
  return patch.nj == 1 && patch.ni >= 2 &&
         patch.points_world.size() == static_cast<std::size_t>(patch.ni) &&
         std::ranges::all_of(patch.points_world, [](const Vec3& p) { return p.z() == 0; });
}

/// One loop, or one and its base.
bool is_body(const Patches& patches) {
  if (patches.empty() || patches.size() > 2) return false;
  if (!std::ranges::all_of(patches, is_plane_curve)) return false;
  const Vec3List& loop = patches[0].points_world;
  if (patches.size() == 1) return loop.front() == loop.back();
  const Vec3List& base = patches[1].points_world;
  return base.front() == loop.back() && base.back() == loop.front();
}

}  // namespace

void write_airfoil(const std::filesystem::path& file, const Patches& patches) {
  if (!is_body(patches)) {
    throw InputError(fmt::format(
        "{}: an airfoil's coordinates are one closed curve in z = 0, or one and the base from its "
        "end to its beginning, and there {} {} patch{}; write PLOT3D instead",
        file.string(), patches.size() == 1 ? "is" : "are", patches.size(),
        patches.size() == 1 ? " that is none" : "es"));
  }
  OutputFile output(file);
  const std::string& family = patches[0].family;
  fmt::memory_buffer text;
  // Beginning with a letter, so that nobody takes the name for numbers.
  fmt::format_to(std::back_inserter(text), "airfoil {}\n", family);
  for (const Vec3& p : patches[0].points_world) {
    fmt::format_to(std::back_inserter(text), "{:24.16e}{:25.16e}\n", p.x(), p.y());
  }
  output.stream().write(text.data(), static_cast<std::streamsize>(text.size()));
  output.commit();
}

}  // namespace vdb_offset
