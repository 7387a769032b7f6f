#include "config_file.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <system_error>

namespace vdb_offset::command {
namespace {

using Items = std::vector<CLI::ConfigItem>;

std::string trimmed(const std::string& text) {
  constexpr const char* kAround = " \t\r\"'";
  const auto begin = text.find_first_not_of(kAround);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kAround) - begin + 1);
}

/// Number of the line that sets a key, or opens a section; 0 if there is none.
int line_of(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (trimmed(line.substr(0, line.find_first_of("=#"))) == name) return number;
  }
  return 0;
}

const OptionField* find_field(const std::string& key, CommandBit command) {
  const auto& fields = option_fields();
  const auto found = std::ranges::find_if(fields, [&](const OptionField& field) {
    return (field.commands & command) != 0 && field.key() == key;
  });
  return found == fields.end() ? nullptr : &*found;
}

class Reader : public CLI::ConfigTOML {
 public:
  Reader(const CLI::App& app, Settings& settings, CommandBit command)
      : app_(app), settings_(settings), command_(command) {}

  Items from_config(std::istream& input) const override {
    const std::string text{std::istreambuf_iterator<char>(input), {}};
    std::istringstream again(text);
    Items read = CLI::ConfigTOML::from_config(again);
    for (CLI::ConfigItem& item : read) {
      const std::string section = item.parents.empty() ? "" : "[" + item.parents.back() + "]";
      const int line = line_of(text, section.empty() ? item.name : section);
      const std::string file = app_.get_config_ptr()->results().front();
      const std::string place = line > 0 ? fmt::format("{}, line {}", file, line) : file;
      if (!section.empty()) {
        throw CLI::ConfigError(place + ": there are no sections like " + section +
                               "; write its keys without one");
      }
      take(item, place);
    }
    return read;
  }

 private:
  void take(CLI::ConfigItem& item, const std::string& place) const {
    const OptionField* field = find_field(item.name, command_);
    if (field == nullptr || item.name == "config") {
      throw CLI::ConfigError(
          fmt::format("{}: '{}' is not a key; keys are the long names of options, like layers",
                      place, item.name));
    }
    try {
      check(*field, item);
    } catch (const CLI::ParseError& error) {
      throw CLI::ConfigError(place + ": " + error.what());
    }
    const bool positional = field->flag[0] != '-';
    if (positional) item.name = field->flag;
    const CLI::Option* option =
        app_.get_option_no_throw(positional ? field->flag : "--" + field->key());
    if (option->empty()) settings_.config_places.emplace_back(field->key(), place);
  }

  /// Parses the value alone, as if the command line gave it.
  void check(const OptionField& field, const CLI::ConfigItem& item) const {
    CLI::App app;
    Settings unused;
    field.bind(app, unused);
    Arguments arguments;
    for (const std::string& value : item.inputs) {
      const bool is_switch = field.value.empty();
      if (field.flag[0] == '-' && !is_switch) arguments.push_back("--" + field.key());
      arguments.push_back(is_switch ? "--" + field.key() + "=" + value : value);
    }
    std::ranges::reverse(arguments);
    app.parse(std::move(arguments));
  }

  using Arguments = std::vector<std::string>;
  const CLI::App& app_;
  Settings& settings_;
  CommandBit command_;
};

}  // namespace

std::shared_ptr<CLI::Config> config_reader(const CLI::App& app, Settings& settings,
                                           CommandBit command) {
  return std::make_shared<Reader>(app, settings, command);
}

std::string with_config_place(const std::string& message, const Settings& settings) {
  const std::string said = in_user_terms(message);
  for (const auto& [key, place] : settings.config_places) {
    const bool named = said.starts_with(key + " =") || said.starts_with("--" + key + " ");
    if (named) return place + ": " + said;
  }
  return message;
}

std::string why_no_config(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return {};
  return file + ": is not a regular file; give one with options";
}

}  // namespace vdb_offset::command
