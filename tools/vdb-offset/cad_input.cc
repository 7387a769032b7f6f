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
  std::string_view cgns;   ///< empty: it has none
  std::string_view words;  ///< of several
};

constexpr std::array<Unit, 9> kUnits{{{"m", "Meter", "metres"},
                                      {"cm", "Centimeter", "centimetres"},
                                      {"mm", "Millimeter", "millimetres"},
                                      {"ft", "Foot", "feet"},
                                      {"in", "Inch", "inches"},
                                      {"km", "", "kilometres"},
                                      {"um", "", "micrometres"},
                                      {"mi", "", "miles"},
                                      {"mil", "", "mils"}}};

/// What is open is said of the surface, whose welding closes more than sewing does.
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
  add(report.turned_parts, "closed parts turned, normals outward");
  return fmt::format("{} face{}: {}", report.faces, report.faces == 1 ? "" : "s",
                     fmt::join(words, ", "));
}

}  // namespace

Patches read_cad_surface(const std::string& file, const CadOptions& options, CadWords& words) {
  CadSurface surface = read_cad(file, options);
  const CadReport& report = surface.report;
  const auto found = std::ranges::find(kUnits, report.unit, &Unit::cad);
  words.note =
      fmt::format("{}: {}; lengths in {}, edges up to {:.4g}", file, in_words(report),
                  found == kUnits.end() ? "the file's unit" : found->words, report.size_world);
  for (const std::string& lying : report.lying_faces) {
    words.warnings.push_back(fmt::format("{}: {}, and is left out", file, lying));
  }
  for (const std::string& flaw : report.flaws) {
    words.warnings.push_back(fmt::format("{}: {}", file, flaw));
  }
  words.length_unit = found == kUnits.end() ? std::string() : std::string(found->cgns);
  return std::move(surface.patches);
}

std::string cad_unit(const std::string& length_unit) {
  if (length_unit.empty()) return {};
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
