#include "io/cad_bytes.h"

#include <cstring>
#include <type_traits>
#include <utility>

namespace vdb_offset::cad {
namespace {

/// Puts values behind one another, or takes them from there, so that both ways are one list.
class Out {
 public:
  std::string bytes;

  template <typename T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void operator()(const std::string& text) {
    (*this)(text.size());
    bytes += text;
  }
  template <typename T>
  void list(const std::vector<T>& values) {
    (*this)(values.size());
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
};

class In {
 public:
  explicit In(const std::string& bytes) : at_(bytes.data()) {}

  template <typename T>
  void operator()(T& value) {
    take(&value, sizeof value);
  }
  void operator()(std::string& text) {
    std::size_t size = 0;
    (*this)(size);
    text.resize(size);
    take(text.data(), size);
  }
  template <typename T>
  void list(std::vector<T>& values) {
    std::size_t size = 0;
    (*this)(size);
    values.resize(size);
    take(values.data(), size * sizeof(T));
  }

 private:
  void take(void* to, std::size_t size) {
    if (size > 0) std::memcpy(to, at_, size);
    at_ += size;
  }
  const char* at_;
};

template <typename Way, typename Report>
void pass_report(Way& way, Report& report) {
  way(report.unit);
  for (auto* count : {&report.faces, &report.four_sided, &report.split, &report.triangulated,
                      &report.sewn_edges, &report.healed_faces, &report.free_edges}) {
    way(*count);
  }
  way(report.size_world);
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

}  // namespace

std::string to_bytes(const CadSurface& surface) {
  Out out;
  pass_report(out, surface.report);
  out(surface.patches.size());
  for (const Patch& patch : surface.patches) pass_patch(out, patch);
  return std::move(out.bytes);
}

CadSurface from_bytes(const std::string& bytes) {
  CadSurface surface;
  In in(bytes);
  pass_report(in, surface.report);
  std::size_t patches = 0;
  in(patches);
  surface.patches.resize(patches);
  for (Patch& patch : surface.patches) pass_patch(in, patch);
  return surface;
}

}  // namespace vdb_offset::cad
