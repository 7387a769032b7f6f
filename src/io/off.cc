// Geomview's OFF as text: counts, points with what else they have on their lines, faces with
// colours after their corners.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "io/number_text.h"
#include "io/polygon_parse.h"
#include "io/text_words.h"

namespace vdb_offset {
namespace {

/// "OFF" after the prefixes that three dimensions allow, in their order; nothing if it is no such
/// word; else the prefixes.
std::optional<std::string_view> prefixes_of(std::string_view word) {
  if (word.size() < 3 || word.substr(word.size() - 3) != "OFF") return {};
  const std::string_view prefixes = word.substr(0, word.size() - 3);
  std::string_view rest = prefixes;
  for (const std::string_view known : {"ST", "C", "N", "4", "n"}) {
    if (rest.substr(0, known.size()) == known) rest.remove_prefix(known.size());
  }
  return rest.empty() ? std::optional(prefixes) : std::nullopt;
}

std::string_view without_mark(std::string_view bytes) {
  return bytes.substr(bytes.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0);
}

class OffParser {
 public:
  explicit OffParser(const PolygonText& text)
      : text_(text), words_(without_mark(text.bytes), '#'), builder_(text.name, "line") {}

  PolygonMesh read();

 private:
  IoError error(std::string_view what, std::string_view advice) const {
    return text_.at_line(words_.line(), what, advice);
  }
  IoError no_point(std::size_t line, std::size_t point) const {
    return text_.at_line(
        line, fmt::format("{} is no point, of {}", point, points_),
        "indices count from 0; take 1 from each if those of the file count from 1");
  }
  void check_header(std::string_view prefixes);
  void read_counts();
  std::size_t whole(std::string_view what);
  void read_point();
  void read_face();
  void mend_counting();

  const PolygonText& text_;
  TextWords words_;
  PolygonBuilder builder_;
  std::size_t points_ = 0;
  std::size_t faces_ = 0;
  std::vector<int> corners_;
  std::size_t lowest_ = std::numeric_limits<std::size_t>::max();  // corner of all
  std::size_t past_line_ = 0;  // first that names the point past the last
};

void OffParser::check_header(std::string_view prefixes) {
  if (prefixes.find_first_of("4n") != std::string_view::npos) {
    throw error(fmt::format("{} has points of other than three dimensions", quoted(words_.word())),
                "write it as OFF");
  }
  TextWords ahead = words_;
  if (!ahead.next_of_line() || ahead.word() != "BINARY") return;
  throw error("binary OFF", "only its text is read; write it as text, or as binary PLY");
}

std::size_t OffParser::whole(std::string_view what) {
  const bool more = words_.next();
  const auto value = more ? parse_whole(words_.word()) : std::nullopt;
  if (!value || *value < 0) {
    throw error(more ? fmt::format("{} is no whole number, {}", quoted(words_.word()), what)
                     : fmt::format("the file ends before {}", what),
                "complete the file");
  }
  return static_cast<std::size_t>(*value);
}

/// Of edges there may be a count, which nobody needs.
void OffParser::read_counts() {
  points_ = whole("the count of points");
  faces_ = whole("the count of faces");
  words_.rest_of_line();
  constexpr std::size_t kPoint = 6;  // bytes of "0 0 0" and a blank
  constexpr std::size_t kFace = 2;   // of "0" and a blank
  const std::size_t bytes = text_.bytes.size();
  if (points_ > bytes / kPoint || faces_ > bytes / kFace ||
      kPoint * points_ + kFace * faces_ > bytes) {
    throw error(fmt::format("counts {} points and {} faces, and the file has {} bytes", points_,
                            faces_, bytes),
                "it is cut off, or the counts are wrong; complete it");
  }
  builder_.reserve(points_, faces_);
}

void OffParser::read_point() {
  Vec3 point;
  for (int c = 0; c < 3; ++c) {
    if (!words_.next()) {
      throw error(fmt::format("the file ends in point {} of {}", builder_.points(), points_),
                  "complete it");
    }
    const std::optional<double> value = parse_real(words_.word());
    if (!value) {
      throw error(fmt::format("{} = {} of point {} is not a number", "xyz"[c],
                              quoted(words_.word()), builder_.points()),
                  "points begin with x, y and z");
    }
    point[c] = *value;
  }
  builder_.add_point(point, words_.line());
  words_.rest_of_line();
}

void OffParser::read_face() {
  const std::size_t count = whole("the count of corners of a face");
  corners_.clear();
  for (std::size_t c = 0; c < count; ++c) {
    const std::size_t point = whole("a corner of a face");
    if (point > points_) throw no_point(words_.line(), point);
    if (point == points_ && past_line_ == 0) past_line_ = words_.line();
    lowest_ = std::min(lowest_, point);
    corners_.push_back(static_cast<int>(point));
  }
  builder_.add_face(corners_);
  words_.rest_of_line();
}

/// Where the point past the last is named, and the one of index 1 but none of 0, indices can only
/// be counted from 1.
void OffParser::mend_counting() {
  if (past_line_ == 0) return;
  if (lowest_ != 1) throw no_point(past_line_, points_);
  builder_.count_from_one();
}

PolygonMesh OffParser::read() {
  TextWords ahead = words_;
  if (!ahead.next()) throw error("the file is empty", "it begins with 'OFF' and counts");
  if (const auto prefixes = prefixes_of(ahead.word())) {
    words_ = ahead;
    check_header(*prefixes);
  }
  read_counts();
  while (builder_.points() < points_) read_point();
  while (builder_.faces() < faces_) read_face();
  mend_counting();
  if (words_.next()) {
    throw error(
        fmt::format("{} after the {} faces that are counted", quoted(words_.word()), faces_),
        "counts and lines must agree; write the file again");
  }
  return builder_.finish();
}

}  // namespace

bool is_off(std::string_view bytes) {
  TextWords words(without_mark(bytes).substr(0, 4096), '#');
  return words.next() && prefixes_of(words.word()).has_value();
}

PolygonMesh parse_off(const PolygonText& text) { return OffParser(text).read(); }

}  // namespace vdb_offset
