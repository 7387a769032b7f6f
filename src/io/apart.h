#pragma once

#include <functional>
#include <string>

namespace vdb_offset::cad {

/// What `work` returns, run in a process of its own: code that follows damaged files out of its
/// memory, or round in circles, ends that one alone. It must start no threads.
///
/// Throws what `work` throws of InputError, IoError and LimitError; IoError naming the file where
/// the process dies or takes more than `cpu_seconds`; Cancelled when it is interrupted.
std::string run_apart(const std::function<std::string()>& work, const std::string& file,
                      unsigned cpu_seconds);

}  // namespace vdb_offset::cad
