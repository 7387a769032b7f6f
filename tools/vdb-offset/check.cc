#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "check_report.h"
#include "command.h"
#include "exit_codes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/output.h"
#include "vdb_offset/io/report.h"

namespace vdb_offset::command {
namespace {

struct CheckOptions {
  std::string file;
  std::string input_format;
  std::string nmf;
  std::string report;
  bool json = false;
  Settings frame;  ///< threads, quiet, verbose
};

CheckOptions parse_check(const Arguments& arguments) {
  CheckOptions o;
  CLI::App app(
      "Quality and connectivity of a volume mesh: CGNS, PLOT3D with a neutral map (.nmf), VTK\n"
      "(.vtm, .vts, .vtu), SU2 (.su2), or an OpenFOAM case (its folder, or .foam).\n"
      "Exit 1 if a cell is not positive or the mesh has a fault.",
      "vdb-offset check");
  app.add_option("MESH", o.file, "The mesh: a file, or the folder of an OpenFOAM case.")
      ->required()
      ->type_name("");
  app.add_option("--nmf", o.nmf,
                 "Neutral map of a PLOT3D mesh. Else that which stands beside it, if there is one; "
                 "without one the cells alone are checked.")
      ->type_name("FILE");
  app.add_option("--input-format", o.input_format, "As for mesh.")->type_name("WORDS");
  app.add_option("--report", o.report, "Write all that was found as JSON; - is standard output.")
      ->type_name("FILE.json");
  app.add_flag("--json", o.json, "The same as --report -.");
  app.add_option("--threads", o.frame.threads, "Threads; the result is the same for any number.")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  app.add_flag("--quiet", o.frame.quiet, "Errors only: no table, no progress.");
  app.add_flag("--verbose", o.frame.verbose, "Every zone, and up to 1000 cells and faults.");
  parse(app, arguments);
  if (o.json && o.report.empty()) o.report = "-";
  if (o.json && o.report != "-") throw InputError("--json and --report FILE; give one of them");
  return o;
}

/// Before any work: that the report can be written, and on no file that is read.
void check_report_place(const CheckOptions& o) {
  if (o.report.empty() || o.report == "-") return;
  const std::filesystem::path place = output_place(o.report);
  const auto beside = std::filesystem::path(o.file).replace_extension(".nmf");
  for (const std::filesystem::path& input : {std::filesystem::path(o.file), beside, {o.nmf}}) {
    std::error_code ignored;
    if (std::filesystem::equivalent(place, input, ignored)) {
      throw InputError(o.report + ": is an input too, and would be overwritten");
    }
  }
}

/// The table, the report, the exit code.
template <typename Run>
int put(const Run& run, const CheckOptions& o) {
  if (o.report == "-") {
    fmt::print("{}", check_json(run));
  } else {
    if (!o.frame.quiet) print_check(run);
    if (!o.report.empty()) write_report(o.report, check_json(run));
  }
  return run.check.is_sound() ? kDone : kBadCells;
}

}  // namespace

int run_check(const Arguments& arguments) {
  const CheckOptions o = parse_check(arguments);
  check_report_place(o);
  RunFrame frame(o.frame);
  const InputFormat format(o.input_format);
  const InputKind kind = format.kind_of(o.file);
  const Stopwatch reading;
  if (!is_of_cells(o.file, kind)) {
    const VolumeInput input = read_volume(o.file, format, o.nmf);
    const double read_seconds = reading.seconds();
    const Stopwatch checking;
    const MeshCheck check = check_mesh(input.mesh, frame.progress);
    frame.bar.clear();
    return put(CheckRun{o.file, input, check, read_seconds, checking.seconds(), o.frame.verbose},
               o);
  }
  if (!o.nmf.empty()) throw InputError(o.file + ": --nmf is for PLOT3D grids");
  const CellZone mesh = read_cells(o.file, kind);
  const double read_seconds = reading.seconds();
  const Stopwatch checking;
  const CellCheck check = check_cells(mesh, frame.progress);
  frame.bar.clear();
  return put(
      CellCheckRun{o.file, kind, mesh, check, read_seconds, checking.seconds(), o.frame.verbose},
      o);
}

}  // namespace vdb_offset::command
