#pragma once

#include <memory>
#include <string>
#include <vector>

#include "console.h"
#include "options.h"
#include "polygon_input.h"
#include "progress_bar.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/patch.h"

namespace CLI {
class App;
}

namespace vdb_offset::command {

using Arguments = std::vector<std::string>;

// One function a subcommand: arguments after its name -> exit code. They throw what the library
// throws, and CLI::ParseError.
int run_mesh(const Arguments& arguments);
int run_field(const Arguments& arguments);
int run_check(const Arguments& arguments);
int run_info(const Arguments& arguments);
int run_example(const Arguments& arguments);

/// `info` of an OpenVDB file, as lines or as JSON.
std::string describe_vdb(const std::string& file, bool json);

/// Parse "mesh" or "field": their options, --config, and what both check.
Settings parse_run(CommandBit command, const Arguments& arguments);

/// Parse with CLI11, which wants its arguments reversed.
void parse(CLI::App& app, Arguments arguments);

/// Read all surfaces, with the boundary surfaces that they end on into the pipeline's options; with
/// several, patch names begin with their file's stem.
Patches read_surfaces(Settings& settings, PolygonUse& use);

/// Holds the number of threads of TBB until it goes.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  static int in_force();

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

/// What a run of `mesh` or `field` holds from beginning to end.
struct RunFrame {
  explicit RunFrame(const Settings& settings);

  Console console;
  ThreadLimit threads;
  ProgressBar bar;
  Progress progress;  ///< drives the bar; cancelled by SIGINT and SIGTERM
};

/// What `--dry-run` prints on standard output.
void print_plan(const Plan& plan, const Settings& settings, CommandBit command);

/// A place's coordinates; in two dimensions there are two.
std::string in_words(const Vec3& place_world, bool flat);

/// The line of "surface", "rasterize" or "sweep": the stages that `mesh` and `field` share.
/// Closed parts that lie in one another, by name and place; empty: none do.
std::string overlaps_in_words(const Surface& surface);
void print_field_stage(const Console& console, std::string_view stage, const FieldResult& result);

/// kLimit, with a message, when the sweep did not settle; else kDone.
int check_converged(const DistanceField& field, const Settings& settings);

/// Write the report to its file or to standard output, if it is asked for.
void put_report(const ReportParts& parts, const RunInfo& run, const Settings& settings);

}  // namespace vdb_offset::command
