#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "io/input_file.h"
#include "io/neutral_faces.h"
#include "io/neutral_parse.h"
#include "io/number_text.h"
#include "io/text_lines.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

/// One entry, of one line or several.
struct Entry {
  std::size_t line = 0;  ///< its first
  std::vector<std::string> tokens = {};
};

/// Takes the words off a line: quoted ones whole, up to a comment. A backslash at the end goes on:
/// true then.
bool take_words(std::string_view line, std::vector<std::string>& tokens) {
  const auto separates = [](char c) { return is_space(c) || c == ','; };
  std::size_t at = 0;
  while (at < line.size()) {
    const char c = line[at];
    if (c == '#') return false;
    if (separates(c)) {
      ++at;
      continue;
    }
    if (c == '\\' && line.find_first_not_of(" \t", at + 1) == std::string_view::npos) return true;
    std::size_t end = at + 1;
    if (c == '\'' || c == '"') {
      end = std::min(line.find(c, at + 1), line.size());
      tokens.emplace_back(line.substr(at + 1, end - at - 1));
      at = end + 1;
      continue;
    }
    while (end < line.size() && !separates(line[end]) && line[end] != '#' && line[end] != '\\')
      ++end;
    tokens.emplace_back(line.substr(at, end - at));
    at = end;
  }
  return false;
}

class MapReader {
 public:
  MapReader(std::string_view bytes, const std::string& name) : lines_(bytes), name_(name) {}

  NeutralMap read() {
    read_sizes();
    Entry entry;
    while (next(entry)) read_entry(entry);
    return std::move(map_);
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& why) const {
    throw IoError(fmt::format("{}, line {}: {}", name_, line, why),
                  {static_cast<std::int64_t>(line)});
  }

  /// The next entry; false after the last.
  bool next(Entry& entry) {
    entry = {};
    bool goes_on = false;
    while (lines_.next()) {
      if (entry.tokens.empty()) entry.line = lines_.number();
      const std::size_t before = entry.tokens.size();
      const bool more = take_words(lines_.line(), entry.tokens);
      if (!more && entry.tokens.size() == before) continue;  // blank, or a comment
      goes_on = more;
      if (!goes_on) return true;
    }
    if (!goes_on) return false;
    refuse(lines_.number(), "the file ends where '\\' says that it goes on");
  }

  /// A token as a whole number in [least, most].
  int number(const Entry& entry, std::size_t token, const char* what, std::array<int, 2> bounds) {
    const std::string& text = entry.tokens[token];
    const auto value = parse_whole(text);
    if (!value)
      refuse(entry.line, fmt::format("{} {} is no whole number", what, vdb_offset::quoted(text)));
    if (*value < bounds[0] || *value > bounds[1]) {
      refuse(entry.line,
             fmt::format("{} = {}, but must be in [{}, {}]", what, *value, bounds[0], bounds[1]));
    }
    return static_cast<int>(*value);
  }

  void read_sizes() {
    constexpr int kLargest = std::numeric_limits<int>::max();
    Entry entry;
    if (!next(entry)) throw IoError(name_ + ": is empty; a neutral map begins with its blocks");
    if (entry.tokens.size() != 1) {
      refuse(entry.line, fmt::format("{} words, but the number of blocks stands here alone",
                                     entry.tokens.size()));
    }
    const int blocks = number(entry, 0, "number of blocks", {1, kLargest});
    for (int b = 1; b <= blocks; ++b) {
      if (!next(entry)) {
        refuse(lines_.number(), fmt::format("ends after {} of {} blocks", b - 1, blocks));
      }
      if (entry.tokens.size() != 4) {
        refuse(entry.line, fmt::format("{} words, but block {} is 'number idim jdim kdim'",
                                       entry.tokens.size(), b));
      }
      number(entry, 0, "block number", {b, b});
      map_.sizes.push_back({number(entry, 1, "idim", {1, kLargest}),
                            number(entry, 2, "jdim", {1, kLargest}),
                            number(entry, 3, "kdim", {1, kLargest})});
    }
  }

  /// Six words from `token` on.
  BlockRange range(const Entry& entry, std::size_t token) {
    NeutralRange range;
    range.block = number(entry, token, "block", {1, static_cast<int>(map_.sizes.size())});
    range.face = number(entry, token + 1, "face", {1, 6});
    const std::array<int, 3>& sizes = map_.sizes[static_cast<std::size_t>(range.block) - 1];
    const std::array<std::size_t, 2> axes = neutral_axes(neutral_face(range.face));
    for (std::size_t d = 0; d < 2; ++d) {
      const int last = sizes[axes[d]];
      range.begin[d] = number(entry, token + 2 + 2 * d, d == 0 ? "S1" : "S2", {1, last});
      range.end[d] = number(entry, token + 3 + 2 * d, d == 0 ? "E1" : "E2", {1, last});
    }
    return block_range(range, sizes);
  }

  bool swap(const Entry& entry, std::size_t token) {
    std::string word = neutral_key(entry.tokens[token]);
    std::erase(word, '.');
    if (word != "TRUE" && word != "T" && word != "FALSE" && word != "F") {
      refuse(entry.line, fmt::format("Swap is {}, but must be TRUE or FALSE",
                                     vdb_offset::quoted(entry.tokens[token])));
    }
    return word[0] == 'T';
  }

  void read_entry(const Entry& entry) {
    const std::string& type = entry.tokens[0];
    const std::string key = neutral_key(type);
    const std::size_t words = entry.tokens.size();
    if (key == "ONE_TO_ONE") {
      if (words != 14) refuse(entry.line, wrong_length(type, words, 14));
      const BlockRange first = range(entry, 1);
      map_.interfaces.push_back(neutral_interface(first, range(entry, 7), swap(entry, 13)));
      return;
    }
    const bool is_patched = key == "PATCHED";
    if (words != 7 && !(is_patched && (words == 13 || words == 14))) {
      refuse(entry.line, wrong_length(type, words, 7));
    }
    map_.boundary_faces.push_back(neutral_boundary(type, range(entry, 1)));
    if (!is_patched) return;
    map_.faults.push_back(
        fmt::format("line {}: a patched interface, which is not compared: its faces need not match",
                    entry.line));
    if (words > 7) map_.boundary_faces.push_back(neutral_boundary(type, range(entry, 7)));
  }

  static std::string wrong_length(const std::string& type, std::size_t words, int wanted) {
    return fmt::format(
        "{} has {} words, but must have {}: {}", vdb_offset::quoted(type), words, wanted,
        wanted == 7 ? "type B1 F1 S1 E1 S2 E2" : "type B1 F1 S1 E1 S2 E2 B2 F2 S1 E1 S2 E2 Swap");
  }

  TextLines lines_;
  const std::string& name_;
  NeutralMap map_;
};

}  // namespace

NeutralMap read_neutral_map_bytes(std::string_view bytes, const std::string& name) {
  return MapReader(bytes, name).read();
}

NeutralMap read_neutral_map(const std::filesystem::path& file) {
  return read_neutral_map_bytes(contents_of(file, "a neutral map"), file.string());
}

}  // namespace vdb_offset
