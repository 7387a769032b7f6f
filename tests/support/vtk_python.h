#pragma once

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "support/temp_folder.h"

namespace vdb_offset::test {

/// Whether VTK's Python is installed for the system's interpreter.
inline bool has_vtk() {
  static const bool found =
      std::system("/usr/bin/python3 -c 'import vtkmodules.all' >/dev/null 2>&1") == 0;
  return found;
}

/// Runs a script in `folder`, with VTK imported as `vtk`; what it prints.
inline std::string run_vtk(const TempFolder& folder, const std::string& script) {
  const std::string file = (folder / "judge.py").string();
  const std::string printed = (folder / "judge.txt").string();
  std::ofstream(file) << "import os, sys\nimport vtkmodules.all as vtk\n"
                         "os.chdir(os.path.dirname(os.path.abspath(__file__)))\n"
                      << script;
  // A sanitizer's preloaded runtime is not for the interpreter.
  const std::string command =
      "env -u LD_PRELOAD /usr/bin/python3 '" + file + "' > '" + printed + "' 2>&1";
  const int status = std::system(command.c_str());
  const std::string text = file_bytes(printed);
  std::filesystem::remove(file);
  std::filesystem::remove(printed);
  if (status != 0) throw std::runtime_error("VTK's Python failed: " + text);
  return text;
}

}  // namespace vdb_offset::test
