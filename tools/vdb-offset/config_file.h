#pragma once

#include <memory>
#include <string>

#include "options.h"

namespace CLI {
class App;
class Config;
}  // namespace CLI

namespace vdb_offset::command {

/// Reads --config for one command. Every key and value is checked by itself, so that a wrong one is
/// refused with its file and line; where each that counts came from goes to
/// `settings.config_places`.
std::shared_ptr<CLI::Config> config_reader(const CLI::App& app, Settings& settings,
                                           CommandBit command);

/// "layers = 0, but ..." -> "run.toml, line 3: layers = 0, but ...", if that is where it came from.
std::string with_config_place(const std::string& message, const Settings& settings);

/// Why a configuration cannot be read from what is in the place of `file`; empty if it can.
std::string why_no_config(const std::string& file);

}  // namespace vdb_offset::command
