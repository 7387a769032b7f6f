#include "vdb_offset/blocks/conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

using Kind = ConditionKind;

struct Word {
  std::string_view word;  // empty: no word asks for it
  Kind kind;
  std::string_view cgns;
};

constexpr std::array<Word, 9> kWords{{{"wall", Kind::Wall, "BCWallViscous"},
                                      {"inviscid-wall", Kind::InviscidWall, "BCWallInviscid"},
                                      {"symmetry", Kind::Symmetry, "BCSymmetryPlane"},
                                      {"inflow", Kind::Inflow, "BCInflow"},
                                      {"outflow", Kind::Outflow, "BCOutflow"},
                                      {"farfield", Kind::Farfield, "BCFarfield"},
                                      {"overset", Kind::Overset, "UserDefined"},
                                      {"", Kind::Degenerate, "BCDegenerateLine"},
                                      {"", Kind::Unspecified, "FamilySpecified"}}};

/// The other types of the SIDS; each says more than its kind.
constexpr std::array<std::pair<std::string_view, Kind>, 17> kFurther{
    {{"BCWall", Kind::Wall},
     {"BCWallViscousHeatFlux", Kind::Wall},
     {"BCWallViscousIsothermal", Kind::Wall},
     {"BCSymmetryPolar", Kind::Other},
     {"BCAxisymmetricWedge", Kind::Other},
     {"BCInflowSubsonic", Kind::Inflow},
     {"BCInflowSupersonic", Kind::Inflow},
     {"BCTunnelInflow", Kind::Inflow},
     {"BCOutflowSubsonic", Kind::Outflow},
     {"BCOutflowSupersonic", Kind::Outflow},
     {"BCTunnelOutflow", Kind::Outflow},
     {"BCDegeneratePoint", Kind::Degenerate},
     {"BCDirichlet", Kind::Other},
     {"BCExtrapolate", Kind::Other},
     {"BCGeneral", Kind::Other},
     {"BCNeumann", Kind::Other},
     {"UserDefined", Kind::Other}}};

bool begins_with(const std::string& name, std::string_view start) {
  if (name.size() < start.size()) return false;
  return std::ranges::equal(name.substr(0, start.size()), start, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

const Condition* find(const ConditionOptions& options, const std::string& name) {
  const auto found = std::ranges::find(options.named, name, &NamedCondition::name);
  return name.empty() || found == options.named.end() ? nullptr : &found->condition;
}

std::string wall_name(const std::string& family) { return family.empty() ? "wall" : family; }

/// The wall itself: a patch's own condition, or its family's.
void set_wall(const Surface& surface, const ConditionOptions& options, BoundaryFace& face) {
  const Patch& patch = surface.patches[static_cast<std::size_t>(face.range.block)];
  face.name = wall_name(patch.family);
  face.condition = {Kind::Wall};
  if (const Condition* of_family = find(options, face.name)) face.condition = *of_family;
  for (const std::string& name : {patch.part_of, patch.name}) {
    const Condition* own = find(options, name);
    if (own == nullptr || name == face.name) continue;
    face.condition = *own;
    face.name = name;
  }
}

Condition usual(const Surface& surface, const std::string& boundary) {
  const std::vector<Boundary>& list = surface.boundaries->list();
  const auto found = std::ranges::find(list, boundary, &Boundary::name);
  if (found != list.end() && found->is_bare_wall()) return {Kind::Wall};
  if (found != list.end() && found->is_internal()) return {};  // flow on both sides
  const bool is_plane = found != list.end() && found->is_plane();
  const bool is_flat_plane =
      surface.flat && found < list.begin() + static_cast<std::ptrdiff_t>(Surface::kFlatPlanes);
  if (is_flat_plane || (is_plane && begins_with(boundary, "symmetry"))) return {Kind::Symmetry};
  if (begins_with(boundary, "inlet")) return {Kind::Inflow};
  if (begins_with(boundary, "outlet")) return {Kind::Outflow};
  return {};
}

/// All names that something has, in order.
std::set<std::string> names_of(const Surface& surface) {
  std::set<std::string> names{"outer"};
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    if (surface.is_fan(p)) continue;
    const Patch& patch = surface.patches[p];
    names.insert({wall_name(patch.family), patch.name});
    if (!patch.part_of.empty()) names.insert(patch.part_of);
  }
  for (const Edge& edge : surface.topology.edges) {
    if (edge.kind != EdgeKind::Free) continue;
    names.insert(edge.boundary < 0
                     ? "free"
                     : surface.boundaries->list()[static_cast<std::size_t>(edge.boundary)].name());
  }
  if (!surface.boundaries) return names;
  for (const Boundary& boundary : surface.boundaries->list()) {
    if (boundary.is_internal()) names.insert(boundary.name());
  }
  return names;
}

}  // namespace

void ConditionOptions::validate() const {
  if (outer != Kind::Farfield && outer != Kind::Overset) {
    throw InputError(fmt::format("ConditionOptions::outer = {}, but must be farfield or overset",
                                 describe({outer})));
  }
  std::set<std::string> seen;
  for (const NamedCondition& one : named) {
    if (seen.insert(one.name).second) continue;
    throw InputError(fmt::format("the boundary condition of '{}' is given twice", one.name));
  }
}

Condition condition_of_cgns(std::string_view type) {
  for (const Word& word : kWords) {
    // A user's own type is an overset boundary only where the file says so elsewhere.
    if (word.cgns == type && word.kind != Kind::Overset) return {word.kind};
  }
  for (const auto& [name, kind] : kFurther) {
    if (name == type) return {kind, std::string(type)};
  }
  return {};
}

Condition parse_condition(const std::string& text) {
  for (const Word& word : kWords) {
    if (!text.empty() && word.word == text) return {word.kind};
  }
  for (const std::string& type : {text, "BC" + text}) {
    const Condition condition = condition_of_cgns(type);
    const bool is_known = condition.kind != Kind::Unspecified || type == "FamilySpecified";
    if (is_known && condition.kind != Kind::Degenerate) return condition;
  }
  std::vector<std::string_view> known;
  for (const Word& word : kWords) {
    if (!word.word.empty()) known.push_back(word.word);
  }
  for (const auto& [name, kind] : kFurther) {
    if (kind != Kind::Degenerate) known.push_back(name);
  }
  throw InputError(
      fmt::format("'{}' is no boundary condition; use {}", text, fmt::join(known, ", ")));
}

std::string describe(const Condition& condition) {
  if (!condition.cgns_type.empty()) return condition.cgns_type;
  for (const Word& word : kWords) {
    if (word.kind == condition.kind && !word.word.empty()) return std::string(word.word);
  }
  return condition.kind == Kind::Degenerate ? "degenerate" : "unspecified";
}

std::string_view cgns_type(const Condition& condition) {
  if (!condition.cgns_type.empty()) return condition.cgns_type;
  const auto found = std::ranges::find(kWords, condition.kind, &Word::kind);
  return found == kWords.end() ? "FamilySpecified" : found->cgns;
}

BoundaryKind boundary_kind(ConditionKind kind) {
  switch (kind) {
    case ConditionKind::Wall:
    case ConditionKind::InviscidWall:
      return BoundaryKind::Wall;
    case ConditionKind::Farfield:
    case ConditionKind::Overset:
      return BoundaryKind::Outer;
    case ConditionKind::Degenerate:
      return BoundaryKind::Degenerate;
    default:
      return BoundaryKind::Boundary;
  }
}

void check_names(const ConditionOptions& options, const Surface& surface) {
  if (options.named.empty()) return;
  const std::set<std::string> names = names_of(surface);
  for (const NamedCondition& one : options.named) {
    if (names.contains(one.name)) continue;
    throw InputError(fmt::format(
        "boundary condition of '{}': no family, patch or boundary has that name; there are {}",
        one.name, fmt::join(names, ", ")));
  }
}

void set_conditions(const Surface& surface, const ConditionOptions& options, MultiBlock& mesh) {
  options.validate();
  check_names(options, surface);
  for (BoundaryFace& face : mesh.boundary_faces) {
    if (face.kind == BoundaryKind::Wall) {
      set_wall(surface, options, face);
      continue;
    }
    face.condition = {};
    if (face.kind == BoundaryKind::Degenerate) {
      face.condition = {Kind::Degenerate, face.name == "corner" ? "BCDegeneratePoint" : ""};
      continue;
    }
    if (face.kind == BoundaryKind::Outer) face.condition = {options.outer};
    if (face.kind == BoundaryKind::Boundary) face.condition = usual(surface, face.name);
    if (const Condition* own = find(options, face.name)) face.condition = *own;
  }
}

}  // namespace vdb_offset
