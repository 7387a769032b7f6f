#include "io/cgns_families.h"

#include <fmt/format.h>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

BCType_t cgns_bc_type(std::string_view name) {
  for (int type = 0; type < NofValidBCTypes; ++type) {
    if (BCTypeName[type] == name) return static_cast<BCType_t>(type);
  }
  throw InputError(fmt::format("write_cgns: '{}' is no BCType of CGNS", name));
}

CgnsFamilies::Key CgnsFamilies::key_of(const std::string& name, const Condition& condition) {
  return {name, std::string(cgns_type(condition)) + describe(condition)};
}

/// A user's own type says nothing by itself; what reads overset meshes looks for this node.
void CgnsFamilies::mark_overset(const Condition& condition) const {
  if (condition.kind == ConditionKind::Overset) out_.check(cg_user_data_write("BCOverset"));
}

void CgnsFamilies::add(const std::string& name, const Condition& condition) {
  if (condition.kind == ConditionKind::Degenerate) return;
  const auto [found, is_new] = names_.try_emplace(key_of(name, condition));
  if (!is_new) return;
  found->second = out_.name(name);
  int family = 0;
  int index = 0;
  out_.check(cg_family_write(out_.file(), out_.base(), found->second.c_str(), &family));
  if (condition.kind == ConditionKind::Unspecified) return;
  out_.check(cg_fambc_write(out_.file(), out_.base(), family, "FamBC",
                            cgns_bc_type(cgns_type(condition)), &index));
}

void CgnsFamilies::join(int zone, int boundary, const std::string& name,
                        const Condition& condition) const {
  if (condition.kind == ConditionKind::Degenerate) return;
  out_.check(
      cg_goto(out_.file(), out_.base(), "Zone_t", zone, "ZoneBC_t", 1, "BC_t", boundary, "end"));
  out_.check(cg_famname_write(names_.at(key_of(name, condition)).c_str()));
  mark_overset(condition);
}

}  // namespace vdb_offset
