#pragma once

#include <map>
#include <string>
#include <utility>

#include "io/cgns_output.h"
#include "vdb_offset/blocks/conditions.h"

namespace vdb_offset {

/// The library's number of a BCType. Throws InputError for none.
BCType_t cgns_bc_type(std::string_view name);

/// The families of a file: one for each name and condition of boundary faces.
class CgnsFamilies {
 public:
  explicit CgnsFamilies(CgnsOutput& out) : out_(out) {}

  /// Writes the family, unless there is one already; degenerate faces have none.
  void add(const std::string& name, const Condition& condition);
  /// Says at the BC that was written last what family it is of.
  void join(int zone, int boundary, const std::string& name, const Condition& condition) const;

 private:
  using Key = std::pair<std::string, std::string>;  // name, BCType

  static Key key_of(const std::string& name, const Condition& condition);
  void mark_overset(const Condition& condition) const;

  CgnsOutput& out_;
  std::map<Key, std::string> names_;
};

}  // namespace vdb_offset
