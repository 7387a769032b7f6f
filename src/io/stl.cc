// STL as text or as floats, little-endian: a header of 80 bytes, a count, and 50 bytes a triangle.
// Its own word for text, "solid", begins many a binary header too, so length and zero bytes decide.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "io/number_text.h"
#include "io/polygon_parse.h"
#include "io/text_words.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kHeader = 80;
constexpr std::size_t kStart = kHeader + 4;
constexpr std::size_t kTriangle = 50;

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t n = 4; n > 0; --n) value = value << 8 | static_cast<unsigned char>(bytes[n - 1]);
  return value;
}

/// As many triangles as it counts, and less than one more.
bool has_binary_length(std::string_view bytes) {
  if (bytes.size() < kStart + kTriangle) return false;
  const std::size_t count = little_endian(bytes.substr(kHeader));
  return count == (bytes.size() - kStart) / kTriangle;
}

/// Words of STL are of either case.
bool is_word(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

bool begins_as_text(std::string_view bytes) {
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
  TextWords words(bytes.substr(0, 4096));
  return words.next() && is_word(words.word(), "solid");
}

/// A header that begins with "solid" may be followed by floats: no text has bytes such as these
/// have, 0 and other control characters.
bool is_text(std::string_view bytes) {
  constexpr std::string_view kSpaces = "\t\n\v\f\r";
  const auto is_binary = [&](char c) {
    return (static_cast<unsigned char>(c) < ' ' && kSpaces.find(c) == std::string_view::npos) ||
           c == '\x7F';
  };
  constexpr std::size_t kLooked = kStart + 20 * kTriangle;
  return begins_as_text(bytes) && std::ranges::none_of(bytes.substr(0, kLooked), is_binary);
}

class StlText {
 public:
  explicit StlText(const PolygonText& text)
      : text_(text), words_(without_mark(text.bytes)), builder_(text.name, "line") {}

  PolygonMesh read();

 private:
  static std::string_view without_mark(std::string_view bytes) {
    return bytes.substr(bytes.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0);
  }
  IoError error(std::string_view what) const {
    return text_.at_line(words_.line(), what, "write the file again");
  }
  void expect(std::string_view word);
  void begin_solid();
  void read_facet();
  int read_vertex();

  const PolygonText& text_;
  TextWords words_;
  PolygonBuilder builder_;
  NameList solids_;
  std::vector<int> family_;  // of each face
  int solid_ = 0;
  int count_ = 0;
  std::vector<int> corners_;
};

void StlText::expect(std::string_view word) {
  if (!words_.next()) throw error(fmt::format("the file ends where '{}' belongs", word));
  if (!is_word(words_.word(), word)) {
    throw error(fmt::format("{} where '{}' belongs", quoted(words_.word()), word));
  }
}

void StlText::begin_solid() {
  ++count_;
  const std::string_view name = words_.rest_of_line();
  solid_ = solids_.index_of(name.empty() && count_ > 1 ? fmt::format("solid {}", count_)
                                                       : std::string(name));
}

int StlText::read_vertex() {
  Vec3 point;
  for (int c = 0; c < 3; ++c) {
    const bool more = words_.next();
    const std::optional<double> value = more ? parse_real(words_.word()) : std::nullopt;
    if (!value)
      throw error(fmt::format("{} = {} is not a number", "xyz"[c], quoted(words_.word())));
    point[c] = *value;
  }
  return builder_.add_point(point, words_.line());
}

/// The normal is passed over: the order of the vertices says it too, and is seldom wrong.
void StlText::read_facet() {
  constexpr int kNormalWords = 5;  // "normal", three numbers, and one that is to spare
  int words = 0;
  while (words_.next() && !is_word(words_.word(), "outer")) {
    if (++words > kNormalWords) throw error("a facet without its 'outer loop'");
  }
  expect("loop");
  corners_.clear();
  while (words_.next() && is_word(words_.word(), "vertex")) corners_.push_back(read_vertex());
  if (!is_word(words_.word(), "endloop")) {
    throw error(fmt::format("{} where 'vertex' or 'endloop' belongs", quoted(words_.word())));
  }
  if (corners_.size() < 3) throw error(fmt::format("a facet of {} vertices", corners_.size()));
  expect("endfacet");
  builder_.add_face(corners_);
  family_.push_back(solid_);
}

PolygonMesh StlText::read() {
  bool inside = false;
  while (words_.next()) {
    const std::string_view word = words_.word();
    if (!inside && is_word(word, "solid")) {
      begin_solid();
      inside = true;
    } else if (inside && is_word(word, "facet")) {
      read_facet();
    } else if (inside && is_word(word, "endsolid")) {
      words_.rest_of_line();
      inside = false;
    } else {
      throw error(fmt::format("{} where {} belongs", quoted(word),
                              inside ? "'facet' or 'endsolid'" : "'solid'"));
    }
  }
  if (inside) throw error("the file ends without 'endsolid'");
  builder_.set_families(solids_, std::move(family_));
  return builder_.finish();
}

PolygonMesh read_binary(const PolygonText& text) {
  const std::string_view bytes = text.bytes;
  if (bytes.size() < kStart) {
    throw text.at_byte(bytes.size(),
                       "the file ends in the header of a binary STL file, which has 84 bytes, and "
                       "it does not begin with 'solid', as a text does",
                       "write the file again");
  }
  const std::size_t count = little_endian(bytes.substr(kHeader));
  if (!has_binary_length(bytes) && count > 0) {
    throw text.at_byte(kHeader,
                       fmt::format("counts {} triangles, which take {} bytes, and the file has {}",
                                   count, kStart + kTriangle * count, bytes.size()),
                       "it is cut off, several files in one, or no STL; write it again");
  }
  PolygonBuilder builder(text.name, "byte");
  builder.reserve(3 * count, count);
  std::vector<int> corners(3);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = kStart + kTriangle * t + 12 * (c + 1);
      Vec3 point;
      for (std::size_t k = 0; k < 3; ++k) {
        point[static_cast<Eigen::Index>(k)] =
            static_cast<double>(std::bit_cast<float>(little_endian(bytes.substr(at + 4 * k))));
      }
      corners[c] = builder.add_point(point, at);
    }
    builder.add_face(corners);
  }
  return builder.finish();
}

}  // namespace

bool is_stl(std::string_view bytes) { return has_binary_length(bytes) || begins_as_text(bytes); }

PolygonMesh parse_stl(const PolygonText& text) {
  const bool as_text = is_text(text.bytes) && !has_binary_length(text.bytes);
  return as_text ? StlText(text).read() : read_binary(text);
}

}  // namespace vdb_offset
