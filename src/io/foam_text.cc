#include "io/foam_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

#include "io/input_file.h"
#include "io/number_text.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

bool stands_alone(char c) { return c == '(' || c == ')' || c == '{' || c == '}' || c == ';'; }

}  // namespace

FoamText::FoamText(const std::filesystem::path& folder, const std::string& name,
                   std::string_view kind)
    : file_((folder / name).string()) {
  std::error_code ignored;
  if (!std::filesystem::exists(file_, ignored) && std::filesystem::exists(file_ + ".gz", ignored)) {
    throw IoError(file_ + ".gz: is compressed; gunzip it first");
  }
  bytes_ = contents_of(file_, "a case");
  read_header(kind);
}

void FoamText::refuse(const std::string& why) const {
  const auto line =
      1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), '\n');
  throw IoError(fmt::format("{}, line {}: {}", file_, line, why), {line});
}

void FoamText::pass_blanks() {
  while (at_ < bytes_.size()) {
    const std::string_view here = std::string_view(bytes_).substr(at_, 2);
    if (is_space(here[0])) {
      ++at_;
    } else if (here == "//") {
      at_ = std::min(bytes_.find('\n', at_), bytes_.size());
    } else if (here == "/*") {
      const std::size_t end = bytes_.find("*/", at_ + 2);
      at_ = end == std::string::npos ? bytes_.size() : end + 2;
    } else {
      return;
    }
  }
}

bool FoamText::at_end() {
  pass_blanks();
  return at_ >= bytes_.size();
}

std::string_view FoamText::next() {
  pass_blanks();
  begin_ = at_;
  if (at_ >= bytes_.size()) refuse("the file ends early");
  const std::string_view rest = std::string_view(bytes_).substr(at_);
  std::size_t size = 1;
  if (rest[0] == '"') {
    const std::size_t end = rest.find('"', 1);
    size = end == std::string_view::npos ? rest.size() : end + 1;
  } else if (!stands_alone(rest[0])) {
    while (size < rest.size() && !is_space(rest[size]) && !stands_alone(rest[size])) ++size;
  }
  at_ += size;
  return rest.substr(0, size);
}

void FoamText::expect(std::string_view token) {
  const std::string_view found = next();
  if (found != token) refuse(fmt::format("{} where '{}' is expected", quoted(found), token));
}

std::int64_t FoamText::whole(const char* what, std::int64_t least, std::int64_t most) {
  const std::string_view token = next();
  const auto value = parse_whole(token);
  if (!value) refuse(fmt::format("{} {} is no whole number", what, quoted(token)));
  if (*value < least || *value > most) {
    refuse(fmt::format("{} = {}, but must be in [{}, {}]", what, *value, least, most));
  }
  return *value;
}

double FoamText::real() {
  const std::string_view token = next();
  const auto value = parse_real(token);
  if (!value || !std::isfinite(*value)) {
    refuse(fmt::format("coordinate {} is no finite number", quoted(token)));
  }
  return *value;
}

std::size_t FoamText::begin_list(std::size_t item_bytes) {
  const auto most = std::min<std::size_t>((bytes_.size() - at_) / item_bytes,
                                          std::numeric_limits<std::int32_t>::max());
  const std::int64_t count = whole("count", 0, static_cast<std::int64_t>(most));
  expect("(");
  return static_cast<std::size_t>(count);
}

void FoamText::read_header(std::string_view kind) {
  if (at_end()) refuse("is empty");
  if (next() != "FoamFile") refuse("does not begin with a FoamFile header");
  expect("{");
  for (std::string_view key = next(); key != "}"; key = next()) {
    const std::string_view value = next();
    if (key == "format" && value != "ascii") {
      refuse(fmt::format("format {}, but only ascii is read; foamFormatConvert makes it that",
                         quoted(value)));
    }
    if (key == "class" && value != kind) {
      refuse(fmt::format("class {}, but '{}' is expected", quoted(value), kind));
    }
    if (value == ";") continue;
    while (next() != ";") continue;
  }
}

}  // namespace vdb_offset
