#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// The condition of all that has one name: a family, a patch, a boundary or internal surface,
/// "outer", "free".
struct NamedCondition {
  std::string name;
  Condition condition;
};

struct ConditionOptions {
  /// Of the outermost level.  Range: Farfield or Overset.
  ConditionKind outer = ConditionKind::Farfield;
  /// A patch's goes before its family's; a name may stand here once.
  std::vector<NamedCondition> named = {};

  void validate() const;
};

/// "wall", "inviscid-wall", "symmetry", "inflow", "outflow", "farfield", "overset", or a BCType of
/// CGNS ("BCWallViscousIsothermal", with or without "BC" in front).
/// Throws InputError that lists them.
Condition parse_condition(const std::string& text);

/// The word that parse_condition reads: "wall"; "unspecified", "degenerate" for those of no word.
std::string describe(const Condition& condition);

/// The BCType of CGNS: "BCWallViscous"; "FamilySpecified" for Unspecified, "UserDefined" for
/// Overset, "BCDegenerateLine" for Degenerate unless it says that it is a point.
std::string_view cgns_type(const Condition& condition);

/// The condition that a BCType of CGNS says; Other for those that are of no kind here.
Condition condition_of_cgns(std::string_view type);

/// What a face with that condition is, where nothing but the condition is known.
BoundaryKind boundary_kind(ConditionKind kind);

/// Throws InputError for a condition whose name nothing has, with the names that there are.
/// Internal surfaces have theirs whether a column ends on them or not.
void check_names(const ConditionOptions& options, const Surface& surface);

/// Give every boundary face its condition, and walls their names.
///
/// Without a name in `options`: walls are viscous walls, the outermost level is `outer`, planes
/// whose names begin with "symmetry" are symmetry, and the two that a flat surface lies between;
/// boundaries whose names begin with "inlet" or "outlet" are inflow or outflow, in any case of
/// letters; all else is unspecified, internal surfaces too. A wall patch that `options` name is
/// called by its own name, else by its family's, or "wall".
/// In      mesh: of this surface.
/// Throws  as check_names and ConditionOptions::validate.
void set_conditions(const Surface& surface, const ConditionOptions& options, MultiBlock& mesh);

}  // namespace vdb_offset
