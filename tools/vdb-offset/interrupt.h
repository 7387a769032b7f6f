#pragma once

#include <atomic>

namespace vdb_offset::command {

/// SIGINT and SIGTERM ask the run to stop; a second one ends the process at once with 130. Output
/// still under its temporary name then stays behind, but nothing half-written has a final name.
/// Returns the flag that the signals set.
const std::atomic<bool>* catch_interrupts();

}  // namespace vdb_offset::command
