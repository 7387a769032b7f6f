#pragma once

namespace vdb_offset::command {

/// What the command returns to the shell.
enum ExitCode : int {
  kDone = 0,
  kBadCells = 1,      ///< done, but a cell is not positive, or blocks do not meet as they should
  kBadInput = 2,      ///< usage or input
  kFileTrouble = 3,   ///< a file cannot be read or written
  kLimit = 4,         ///< memory or iterations
  kInternal = 70,     ///< a defect of the program (EX_SOFTWARE)
  kInterrupted = 130  ///< SIGINT or SIGTERM
};

}  // namespace vdb_offset::command
