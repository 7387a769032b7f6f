#include "sweep/kernel.h"

namespace vdb_offset {

namespace {

bool machine_has(Isa isa) {
#if defined(__x86_64__)
  if (isa == Isa::Avx512) {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
  }
  if (isa == Isa::Avx2) return __builtin_cpu_supports("avx2") != 0;
  return true;
#else
  return isa == Isa::Scalar;
#endif
}

}  // namespace

const Kernels* kernels(Isa isa) {
  if (!machine_has(isa)) return nullptr;
  switch (isa) {
    case Isa::Avx512:
      return isa::avx512();
    case Isa::Avx2:
      return isa::avx2();
    case Isa::Sse2:
      return isa::sse2();
    case Isa::Scalar:
      break;
  }
  return isa::scalar();
}

Isa best_isa() {
  for (const Isa isa : {Isa::Avx512, Isa::Avx2, Isa::Sse2}) {
    if (kernels(isa) != nullptr) return isa;
  }
  return Isa::Scalar;
}

const Kernels& narrowest(const Kernels& kernels, std::size_t tiles) {
  // A wide instruction set's processors have the narrower ones; the scalar kernel is slower than
  // SSE2's with a single tile in it.
  for (const Kernels* narrow : {isa::sse2(), isa::avx2()}) {
    if (narrow != nullptr && narrow->width < kernels.width && tiles <= narrow->width)
      return *narrow;
  }
  return kernels;
}

}  // namespace vdb_offset
