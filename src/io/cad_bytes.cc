#include "io/cad_bytes.h"

#include <utility>

#include "io/byte_way.h"

namespace vdb_offset::cad {
namespace {

template <typename Way, typename Report>
void pass_report(Way& way, Report& report) {
  way(report.unit);
  way(report.file_unit);
  for (auto* count : {&report.faces, &report.four_sided, &report.split, &report.triangulated,
                      &report.sewn_edges, &report.healed_faces, &report.free_edges}) {
    way(*count);
  }
  way(report.size_world);
  way.each(report.lying_faces, [](auto& to, auto& text) { to(text); });
  way.each(report.flaws, [](auto& to, auto& text) { to(text); });
}

template <typename Way, typename PatchLike>
void pass_patch(Way& way, PatchLike& patch) {
  way(patch.name);
  way(patch.family);
  way(patch.file);
  way(patch.body);
  way(patch.ni);
  way(patch.nj);
  way.list(patch.points_world);
  way.list(patch.faces);
}

template <typename Way, typename SurfaceLike>
void pass(Way& way, SurfaceLike& surface) {
  pass_report(way, surface.report);
  way.each(surface.patches, [](auto& to, auto& patch) { pass_patch(to, patch); });
}

}  // namespace

std::string to_bytes(const CadSurface& surface) {
  ByteWriter out;
  pass(out, surface);
  return std::move(out.bytes);
}

CadSurface from_bytes(const std::string& bytes) {
  CadSurface surface;
  ByteReader in(bytes);
  pass(in, surface);
  return surface;
}

}  // namespace vdb_offset::cad
