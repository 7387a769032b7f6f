#include "cad_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace vdb_offset::command {
namespace {

struct Unit {
  std::string_view cad;
  std::string_view cgns;
};

constexpr std::array<Unit, 5> kUnits{
    {{"m", "Meter"}, {"cm", "Centimeter"}, {"mm", "Millimeter"}, {"ft", "Foot"}, {"in", "Inch"}}};

std::string in_words(const CadReport& report) {
  std::vector<std::string> words;
  const auto add = [&](int count, const char* what) {
    if (count > 0) words.push_back(fmt::format("{} {}", count, what));
  };
  add(report.four_sided, "a patch each");
  add(report.split, "several patches each");
  add(report.triangulated, "triangles");
  add(report.healed_faces, "healed");
  add(report.sewn_edges, "edges sewn");
  add(report.free_edges, "edges open");
  add(report.turned_parts, "closed parts turned, normals outward");
  return fmt::format("{} face{}: {}", report.faces, report.faces == 1 ? "" : "s",
                     fmt::join(words, ", "));
}

}  // namespace

Patches read_cad_surface(const std::string& file, const CadOptions& options,
                         std::string& length_unit, std::vector<std::string>& notes) {
  CadSurface surface = read_cad(file, options);
  const CadReport& report = surface.report;
  notes.push_back(fmt::format("{}: {}; lengths in {}, edges up to {:.4g}", file, in_words(report),
                              report.unit.empty() ? "the file's unit" : report.unit,
                              report.size_world));
  const auto found = std::ranges::find(kUnits, report.unit, &Unit::cad);
  length_unit = found == kUnits.end() ? std::string() : std::string(found->cgns);
  return std::move(surface.patches);
}

std::string cad_unit(const std::string& length_unit) {
  const auto found = std::ranges::find(kUnits, length_unit, &Unit::cgns);
  return found == kUnits.end() ? std::string() : std::string(found->cad);
}

std::vector<std::string> cad_families(const Patches& patches) {
  std::vector<std::string> names;
  for (const Patch& patch : patches) {
    if (!patch.family.empty() && std::ranges::count(names, patch.family) == 0) {
      names.push_back(patch.family);
    }
  }
  return names;
}

}  // namespace vdb_offset::command
