#pragma once

/// Before a function: compile it for plain x86-64, for AVX2 and for AVX-512; the machine's best is
/// taken when the program starts. Arithmetic is not contracted, so all give the same bits.
///
/// Sanitizers cannot run before the choice is made, which the choice itself would need.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define VDB_OFFSET_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define VDB_OFFSET_CLONES
#endif

/// Before a function that such functions call: it becomes part of each of them.
#define VDB_OFFSET_INLINE inline __attribute__((always_inline))
