#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace vdb_offset {

/// Memory in pages of 2 MiB where the system has them: an array that is written once costs as much
/// for the pages that come in as for the writing, and these are 512 times fewer. Elements that
/// nothing initialises are left as they are, not set to zero. `Whole`: the last page too is one of
/// 2 MiB, for arrays of an eighth of that and more.
template <typename T, bool Whole = false>
class LargeAllocator {
 public:
  using value_type = T;
  template <typename U>
  struct rebind {
    using other = LargeAllocator<U, Whole>;
  };

  LargeAllocator() = default;
  template <typename U>
  explicit LargeAllocator(const LargeAllocator<U, Whole>&) {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
    std::size_t bytes = count * sizeof(T);
    if (Whole && bytes >= kHugePage / 8) bytes = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    void* memory = nullptr;
    if (bytes < kHugePage) {
      memory = std::malloc(bytes);
    } else if (::posix_memalign(&memory, kHugePage, bytes) == 0) {
      // Not for the last, broken one. Where the kernel declines, the pages are the usual ones.
      const std::size_t whole = bytes / kHugePage * kHugePage;
      static_cast<void>(::madvise(memory, whole, MADV_HUGEPAGE));
    }
    if (memory == nullptr) throw std::bad_alloc();
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }
  template <typename U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <typename U, typename... Values>
  void construct(U* place, Values&&... values) {
    ::new (static_cast<void*>(place)) U(std::forward<Values>(values)...);
  }

  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }

 private:
  static constexpr std::size_t kHugePage = std::size_t{2} << 20U;
};

/// Asks for such pages for memory that something else allocated, before it is written. No promise.
inline void advise_large_pages(void* memory, std::size_t bytes) {
  constexpr std::uintptr_t kHugePage = std::uintptr_t{2} << 20U;
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (begin + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t last = (begin + bytes) / kHugePage * kHugePage;
  if (first >= last) return;
  void* const aligned = static_cast<char*>(memory) + (first - begin);
  static_cast<void>(::madvise(aligned, last - first, MADV_HUGEPAGE));
}

template <typename T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

/// For what lives shortly, and several threads write at once: usual pages come in one at a time.
template <typename T>
using WholeLargeVector = std::vector<T, LargeAllocator<T, true>>;

}  // namespace vdb_offset
