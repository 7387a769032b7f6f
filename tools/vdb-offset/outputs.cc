#include "outputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

namespace vdb_offset::command {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, Format>& formats_by_name() {
  static const std::map<std::string, Format> names = {{"plot3d", Format::Plot3d},
                                                      {"plot3d-formatted", Format::Plot3dFormatted},
                                                      {"vtk", Format::Vtk},
                                                      {"vdb", Format::Vdb}};
  return names;
}

const std::map<std::string, Format>& formats_by_extension() {
  static const std::map<std::string, Format> names = {{".xyz", Format::Plot3d},
                                                      {".p3d", Format::Plot3d},
                                                      {".x", Format::Plot3d},
                                                      {".g", Format::Plot3d},
                                                      {".grd", Format::Plot3d},
                                                      {".bin", Format::Plot3d},
                                                      {".fmt", Format::Plot3dFormatted},
                                                      {".vtm", Format::Vtk},
                                                      {".vdb", Format::Vdb}};
  return names;
}

/// The keys of `names` whose format a command can write: what an error offers.
std::string choices(const std::map<std::string, Format>& names, const OutputRule& rule) {
  std::vector<std::string> out;
  for (const auto& [name, format] : names) {
    if (std::ranges::count(rule.allowed, format) > 0) out.push_back(name);
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

Format format_of(const fs::path& file, const std::string& forced, const OutputRule& rule) {
  const auto& names = forced.empty() ? formats_by_extension() : formats_by_name();
  const std::string name = forced.empty() ? file.extension().string() : forced;
  const auto found = names.find(name);
  const bool known = found != names.end();
  if (known && std::ranges::count(rule.allowed, found->second) > 0) return found->second;
  const std::string what =
      known ? fmt::format("'{}' cannot be written by '{}'", name, rule.command)
            : fmt::format("'{}' is not a known {}", name, forced.empty() ? "extension" : "format");
  if (name.empty()) {
    throw InputError(fmt::format("{}: the name has no extension; use {}, or --format {}",
                                 file.string(), choices(names, rule),
                                 choices(formats_by_name(), rule)));
  }
  if (!forced.empty()) {
    throw InputError(fmt::format("--format: {}; use {}", what, choices(names, rule)));
  }
  throw InputError(fmt::format("{}: {}; use {}, or --format {}", file.string(), what,
                               choices(names, rule), choices(formats_by_name(), rule)));
}

void check_writable(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    throw IoError(file.string() + ": is a folder; give a file name");
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw IoError(
        fmt::format("{}: there is no folder '{}'; make it first", file.string(), folder.string()));
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw IoError(
        fmt::format("{}: the folder '{}' may not be written", file.string(), folder.string()));
  }
}

/// One spelling for each place on the disk.
std::string place(const fs::path& file) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(fs::absolute(file), error);
  return error ? file.string() : path.string();
}

}  // namespace

std::vector<Output> plan_outputs(const Settings& settings, const OutputRule& rule) {
  std::vector<Output> out;
  for (const std::string& file : settings.outputs) {
    out.push_back({file, format_of(file, settings.format, rule)});
  }
  if (!settings.vdb.empty()) out.push_back({settings.vdb, Format::Vdb});

  std::vector<fs::path> files;
  for (const Output& output : out) files.push_back(output.file);
  if (!settings.report.empty() && settings.report != "-") files.emplace_back(settings.report);
  std::set<std::string> inputs;
  for (const std::string& file : settings.surfaces) inputs.insert(place(file));
  std::set<std::string> seen;
  for (const fs::path& file : files) {
    if (file.empty()) throw InputError("-o: the file name is empty");
    if (!seen.insert(place(file)).second) {
      throw InputError(file.string() + ": is named twice as an output; give each its own name");
    }
    if (inputs.contains(place(file))) {
      throw InputError(file.string() + ": is an input too, and would be overwritten");
    }
    check_writable(file);
  }
  return out;
}

}  // namespace vdb_offset::command
