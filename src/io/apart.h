#pragma once

#include <functional>
#include <string>

namespace vdb_offset {

/// A file, and what library of others reads or writes it.
struct Apart {
  std::string file;     ///< named in messages
  const char* library;  ///< so are this, and what helps where it does not get along
  const char* advice;
  unsigned cpu_seconds;
};

/// What `work` returns, run in a process of its own: code that follows damaged files out of its
/// memory, or round in circles, ends that one alone. It must start no threads.
///
/// Throws what `work` throws of InputError, IoError and LimitError; IoError naming the file where
/// the process dies or takes more than `cpu_seconds`; Cancelled when it is interrupted.
std::string run_apart(const std::function<std::string()>& work, const Apart& apart);

/// Whether this is such a process.
bool is_apart();

}  // namespace vdb_offset
