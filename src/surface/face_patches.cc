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

std::string text_of(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

[[noreturn]] void refuse(const PolygonMesh& mesh, std::string_view what, std::string_view advice) {
  throw InputError(fmt::format("{}: {}; {}, or take 'field', which needs distances alone",
                               name_of(mesh), what, advice));
}

const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

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

void refuse_unmeshable(const PolygonMesh& mesh, const CleanReport& report) {
  if (!report.crossed_faces.empty()) {
    const PolygonFlaw& first = report.crossed_faces.front();
    const std::size_t count = report.crossed_faces.size();
    refuse(
        mesh,
        fmt::format("{} face{} that cross themselves, as a bow tie does, the first face {}, whose "
                    "edge from {} to {} another one crosses",
                    count, plural(count), first.face, text_of(first.from_world),
                    text_of(first.to_world)),
        "give the corners of each in the order that they have around it (of four, exchange two "
        "that follow one another)");
  }
  if (!report.many_faced_edges.empty()) {
    const PolygonFlaw& first = report.many_faced_edges.front();
    const std::size_t count = report.many_faced_edges.size();
    refuse(
        mesh,
        fmt::format("{} edge{} of more than two faces, the first of {} from {} to {}, and a wall "
                    "has one or two",
                    count, plural(count), first.count, text_of(first.from_world),
                    text_of(first.to_world)),
        "remove inner and doubled faces there");
  }
  if (!report.many_fan_points.empty()) {
    const PolygonFlaw& first = report.many_fan_points.front();
    const std::size_t count = report.many_fan_points.size();
    refuse(
        mesh,
        fmt::format("{} point{} where parts touch in a point alone, the first of {} parts at {}, "
                    "and the faces at a point of a wall go round it in one fan",
                    count, plural(count), first.count, text_of(first.from_world)),
        "join the parts along an edge, or move them apart");
  }
  if (report.twisted_edges.empty()) return;
  const PolygonFlaw& first = report.twisted_edges.front();
  const std::size_t count = report.twisted_edges.size();
  refuse(
      mesh,
      fmt::format("{} part{} with one side only, as a Moebius strip has, seen from {} to {}, and "
                  "a wall has two",
                  count, plural(count), text_of(first.from_world), text_of(first.to_world)),
      "cut it open there");
}

Patches face_patches(const PolygonMesh& mesh) { return PatchMaker(mesh).make(); }

}  // namespace vdb_offset
