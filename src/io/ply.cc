// PLY (Turk, The PLY Polygon File Format, 1994): rows of elements, as its header describes them.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "io/number_text.h"
#include "io/ply_header.h"
#include "io/polygon_parse.h"
#include "io/text_words.h"

namespace vdb_offset {
namespace {

/// Where a row stands, for messages.
struct Row {
  const PlyElement* element = nullptr;
  std::uint64_t number = 0;
};

std::string describe(const Row& row) {
  return fmt::format("row {} of {} of element {}", row.number + 1, row.element->count,
                     vdb_offset::quoted(row.element->name));
}

/// Numbers of an ascii body.
class TextValues {
 public:
  static constexpr const char* kUnit = "line";

  TextValues(const PolygonText& text, const PlyHeader& header)
      : text_(text),
        words_(text.bytes.substr(header.end), '\0', header.lines + 1),
        left_(text.bytes.size() - header.end) {}

  /// Bytes that a row takes at least: a digit and a blank each.
  static std::size_t least_bytes(const PlyElement& element) {
    return 2 * element.properties.size();
  }
  std::size_t bytes() const { return left_ + 1; }
  std::size_t place() const { return words_.line(); }
  IoError error(std::string_view what, std::string_view advice) const {
    return text_.at_line(words_.line(), what, advice);
  }

  double real(PlyType /*type*/, const Row& row) {
    const std::optional<double> value = parse_real(next(row));
    if (!value) throw error(fmt::format("{} is not a number", quoted(words_.word())), kMend);
    return *value;
  }
  std::int64_t whole(PlyType /*type*/, const Row& row) {
    const std::optional<std::int64_t> value = parse_whole(next(row));
    if (!value) throw error(fmt::format("{} is not a whole number", quoted(words_.word())), kMend);
    return *value;
  }
  void skip(PlyType /*type*/, std::uint64_t count, const Row& row) {
    for (std::uint64_t n = 0; n < count; ++n) next(row);
  }
  void end_row(const Row& row) {
    if (!words_.next_of_line()) return;
    throw error(
        fmt::format("{} after the last property of {}", quoted(words_.word()), describe(row)),
        kMend);
  }
  /// Of an element without lists, rows at once: as text they have no length.
  static bool skip_rows(const PlyElement& /*element*/, std::size_t /*least*/) { return false; }
  void end() {
    if (words_.next()) throw error("rows go on after those that the header counts", kMend);
  }

 private:
  static constexpr const char* kMend = "header and rows must agree; write the file again";

  std::string_view next(const Row& row) {
    if (words_.next()) return words_.word();
    throw error("the file ends in " + describe(row), kMend);
  }

  const PolygonText& text_;
  TextWords words_;
  std::size_t left_;
};

/// Numbers of a binary body.
class BinaryValues {
 public:
  static constexpr const char* kUnit = "byte";

  BinaryValues(const PolygonText& text, const PlyHeader& header)
      : text_(text), at_(header.end), big_(header.encoding == PlyEncoding::BigEndian) {}

  static std::size_t least_bytes(const PlyElement& element) {
    std::size_t bytes = 0;
    for (const PlyProperty& p : element.properties) bytes += size_of(p.count_type.value_or(p.type));
    return bytes;
  }
  std::size_t bytes() const { return text_.bytes.size() - at_; }
  std::size_t place() const { return at_; }
  IoError error(std::string_view what, std::string_view advice) const {
    return text_.at_byte(at_, what, advice);
  }

  double real(PlyType type, const Row& row) {
    if (type == PlyType::Float32) {
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw(type, row))));
    }
    if (type == PlyType::Float64) return std::bit_cast<double>(raw(type, row));
    return static_cast<double>(whole(type, row));
  }
  std::int64_t whole(PlyType type, const Row& row) {
    const std::uint64_t bits = raw(type, row);
    switch (type) {
      case PlyType::Int8:
        return static_cast<std::int8_t>(bits);
      case PlyType::Int16:
        return static_cast<std::int16_t>(bits);
      case PlyType::Int32:
        return static_cast<std::int32_t>(bits);
      default:
        return static_cast<std::int64_t>(bits);
    }
  }
  void skip(PlyType type, std::uint64_t count, const Row& row) {
    if (count > bytes() / size_of(type)) ends_in(row);
    at_ += count * size_of(type);
  }
  void end_row(const Row& /*row*/) {}
  bool skip_rows(const PlyElement& element, std::size_t least) {
    if (element.has_lists()) return false;
    at_ += element.count * least;  // not beyond the end: the count was checked
    return true;
  }
  void end() {
    using namespace std::string_view_literals;
    if (text_.bytes.find_first_not_of("\0 \t\r\n"sv, at_) == std::string_view::npos) return;
    throw error(fmt::format("{} bytes more than the header counts", bytes()),
                "header and rows must agree; write the file again");
  }

 private:
  [[noreturn]] void ends_in(const Row& row) const {
    throw error("the file ends in " + describe(row), "it is cut off; write it again");
  }
  std::uint64_t raw(PlyType type, const Row& row) {
    const std::size_t size = size_of(type);
    if (bytes() < size) ends_in(row);
    std::uint64_t bits = 0;
    for (std::size_t n = 0; n < size; ++n) {
      const std::size_t from = big_ ? n : size - 1 - n;
      bits = bits << 8 | static_cast<unsigned char>(text_.bytes[at_ + from]);
    }
    at_ += size;
    return bits;
  }

  const PolygonText& text_;
  std::size_t at_;
  bool big_;
};

/// What of the header makes a surface.
struct Wanted {
  const PlyElement* vertex = nullptr;
  const PlyElement* face = nullptr;
  std::array<std::size_t, 3> xyz{};  // properties of `vertex`
  std::size_t corners = 0;           // property of `face`
};

Wanted find_wanted(const PolygonText& text, const PlyHeader& header) {
  Wanted wanted;
  bool strips = false;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") wanted.vertex = &element;
    if (element.name == "face") wanted.face = &element;
    strips = strips || element.name == "tristrips";
  }
  if (wanted.vertex == nullptr || wanted.face == nullptr) {
    throw text.at_line(header.lines,
                       fmt::format("no element 'vertex' or no element 'face'{}",
                                   strips ? ", but triangle strips" : ""),
                       "a surface has both; write it as polygons");
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "xyz"[c]);
    const auto found = wanted.vertex->find(name);
    if (!found || wanted.vertex->properties[*found].count_type) {
      throw text.at_line(wanted.vertex->line, "vertices without a number '" + name + "'",
                         "they need x, y and z");
    }
    wanted.xyz[c] = *found;
  }
  auto found = wanted.face->find("vertex_indices");
  if (!found) found = wanted.face->find("vertex_index");
  const PlyProperty* list = found ? &wanted.face->properties[*found] : nullptr;
  if (list == nullptr || !list->count_type || list->type == PlyType::Float32 ||
      list->type == PlyType::Float64) {
    throw text.at_line(wanted.face->line, "faces without a list of whole numbers 'vertex_indices'",
                       "it says which vertices are their corners");
  }
  wanted.corners = *found;
  if (wanted.vertex->count > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
    throw LimitError(fmt::format("{}, line {}: counts {} vertices; 2^31 - 1 are the most",
                                 text.name, wanted.vertex->line, wanted.vertex->count));
  }
  return wanted;
}

template <typename Values>
class PlyBody {
 public:
  PlyBody(const PolygonText& text, const PlyHeader& header)
      : text_(text),
        header_(header),
        wanted_(find_wanted(text, header)),
        values_(text, header),
        builder_(text.name, Values::kUnit) {}

  PolygonMesh read() {
    for (const PlyElement& element : header_.elements) read_element(element);
    values_.end();
    return builder_.finish();
  }

 private:
  void read_element(const PlyElement& element);
  void read_vertex(const Row& row);
  void read_face(const Row& row);
  void skip_property(const PlyProperty& property, const Row& row) {
    const std::uint64_t count = property.count_type ? list_length(property, row) : 1;
    values_.skip(property.type, count, row);
  }
  std::uint64_t list_length(const PlyProperty& property, const Row& row) {
    const std::int64_t count = values_.whole(*property.count_type, row);
    if (count >= 0) return static_cast<std::uint64_t>(count);
    throw values_.error(fmt::format("a list of {} values in {}", count, describe(row)),
                        "a count is not negative");
  }

  const PolygonText& text_;
  const PlyHeader& header_;
  Wanted wanted_;
  Values values_;
  PolygonBuilder builder_;
  std::vector<int> corners_;
};

template <typename Values>
void PlyBody<Values>::read_element(const PlyElement& element) {
  const std::size_t least = Values::least_bytes(element);
  if (least == 0) return;  // rows of nothing
  if (element.count > values_.bytes() / least) {
    throw text_.at_line(
        element.line,
        fmt::format("counts {} rows of element {}, of {} bytes each at least, and "
                    "{} bytes follow",
                    element.count, vdb_offset::quoted(element.name), least, values_.bytes()),
        "the file is cut off, or the count is wrong; write it again");
  }
  const bool wanted = &element == wanted_.vertex || &element == wanted_.face;
  if (!wanted && values_.skip_rows(element, least)) return;
  if (&element == wanted_.vertex) builder_.reserve(element.count, 0);
  for (Row row{&element, 0}; row.number < element.count; ++row.number) {
    if (&element == wanted_.vertex) {
      read_vertex(row);
    } else if (&element == wanted_.face) {
      read_face(row);
    } else {
      for (const PlyProperty& property : element.properties) skip_property(property, row);
    }
    values_.end_row(row);
  }
}

template <typename Values>
void PlyBody<Values>::read_vertex(const Row& row) {
  const std::size_t place = values_.place();
  const auto& properties = row.element->properties;
  Vec3 point;
  for (std::size_t n = 0; n < properties.size(); ++n) {
    const auto axis = std::find(wanted_.xyz.begin(), wanted_.xyz.end(), n);
    if (axis == wanted_.xyz.end()) {
      skip_property(properties[n], row);
    } else {
      point[axis - wanted_.xyz.begin()] = values_.real(properties[n].type, row);
    }
  }
  builder_.add_point(point, place);
}

template <typename Values>
void PlyBody<Values>::read_face(const Row& row) {
  const auto& properties = row.element->properties;
  corners_.clear();
  for (std::size_t n = 0; n < properties.size(); ++n) {
    if (n != wanted_.corners) {
      skip_property(properties[n], row);
      continue;
    }
    const std::uint64_t count = list_length(properties[n], row);
    for (std::uint64_t c = 0; c < count; ++c) {
      const std::int64_t vertex = values_.whole(properties[n].type, row);
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= wanted_.vertex->count) {
        throw values_.error(fmt::format("{} is no vertex, of {}, in {}", vertex,
                                        wanted_.vertex->count, describe(row)),
                            "indices count from 0");
      }
      corners_.push_back(static_cast<int>(vertex));
    }
  }
  builder_.add_face(corners_);
}

}  // namespace

PolygonMesh parse_ply(const PolygonText& text) {
  const PlyHeader header = parse_ply_header(text);
  if (header.encoding == PlyEncoding::Ascii) return PlyBody<TextValues>(text, header).read();
  return PlyBody<BinaryValues>(text, header).read();
}

}  // namespace vdb_offset
