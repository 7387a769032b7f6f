// The options of a run as a whole.

#include "config_file.h"
#include "option_binding.h"

namespace vdb_offset::command {
namespace {

/// CLI11 reads the file itself; only its name is kept here.
OptionField config_field() {
  OptionField field{.stage = "run",
                    .flag = "--config",
                    .value = "FILE",
                    .preset = "none",
                    .help =
                        "Options from a TOML or INI file, by their long names (and surface); the "
                        "command line goes first.",
                    .commands = kMesh | kField};
  field.bind = [](CLI::App& app, Settings& settings) {
    app.allow_config_extras(CLI::config_extras_mode::error);
    const auto keep = [&settings](const std::string& file) { settings.config = file; };
    return app.set_config("--config")->each(keep)->check(why_no_config);
  };
  field.echo = [](const Settings& settings) { return to_value(settings.config); };
  return field;
}

}  // namespace

std::vector<OptionField> run_fields() {
  const unsigned both = kMesh | kField;
  return {
      automatic(
          {.stage = "run",
           .flag = "--threads",
           .value = "N",
           .range = "[1, 1024]",
           .preset = "all cores",
           .help = "Threads; the result does not depend on them.",
           .commands = both},
          [](auto& s) -> auto& { return s.threads; }),
      config_field(),
      direct(
          {.stage = "run",
           .flag = "--dry-run",
           .help = "Print sizes, voxel, memory and spacing on standard output, and stop.",
           .commands = both},
          [](auto& s) -> auto& { return s.dry_run; }),
      direct(
          {.stage = "run", .flag = "--quiet", .help = "Errors only.", .commands = both},
          [](auto& s) -> auto& { return s.quiet; }),
      direct(
          {.stage = "run",
           .flag = "--verbose",
           .help = "More figures; mesh: a table of the worst cells of levels and patches.",
           .commands = both},
          [](auto& s) -> auto& { return s.verbose; }),
  };
}

}  // namespace vdb_offset::command
