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
  std::string_view name;   ///< as CGNS calls it, or would
  std::string_view words;  ///< of several
  bool is_in_cgns = true;
};

constexpr std::array<Unit, 9> kUnits{{{"m", "Meter", "metres"},
                                      {"cm", "Centimeter", "centimetres"},
                                      {"mm", "Millimeter", "millimetres"},
                                      {"ft", "Foot", "feet"},
                                      {"in", "Inch", "inches"},
                                      {"km", "Kilometer", "kilometres", false},
                                      {"um", "Micrometer", "micrometres", false},
                                      {"mi", "Mile", "miles", false},
                                      {"mil", "Mil", "mils", false}}};

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

const Unit* unit_by(std::string_view Unit::*what, std::string_view word) {
  const auto found = std::ranges::find(kUnits, word, what);
  return found == kUnits.end() ? nullptr : &*found;
}

std::string lengths_in_words(const CadReport& report) {
  const Unit* unit = unit_by(&Unit::cad, report.unit);
  const Unit* own = unit_by(&Unit::cad, report.file_unit);
  if (unit == nullptr || own == nullptr) return "lengths in the file's unit";
  if (unit == own) return fmt::format("lengths in {}", own->words);
  return fmt::format("lengths converted from {} to {}", own->words, unit->words);
}

}  // namespace

Patches read_cad_surface(const std::string& file, CadOptions options, CadWords& words) {
  options.unit = cad_unit(words.length_unit);
  CadSurface surface = read_cad(file, options);
  const CadReport& report = surface.report;
  const Unit* unit = unit_by(&Unit::cad, report.unit);
  words.length_unit = unit == nullptr ? std::string() : std::string(unit->name);
  words.note = fmt::format("{}: {}; {}, edges up to {:.4g}", file, in_words(report),
                           lengths_in_words(report), report.size_world);
  for (const std::string& lying : report.lying_faces) {
    words.warnings.push_back(fmt::format("{}: {}, and is left out", file, lying));
  }
  for (const std::string& flaw : report.flaws) {
    words.warnings.push_back(fmt::format("{}: {}", file, flaw));
  }
  return std::move(surface.patches);
}

std::string cad_unit(const std::string& length_unit) {
  const Unit* unit = unit_by(&Unit::name, length_unit);
  return unit == nullptr ? std::string() : std::string(unit->cad);
}

std::string cgns_unit(const std::string& length_unit) {
  const Unit* unit = unit_by(&Unit::name, length_unit);
  return unit == nullptr || unit->is_in_cgns ? length_unit : std::string();
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
