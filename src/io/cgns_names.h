#pragma once

#include <set>
#include <string>

namespace vdb_offset {

/// Names of nodes that stand under one parent: at most kCgnsName bytes, no '/', each once.
class CgnsNames {
 public:
  /// The name as wanted, or the nearest that is legal and not taken yet ("wing", "wing-2").
  std::string take(const std::string& wanted);

 private:
  std::set<std::string> taken_;
};

}  // namespace vdb_offset
