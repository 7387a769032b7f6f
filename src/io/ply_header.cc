// The header of a PLY file: lines of text that say what rows of numbers follow.

#include "io/ply_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/number_text.h"
#include "io/text_lines.h"

namespace vdb_offset {
namespace {

using Words = std::vector<std::string_view>;

std::optional<PlyType> type_of(std::string_view word) {
  constexpr std::array<std::array<const char*, 2>, 8> kNames{{{"char", "int8"},
                                                              {"uchar", "uint8"},
                                                              {"short", "int16"},
                                                              {"ushort", "uint16"},
                                                              {"int", "int32"},
                                                              {"uint", "uint32"},
                                                              {"float", "float32"},
                                                              {"double", "float64"}}};
  for (std::size_t n = 0; n < kNames.size(); ++n) {
    if (word == kNames[n][0] || word == kNames[n][1]) return static_cast<PlyType>(n);
  }
  return {};
}

bool is_real(PlyType type) { return type == PlyType::Float32 || type == PlyType::Float64; }

/// Lines of the header one after another, with their ends: what ends the first may end the last,
/// and of bytes that follow none may be taken for an end of line.
class HeaderLines {
 public:
  explicit HeaderLines(const PolygonText& text) : text_(text) {}

  std::string_view next() {
    const std::string_view bytes = text_.bytes;
    ++number_;
    const std::size_t end = bytes.find_first_of("\r\n", at_);
    if (end == std::string_view::npos) {
      throw text_.at_line(number_, "the file ends in its header, without 'end_header'",
                          "write it again");
    }
    const std::string_view line = bytes.substr(at_, end - at_);
    // Where lines end in '\r' alone a '\n' behind the last of them is the body's.
    const bool is_pair = bytes.substr(end, 2) == "\r\n";
    if (number_ == 1) is_lone_ = bytes[end] == '\r' && !is_pair;
    const bool pair = is_pair && !is_lone_;
    at_ = end + (pair ? 2 : 1);
    return line;
  }
  std::size_t number() const { return number_; }
  std::size_t at() const { return at_; }

 private:
  const PolygonText& text_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
  bool is_lone_ = false;
};

class HeaderParser {
 public:
  explicit HeaderParser(const PolygonText& text) : text_(text), lines_(text) {}
  PlyHeader read();

 private:
  IoError error(std::string_view what, std::string_view advice) const {
    return text_.at_line(lines_.number(), what, advice);
  }
  void take(const Words& words);
  void take_format(const Words& words);
  void take_element(const Words& words);
  void take_property(const Words& words);

  const PolygonText& text_;
  HeaderLines lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

void HeaderParser::take_format(const Words& words) {
  const std::string_view word = words.size() > 1 ? words[1] : "";
  has_format_ = true;
  if (word == "ascii") {
    header_.encoding = PlyEncoding::Ascii;
  } else if (word == "binary_little_endian") {
    header_.encoding = PlyEncoding::LittleEndian;
  } else if (word == "binary_big_endian") {
    header_.encoding = PlyEncoding::BigEndian;
  } else {
    throw error(fmt::format("the format {}", quoted(word)),
                "PLY has ascii, binary_little_endian and binary_big_endian");
  }
}

void HeaderParser::take_element(const Words& words) {
  const auto count = words.size() == 3 ? parse_whole(words[2]) : std::nullopt;
  if (!count || *count < 0) {
    throw error("an element without its name and count", "it is 'element NAME COUNT'");
  }
  const std::string name(words[1]);
  for (const PlyElement& element : header_.elements) {
    if (element.name == name) {
      throw error(fmt::format("a second element {}", vdb_offset::quoted(name)),
                  "one of a name is allowed");
    }
  }
  header_.elements.push_back({name, static_cast<std::uint64_t>(*count), lines_.number(), {}});
}

void HeaderParser::take_property(const Words& words) {
  constexpr const char* kForms = "it is 'property TYPE NAME' or 'property list TYPE TYPE NAME'";
  if (header_.elements.empty()) throw error("a property before the first element", kForms);
  const bool list = words.size() > 1 && words[1] == "list";
  if (words.size() != (list ? 5U : 3U)) throw error("a property of no known form", kForms);
  PlyProperty property{std::string(words.back()), {}, {}};
  const auto type = [&](std::string_view word) {
    const std::optional<PlyType> known = type_of(word);
    if (known) return *known;
    throw error(fmt::format("the type {}", quoted(word)),
                "PLY has char, uchar, short, ushort, int, uint, float and double, and int8 to "
                "float64");
  };
  property.type = type(words[words.size() - 2]);
  if (list) {
    property.count_type = type(words[2]);
    if (is_real(*property.count_type)) {
      throw error("a list counted by fractions", "counts are of whole types");
    }
  }
  header_.elements.back().properties.push_back(std::move(property));
}

void HeaderParser::take(const Words& words) {
  const std::string_view word = words[0];
  if (word == "format") {
    take_format(words);
  } else if (word == "element") {
    take_element(words);
  } else if (word == "property") {
    take_property(words);
  } else if (word != "comment" && word != "obj_info") {
    throw error(fmt::format("{} in a header", quoted(word)),
                "it has format, element, property, comment, obj_info and end_header");
  }
}

PlyHeader HeaderParser::read() {
  if (tokens_of(lines_.next()) != Words{"ply"}) {
    throw error("does not begin with 'ply'", "check that it is a PLY file");
  }
  while (true) {
    const Words words = tokens_of(lines_.next());
    if (words.empty()) continue;
    if (words[0] == "end_header") break;
    take(words);
  }
  if (!has_format_) throw error("a header without 'format'", "add it");
  header_.lines = lines_.number();
  header_.end = lines_.at();
  return std::move(header_);
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::ranges::any_of(properties, [](const PlyProperty& p) { return bool(p.count_type); });
}

std::optional<std::size_t> PlyElement::find(const std::string& property) const {
  for (std::size_t n = 0; n < properties.size(); ++n) {
    if (properties[n].name == property) return n;
  }
  return {};
}

PlyHeader parse_ply_header(const PolygonText& text) { return HeaderParser(text).read(); }

}  // namespace vdb_offset
