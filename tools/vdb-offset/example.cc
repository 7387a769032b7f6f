#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "command.h"
#include "exit_codes.h"
#include "outputs.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"
#include "vdb_offset/io/airfoil.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/io/stl.h"

namespace vdb_offset::command {

namespace {

/// An option that says nothing about the surface asked for is a mistake, not to be passed over.
void check_shape_options(const CLI::App& app, const std::string& name) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> owners = {
      {"--gap", {"sphere-pair"}},
      {"--closed", {"draft-tube", "airfoil"}},
      {"--fillet", {"l-bar", "u-slot"}},
      {"--angle", {"wedge"}},
      {"--tips", {"star"}},
      {"--naca", {"airfoil"}}};
  for (const auto& [option, names] : owners) {
    if (app.count(option) == 0 || std::ranges::count(names, name) > 0) continue;
    throw InputError(fmt::format("{} is not an option of {}, but of {}; leave it out", option, name,
                                 fmt::join(names, " and ")));
  }
}

}  // namespace

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
  const auto is_named = [&](const ExampleInfo& info) { return info.name == settings.example; };
  if (std::ranges::any_of(examples(), is_named)) check_shape_options(app, settings.example);
  settings.shape.angle = radians(settings.angle_degrees);
  settings.shape.validate();
  const OutputRule rule{
      "example",
      {Format::Plot3d, Format::Plot3dFormatted, Format::Cgns, Format::Airfoil, Format::Stl}};
  const std::vector<Output> outputs = plan_outputs(settings, rule);
  const Patches patches = make_example(settings.example, settings.shape);
  if (outputs.empty()) throw CLI::RequiredError("-o FILE");
  for (const Output& output : outputs) {
    if (output.format == Format::Airfoil) {
      write_airfoil(output.file, patches);
    } else if (output.format == Format::Stl) {
      write_stl(output.file, patches);
    } else if (output.format == Format::Cgns) {
      write_cgns(output.file, patches);
    } else {
      write_plot3d(output.file, patches, {.formatted = output.format == Format::Plot3dFormatted});
    }
  }
  return kDone;
}

}  // namespace vdb_offset::command
