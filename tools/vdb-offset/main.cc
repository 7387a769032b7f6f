#include <dlfcn.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>

#include "command.h"
#include "exit_codes.h"
#include "large_heap.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/version.h"

namespace vdb_offset::command {
namespace {

struct Subcommand {
  const char* name;
  const char* usage;
  const char* summary;
  int (*run)(const Arguments&);
};

constexpr std::array<Subcommand, 5> kSubcommands{{
    {"mesh", "SURFACE... --distance D -o FILE [-o FILE]...", "hexahedral layers near a wall",
     run_mesh},
    {"field", "SURFACE... --distance D -o FILE.vdb", "the distance field alone", run_field},
    {"check", "MESH [--nmf FILE] [--report FILE.json]",
     "quality and connectivity of any volume mesh", run_check},
    {"info", "FILE [--json]", "what is in a file", run_info},
    {"example", "[NAME -o FILE]", "a built-in surface, or the list of them", run_example},
}};

void print_help(std::FILE* to) {
  fmt::print(to, "vdb-offset {}: face-matching hexahedral layers near a wall\n\n", kVersion);
  for (const Subcommand& sub : kSubcommands) {
    fmt::print(to, "  vdb-offset {} {}\n      {}\n", sub.name, sub.usage, sub.summary);
  }
  fmt::print(
      to,
      "\n'vdb-offset mesh --help' lists the options of mesh, and so on.\n"
      "Exit: 0 done, 1 done but a cell is not positive or (check) the mesh has a fault, 2 usage\n"
      "or input, 3 a file, 4 a limit (memory, iterations), 130 interrupted.\n");
}

int dispatch(const Arguments& arguments) {
  const std::string name = arguments.empty() ? "" : arguments.front();
  if (name == "--help" || name == "-h" || name == "help") {
    print_help(stdout);
    return kDone;
  }
  if (name == "--version") {
    fmt::print("vdb-offset {}\n", kVersion);
    return kDone;
  }
  if (name.empty()) {
    print_help(stderr);
    return kBadInput;
  }
  const Arguments rest(arguments.begin() + 1, arguments.end());
  // Not in the help: the README's table is made and checked with it.
  if (name == "mesh" && rest == Arguments{"--help-markdown"}) {
    fmt::print("{}", options_markdown(kMesh));
    return kDone;
  }
  for (const Subcommand& sub : kSubcommands) {
    if (name == sub.name) return sub.run(rest);
  }
  throw InputError(
      fmt::format("'{}' is not a command; there are mesh, field, check, info and example", name));
}

int fail(int code, const std::string& message) {
  Console::error(in_user_terms(message));
  return code;
}

/// The one place where errors become exit codes.
int guarded(const Arguments& arguments) {
  try {
    return dispatch(arguments);
  } catch (const CLI::CallForHelp&) {
    return kDone;
  } catch (const CLI::FileError& error) {
    return fail(kFileTrouble, error.what());
  } catch (const CLI::ParseError& error) {
    return fail(kBadInput, fmt::format("{}\n(--help lists the options)", error.what()));
  } catch (const Cancelled&) {
    return fail(kInterrupted, "interrupted");
  } catch (const InputError& error) {
    return fail(kBadInput, error.what());
  } catch (const IoError& error) {
    return fail(kFileTrouble, error.what());
  } catch (const LimitError& error) {
    return fail(kLimit, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kLimit, "out of memory; give a larger --voxel, or --memory to have it chosen");
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(kFileTrouble, error.what());
  } catch (const std::exception& error) {
    // Caught only so that destructors remove temporary files.
    return fail(kInternal, fmt::format("a defect of this program: {}", error.what()));
  }
}

/// HDF5, which CGNS files are made with, closes once more at the end of the program what it holds,
/// and complains in a terminal of what a damaged file left behind. All files are closed by then.
void keep_hdf5_quiet() {
  void* found = ::dlsym(RTLD_DEFAULT, "H5dont_atexit");
  if (found != nullptr) reinterpret_cast<int (*)()>(found)();
}

}  // namespace
}  // namespace vdb_offset::command

int main(int argc, char** argv) {
  // A start takes some hundredths of a second, which the other commands would not get back.
  const std::string name = argc > 1 ? argv[1] : "";
  if (name == "mesh" || name == "field") vdb_offset::restart_with_large_heap(argv);
  vdb_offset::command::keep_hdf5_quiet();
  return vdb_offset::command::guarded({argv + 1, argv + argc});
}
