#pragma once

namespace vdb_offset {

/// Gives a program a heap in pages of 2 MiB, where the kernel gives these on request alone: trees
/// of 10^8 voxels are swept twice as fast then, and more on virtual machines. glibc's heap asks for
/// them by a tunable that is read when a program starts, so this starts it anew, once. Does nothing
/// where the kernel gives such pages to all or to none, and where GLIBC_TUNABLES is set, be it to
/// nothing. To be called first, with the arguments of main.
void restart_with_large_heap(char** argv);

}  // namespace vdb_offset
