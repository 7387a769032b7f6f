#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "polygon_input.h"
#include "vdb_offset/io/cad.h"
#include "vdb_offset/io/report.h"
#include "vdb_offset/io/vdb.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/example.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vdb_offset::command {

/// Everything that a command line or a configuration file can set.
struct Settings {
  std::vector<std::string> surfaces;
  std::string input_format;
  std::string length_unit;               ///< of all surfaces, as CGNS calls it; empty: unknown
  std::vector<std::string> input_notes;  ///< on what was read, for the user
  PolygonRule polygons = PolygonRule::Auto;
  SignRule sign = SignRule::Auto;
  CadOptions cad;
  std::vector<std::string> planes;  ///< as given
  std::vector<std::string> shapes;
  std::vector<std::string> internals;
  std::vector<std::string> families;
  double splay_degrees = 30;  ///< pipeline.march.splay, as it is asked for
  std::vector<std::string> conditions;
  PipelineOptions pipeline;
  std::vector<std::string> outputs;
  std::string format;  ///< empty: by extension
  std::string vdb;
  std::vector<std::string> outer_surfaces;
  VdbWriteOptions grids;
  bool feature_grid = false;
  std::string topology;  ///< empty: none
  std::string report;
  int threads = 0;  ///< 0: all cores
  std::string config;
  std::vector<std::pair<std::string, std::string>> config_places;  ///< key, "FILE, line 3"
  bool dry_run = false;
  bool quiet = false;
  bool verbose = false;
  std::string example;
  ExampleOptions shape;
  double angle_degrees = 90;  ///< shape.angle, as it is asked for
};

/// The commands that an option belongs to, as bits.
enum CommandBit : unsigned { kMesh = 1, kField = 2, kExample = 4 };

/// One option: help, documentation and the report's echo all come from here.
struct OptionField {
  std::string stage = {};   ///< group in the help
  std::string flag = {};    ///< "--layers", or "-o,--output"
  std::string value = {};   ///< placeholder in the help; empty for a switch
  std::string unit = {};    ///< empty: none
  std::string range = {};   ///< empty: free
  std::string preset = {};  ///< default as text
  std::string help = {};
  std::string member = {};  ///< name by which the library's messages call it
  unsigned commands = kMesh;
  std::function<CLI::Option*(CLI::App&, Settings&)> bind = {};
  std::function<OptionValue(const Settings&)> echo = {};

  /// The long flag without its dashes: key in configuration files and in the report.
  std::string key() const;
  bool required() const { return preset == "required"; }
};

/// All options, by stage in the order of the pipeline.
const std::vector<OptionField>& option_fields();

/// Add those of one command to its parser, grouped by stage.
void add_options(CLI::App& app, Settings& settings, CommandBit command);

/// The README's table.
std::string options_markdown(CommandBit command);

/// Every option of a command with its value in force.
std::vector<std::pair<std::string, OptionValue>> echo_options(const Settings& settings,
                                                              CommandBit command);

/// "SpacingOptions::layers = 0, but ..." -> "--layers = 0, but ...".
std::string in_user_terms(std::string message);

}  // namespace vdb_offset::command
