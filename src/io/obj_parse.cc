// The part of Wavefront's .obj that curves need: vertices, lines, polygons and names.

#include "io/obj_parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "io/number_text.h"
#include "io/text_lines.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

using Tokens = std::vector<std::string_view>;

class ObjParser {
 public:
  explicit ObjParser(const std::string& name) : name_(name) {}

  void take(const Tokens& tokens, std::size_t line);
  /// The file, when all indices are found to be good.
  ObjFile finish();

 private:
  IoError error(std::size_t line, std::string_view what, std::string_view advice) const {
    return IoError(fmt::format("{}, line {}: {}; {}", name_, line, what, advice),
                   {static_cast<std::int64_t>(line)});
  }
  Vec3 vertex(const Tokens& tokens, std::size_t line) const;
  std::size_t index(std::string_view token, std::size_t line) const;
  ObjElement element(const Tokens& tokens, std::size_t line) const;

  const std::string& name_;
  ObjFile file_;
};

Vec3 ObjParser::vertex(const Tokens& tokens, std::size_t line) const {
  if (tokens.size() < 4) {
    throw error(line, fmt::format("a vertex of {} numbers", tokens.size() - 1),
                "'v' takes three: x, y and z");
  }
  constexpr double kLargest = 1e100;  // beyond that squares and their sums overflow
  Vec3 point;
  for (int c = 0; c < 3; ++c) {
    const std::string_view token = tokens[static_cast<std::size_t>(c) + 1];
    const std::optional<double> value = parse_real(token);
    if (!value || !(std::abs(*value) <= kLargest)) {
      throw error(line, fmt::format("{} = {} is not a finite number", "xyz"[c], quoted(token)),
                  "'v' takes three: x, y and z");
    }
    point[c] = *value;
  }
  return point;
}

/// Those of vertices further on are checked by `finish`.
std::size_t ObjParser::index(std::string_view token, std::size_t line) const {
  const std::size_t count = file_.vertices.size();
  const std::optional<std::size_t> vertex = obj_vertex(token, count);
  if (vertex) return *vertex;
  throw error(line, fmt::format("{} is no vertex, of the {} so far", quoted(token), count),
              "indices count from 1, or back from -1");
}

ObjElement ObjParser::element(const Tokens& tokens, std::size_t line) const {
  const std::size_t least = tokens[0] == "f" ? 3 : 2;
  if (tokens.size() < least + 1) {
    throw error(line, fmt::format("'{}' names {} vertices", tokens[0], tokens.size() - 1),
                fmt::format("it takes {} at least", least));
  }
  ObjElement element{{}, file_.groups.size() - 1, line};
  element.vertices.reserve(tokens.size() - 1);
  for (std::size_t n = 1; n < tokens.size(); ++n) {
    element.vertices.push_back(index(tokens[n], line));
  }
  return element;
}

void ObjParser::take(const Tokens& tokens, std::size_t line) {
  const std::string_view word = tokens[0];
  if (word == "v") {
    file_.vertices.push_back(vertex(tokens, line));
  } else if (word == "l") {
    file_.lines.push_back(element(tokens, line));
  } else if (word == "f") {
    // A second one is a reason to refuse the file, and one reason will do.
    if (file_.faces.size() < 2) file_.faces.push_back(element(tokens, line));
  } else if (word == "o" || word == "g") {
    std::string joined(tokens.size() > 1 ? tokens[1] : "");
    for (std::size_t n = 2; n < tokens.size(); ++n) (joined += ' ') += tokens[n];
    file_.groups.push_back(std::move(joined));
  }
}

ObjFile ObjParser::finish() {
  for (const auto* elements : {&file_.lines, &file_.faces}) {
    for (const ObjElement& element : *elements) {
      for (const std::size_t vertex : element.vertices) {
        if (vertex < file_.vertices.size()) continue;
        throw error(element.line,
                    fmt::format("{} is no vertex, of the {} of the file", vertex + 1,
                                file_.vertices.size()),
                    "complete the file");
      }
    }
  }
  return std::move(file_);
}

/// Chains of edges, each used once.
class Chainer {
 public:
  explicit Chainer(std::vector<const ObjElement*> edges);
  /// The chain through `edge` in its sense; nothing if it is part of an earlier one.
  std::optional<ObjElement> chain(std::size_t edge);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// The edge beyond `vertex`, of the two that meet there alone, if it is still free.
  std::size_t beyond(std::size_t vertex) const;
  std::size_t other_end(std::size_t edge, std::size_t vertex) const {
    const std::vector<std::size_t>& ends = edges_[edge]->vertices;
    return ends[0] == vertex ? ends[1] : ends[0];
  }
  void walk(std::vector<std::size_t>& vertices);

  std::vector<const ObjElement*> edges_;
  std::vector<bool> used_;
  std::vector<std::pair<std::size_t, std::size_t>> at_;  // vertex and edge, sorted
};

Chainer::Chainer(std::vector<const ObjElement*> edges)
    : edges_(std::move(edges)), used_(edges_.size(), false) {
  at_.reserve(2 * edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    for (const std::size_t vertex : edges_[e]->vertices) at_.emplace_back(vertex, e);
  }
  std::sort(at_.begin(), at_.end());
}

std::size_t Chainer::beyond(std::size_t vertex) const {
  const auto first = std::lower_bound(at_.begin(), at_.end(), std::pair{vertex, std::size_t{0}});
  const auto meets = [&](std::ptrdiff_t n) {
    return at_.end() - first > n && first[n].first == vertex;
  };
  if (!meets(1) || meets(2)) return kNone;
  for (const std::ptrdiff_t n : {0, 1}) {
    if (!used_[first[n].second]) return first[n].second;
  }
  return kNone;
}

void Chainer::walk(std::vector<std::size_t>& vertices) {
  for (std::size_t e = beyond(vertices.back()); e != kNone; e = beyond(vertices.back())) {
    used_[e] = true;
    vertices.push_back(other_end(e, vertices.back()));
  }
}

std::optional<ObjElement> Chainer::chain(std::size_t edge) {
  if (used_[edge]) return {};
  used_[edge] = true;
  ObjElement chain = *edges_[edge];
  walk(chain.vertices);
  if (chain.vertices.front() == chain.vertices.back()) return chain;
  std::reverse(chain.vertices.begin(), chain.vertices.end());
  walk(chain.vertices);
  std::reverse(chain.vertices.begin(), chain.vertices.end());
  return chain;
}

/// Up to a '#' that begins a word: "1.#IND" is how some write what is no number.
std::string_view without_comment(std::string_view line) {
  for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
    if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
  }
  return line;
}

}  // namespace

void for_obj_lines(std::string_view bytes, const ObjStatement& take) {
  std::string pending;  // lines that a backslash continues
  std::size_t begin = 0;
  const auto end_statement = [&](std::string_view statement) {
    const Tokens tokens = tokens_of(statement);
    if (!tokens.empty()) take(tokens, begin);
    begin = 0;
  };
  for (TextLines lines(bytes); lines.next();) {
    const std::string_view line = without_comment(lines.line());
    if (begin == 0) begin = lines.number();
    const bool goes_on = !line.empty() && line.back() == '\\';
    if (!goes_on && pending.empty()) {
      end_statement(line);
      continue;
    }
    pending += line.substr(0, line.size() - (goes_on ? 1 : 0));
    pending += ' ';
    if (goes_on) continue;
    end_statement(pending);
    pending.clear();
  }
  end_statement(pending);
}

std::optional<std::size_t> obj_vertex(std::string_view token, std::size_t count) {
  const std::optional<std::int64_t> value = parse_whole(token.substr(0, token.find('/')));
  if (!value || *value == 0) return {};
  if (*value > 0) return static_cast<std::size_t>(*value - 1);
  const std::uint64_t back = std::uint64_t{0} - static_cast<std::uint64_t>(*value);
  if (back > count) return {};
  return count - static_cast<std::size_t>(back);
}

ObjFile parse_obj(std::string_view bytes, const std::string& name) {
  ObjParser parser(name);
  for_obj_lines(bytes, [&](const Tokens& tokens, std::size_t line) { parser.take(tokens, line); });
  return parser.finish();
}

std::vector<ObjElement> chained(const std::vector<ObjElement>& lines) {
  std::vector<ObjElement> out;
  for (std::size_t begin = 0; begin < lines.size();) {
    std::size_t end = begin;  // of the lines of one group, which stand together
    while (end < lines.size() && lines[end].group == lines[begin].group) ++end;
    std::vector<const ObjElement*> edges;
    for (std::size_t n = begin; n < end; ++n) {
      if (lines[n].vertices.size() == 2) edges.push_back(&lines[n]);
    }
    Chainer chainer(edges);
    for (std::size_t n = begin, edge = 0; n < end; ++n) {
      if (lines[n].vertices.size() != 2) {
        out.push_back(lines[n]);
      } else if (std::optional<ObjElement> chain = chainer.chain(edge++)) {
        out.push_back(std::move(*chain));
      }
    }
    begin = end;
  }
  return out;
}

}  // namespace vdb_offset
