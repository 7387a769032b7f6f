#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace vdb_offset {

/// Numbers from 0 on in sets that can be joined; the least of each stands for it.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int a) {
    while (parent(a) != a) a = parent(a) = parent(parent(a));
    return a;
  }
  void join(int a, int b) {
    std::tie(a, b) = std::minmax({root(a), root(b)});
    parent(b) = a;
  }

 private:
  int& parent(int n) { return parent_[static_cast<std::size_t>(n)]; }

  std::vector<int> parent_;
};

}  // namespace vdb_offset
