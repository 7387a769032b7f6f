#include "options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <sstream>

namespace vdb_offset::command {
namespace {

constexpr std::size_t kHelpColumn = 30;
constexpr std::size_t kHelpWidth = 68;

/// "unit; range; default", the parts that there are.
std::string facts(const OptionField& field) {
  std::vector<std::string> parts;
  if (!field.unit.empty()) parts.push_back(field.unit);
  if (!field.range.empty()) parts.push_back(field.range);
  const bool shown = !field.preset.empty() && !field.value.empty();  // switches are off
  if (shown) parts.push_back(field.required() ? field.preset : "default: " + field.preset);
  return parts.empty() ? "" : fmt::format("({})", fmt::join(parts, "; "));
}

std::string wrapped(const std::string& text) {
  std::istringstream words(text);
  std::string out;
  std::string word;
  std::size_t column = 0;
  while (words >> word) {
    const bool fits = column == 0 || column + 1 + word.size() <= kHelpWidth;
    if (column > 0) out += fits ? ' ' : '\n';
    column = fits && column > 0 ? column + 1 + word.size() : word.size();
    out += word;
  }
  return out;
}

}  // namespace

std::string OptionField::key() const {
  const auto dashes = flag.find("--");
  return dashes == std::string::npos ? "surface" : flag.substr(dashes + 2);
}

void add_options(CLI::App& app, Settings& settings, CommandBit command) {
  app.get_formatter()->column_width(kHelpColumn);
  for (const OptionField& field : option_fields()) {
    if ((field.commands & command) == 0) continue;
    CLI::Option* option = field.bind(app, settings);
    option->group(field.stage)->description(wrapped(field.help + " " + facts(field)));
    if (!field.value.empty()) option->type_name(field.flag[0] == '-' ? field.value : " ");
  }
}

std::string options_markdown(CommandBit command) {
  std::string out =
      "| stage | option | unit | range | default | effect |\n|---|---|---|---|---|---|\n";
  for (const OptionField& field : option_fields()) {
    if ((field.commands & command) == 0) continue;
    const std::string name = field.flag + (field.value.empty() ? "" : " " + field.value);
    out += fmt::format("| {} | `{}` | {} | {} | {} | {} |\n", field.stage, name, field.unit,
                       field.range, field.preset, field.help);
  }
  return out;
}

std::vector<std::pair<std::string, OptionValue>> echo_options(const Settings& settings,
                                                              CommandBit command) {
  std::vector<std::pair<std::string, OptionValue>> out;
  for (const OptionField& field : option_fields()) {
    if ((field.commands & command) != 0) out.emplace_back(field.key(), field.echo(settings));
  }
  return out;
}

std::string in_user_terms(std::string message) {
  for (const OptionField& field : option_fields()) {
    if (field.member.empty()) continue;
    const auto at = message.find(field.member);
    if (at != std::string::npos) message.replace(at, field.member.size(), "--" + field.key());
  }
  return message;
}

}  // namespace vdb_offset::command
