#include <map>

#include "io/cgns_output.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {
namespace {

/// The walls that the patches name, each with its name in the file.
std::map<std::string, std::string> write_families(CgnsOutput& out, const Patches& patches) {
  std::map<std::string, std::string> families;
  for (const Patch& patch : patches) {
    if (patch.family.empty()) continue;
    const auto [found, is_new] = families.try_emplace(patch.family);
    if (!is_new) continue;
    found->second = out.name(patch.family);
    int family = 0;
    int condition = 0;
    out.check(cg_family_write(out.file(), out.base(), found->second.c_str(), &family));
    out.check(cg_fambc_write(out.file(), out.base(), family, "FamBC", CGNS_ENUMV(BCWallViscous),
                             &condition));
  }
  return families;
}

int write_zone(CgnsOutput& out, const Patch& patch) {
  const std::array<cgsize_t, 6> size{patch.ni, patch.nj, patch.ni - 1, patch.nj - 1, 0, 0};
  int zone = 0;
  out.check(cg_zone_write(out.file(), out.base(), out.name(patch.name).c_str(), size.data(),
                          CGNS_ENUMV(Structured), &zone));
  std::array<std::vector<double>, 3> coordinates;
  for (const Vec3& p : patch.points_world) {
    for (std::size_t a = 0; a < 3; ++a) {
      coordinates[a].push_back(p[static_cast<Eigen::Index>(a)]);
    }
  }
  out.write_coordinates(zone, {{1, 1, 1}, {patch.ni, patch.nj, 1}, coordinates});
  out.say_lengths(zone);
  return zone;
}

}  // namespace

void write_cgns(const std::filesystem::path& file, const Patches& patches,
                const CgnsWriteOptions& options) {
  CgnsOutput::Content content{2, 0, patches.size(), 0};
  for (const Patch& patch : patches) {
    check_cgns_size(file, patch.name, patch.points_world.size());
    content.points += patch.points_world.size();
    if (patch.nj > 1) continue;
    throw InputError(file.string() + ": '" + patch.name +
                     "' is a curve, and CGNS is written of surfaces; write PLOT3D or .dat");
  }
  CgnsOutput out(file, content, options);
  const std::map<std::string, std::string> families = write_families(out, patches);
  for (const Patch& patch : patches) {
    const int zone = write_zone(out, patch);
    if (patch.family.empty()) continue;
    out.check(cg_goto(out.file(), out.base(), "Zone_t", zone, "end"));
    out.check(cg_famname_write(families.at(patch.family).c_str()));
  }
  out.commit();
}

}  // namespace vdb_offset
