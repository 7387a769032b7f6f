#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command.h"
#include "exit_codes.h"
#include "outputs.h"
#include "vdb_offset/io/plot3d.h"

namespace vdb_offset::command {

int run_example(const Arguments& arguments) {
  CLI::App app("A built-in surface; without a name, the list of them.", "vdb-offset example");
  Settings settings;
  app.add_option("NAME", settings.example, "Name of the surface.")->type_name("");
  add_options(app, settings, kExample);
  parse(app, arguments);
  if (settings.example.empty()) {
    if (!settings.outputs.empty()) {
      throw InputError(
          "example: -o needs the NAME of a surface too; 'vdb-offset example' lists "
          "them");
    }
    for (const ExampleInfo& info : examples()) {
      fmt::print("{:<16} {}\n", info.name, info.summary);
    }
    return kDone;
  }
  settings.shape.validate();
  const OutputRule rule{"example", {Format::Plot3d, Format::Plot3dFormatted}};
  const std::vector<Output> outputs = plan_outputs(settings, rule);
  const Patches patches = make_example(settings.example, settings.shape);
  if (outputs.empty()) throw CLI::RequiredError("-o FILE");
  for (const Output& output : outputs) {
    write_plot3d(output.file, patches, {.formatted = output.format == Format::Plot3dFormatted});
  }
  return kDone;
}

}  // namespace vdb_offset::command
