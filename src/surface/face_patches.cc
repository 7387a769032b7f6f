#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/clean_polygons.h"

namespace vdb_offset {
namespace {

std::string name_of(const PolygonMesh& mesh) {
  return mesh.file.empty() ? "the surface" : mesh.file;
}

/// Patches while they grow, one a family.
class PatchMaker {
 public:
  explicit PatchMaker(const PolygonMesh& mesh)
      : mesh_(mesh),
        patches_(std::max<std::size_t>(mesh.families.size(), 1)),
        patch_of_(mesh.points_world.size(), -1),
        point_of_(mesh.points_world.size(), 0) {}

  Patches make();

 private:
  void add(Patch& patch, std::size_t face, int family);
  void name();

  const PolygonMesh& mesh_;
  Patches patches_;            // of each family
  std::vector<int> patch_of_;  // that a point was last put in, and where
  std::vector<int> point_of_;
};

void PatchMaker::add(Patch& patch, std::size_t face, int family) {
  const auto corners = mesh_.face(face);
  if (corners.size() < 3 || corners.size() > 4) {
    throw InputError(
        fmt::format("{}: face {} has {} corners; patches are made of triangles and "
                    "quads, as clean_polygons leaves them",
                    name_of(mesh_), face + 1, corners.size()));
  }
  std::array<int, 4> quad{};
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const auto point = static_cast<std::size_t>(corners[n]);
    if (patch_of_[point] != family) {
      patch_of_[point] = family;
      point_of_[point] = static_cast<int>(patch.points_world.size());
      patch.points_world.push_back(mesh_.points_world[point]);
    }
    quad[n] = point_of_[point];
    if (n == 2) quad[3] = quad[2];
  }
  patch.faces.push_back(quad);
}

/// Names are unique in a surface; what has none is counted.
void PatchMaker::name() {
  std::set<std::string> taken;
  int number = 0;
  for (std::size_t f = 0; f < patches_.size(); ++f) {
    Patch& patch = patches_[f];
    if (patch.faces.empty()) continue;
    ++number;
    if (f < mesh_.families.size()) patch.family = mesh_.families[f];
    const std::string wanted =
        patch.family.empty() ? fmt::format("patch {}", number) : patch.family;
    patch.name = wanted;
    for (int n = 2; !taken.insert(patch.name).second; ++n) {
      patch.name = fmt::format("{} {}", wanted, n);
    }
    patch.file = mesh_.file;
    patch.ni = static_cast<int>(patch.points_world.size());
    patch.nj = 0;
  }
}

Patches PatchMaker::make() {
  // Family by family, so that one table of points does for all.
  std::vector<std::vector<std::size_t>> faces(patches_.size());
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    faces[static_cast<std::size_t>(mesh_.family_of(f))].push_back(f);
  }
  for (std::size_t n = 0; n < patches_.size(); ++n) {
    for (const std::size_t f : faces[n]) add(patches_[n], f, static_cast<int>(n));
  }
  name();
  std::erase_if(patches_, [](const Patch& patch) { return patch.faces.empty(); });
  return std::move(patches_);
}

}  // namespace

Patches face_patches(const PolygonMesh& mesh) { return PatchMaker(mesh).make(); }

}  // namespace vdb_offset
