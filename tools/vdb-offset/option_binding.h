#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "options.h"

// How a member of Settings becomes an option: its text, its echo, its default.

namespace vdb_offset::command {

inline OptionValue to_value(bool v) { return v; }
inline OptionValue to_value(int v) { return static_cast<std::int64_t>(v); }
inline OptionValue to_value(double v) { return v; }
inline OptionValue to_value(const std::string& v) {
  return v.empty() ? OptionValue{} : OptionValue{v};
}
inline OptionValue to_value(const std::vector<std::string>& v) { return v; }
template <typename T>
OptionValue to_value(const std::optional<T>& v) {
  return v ? to_value(*v) : OptionValue{};
}

inline std::string to_text(const OptionValue& value) {
  struct Text {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool v) const { return v ? "on" : "off"; }
    std::string operator()(std::int64_t v) const { return fmt::format("{}", v); }
    std::string operator()(double v) const { return fmt::format("{:g}", v); }
    std::string operator()(const std::string& v) const { return v; }
    std::string operator()(const std::vector<std::string>&) const { return ""; }
  };
  return std::visit(Text{}, value);
}

inline CLI::Option* add(CLI::App& app, const std::string& flag, bool& target) {
  return app.add_flag(flag, target);
}
inline CLI::Option* add(CLI::App& app, const std::string& flag, std::vector<std::string>& target) {
  // One value for each -o: what follows it is a surface.
  return app.add_option(flag, target)->allow_extra_args(flag[0] != '-');
}
inline CLI::Option* add(CLI::App& app, const std::string& flag, std::string& target) {
  return app.add_option(flag, target);
}
/// CLI11 reads a number from nothing: 0.
inline std::string check_number(const std::string& text) {
  const bool blank = text.find_first_not_of(" \t\r\n") == std::string::npos;
  return blank ? fmt::format("'{}' is not a number", text) : "";
}
template <typename T>
CLI::Option* add(CLI::App& app, const std::string& flag, T& target) {
  return app.add_option(flag, target)->check(CLI::Validator(check_number, ""));
}

/// An option that sets a member directly; its default is the member's own.
template <typename Member>
OptionField direct(OptionField field, Member member) {
  field.bind = [flag = field.flag, member](CLI::App& app, Settings& settings) {
    return add(app, flag, member(settings));
  };
  field.echo = [member](const Settings& settings) { return to_value(member(settings)); };
  if (field.preset.empty()) field.preset = to_text(field.echo(Settings{}));
  return field;
}

/// The same, where 0 (nothing given) lets the program choose.
template <typename Member>
OptionField automatic(OptionField field, Member member) {
  field = direct(std::move(field), member);
  field.echo = [member](const Settings& settings) {
    return member(settings) == 0 ? OptionValue{} : to_value(member(settings));
  };
  return field;
}

/// An option whose text needs parsing of its own.
template <typename Parse, typename Echo>
OptionField parsed(OptionField field, Parse parse, Echo echo) {
  field.bind = [flag = field.flag, parse](CLI::App& app, Settings& settings) {
    const auto set = [&settings, flag, parse](const std::string& text) {
      try {
        parse(settings, text);
      } catch (const InputError& error) {
        throw CLI::ValidationError(flag, error.what());
      }
    };
    return app.add_option_function<std::string>(flag, set);
  };
  field.echo = echo;
  if (field.preset.empty()) field.preset = to_text(field.echo(Settings{}));
  return field;
}

/// The options of the built-in surfaces.
std::vector<OptionField> example_fields();
std::vector<OptionField> run_fields();

}  // namespace vdb_offset::command
