// From the text of an airfoil file to one loop of points. The forms are those of the UIUC Airfoil
// Coordinates Database (Selig and Lednicer), and of programs that write two halves without counts.

#include "io/airfoil_parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "io/curve_points.h"
#include "io/number_text.h"
#include "io/text_lines.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

using Tokens = std::vector<std::string_view>;

/// Points between blank lines.
struct Run {
  Vec3List points;
  std::size_t line = 0;  ///< of the first point
};

struct Rows {
  const std::string& name;
  std::string title;
  std::vector<Run> runs;

  std::size_t points() const {
    std::size_t sum = 0;
    for (const Run& run : runs) sum += run.points.size();
    return sum;
  }
  IoError error(std::size_t line, std::string_view what, std::string_view advice) const {
    return IoError(fmt::format("{}, line {}: {}; {}", name, line, what, advice),
                   {static_cast<std::int64_t>(line)});
  }
};

constexpr std::string_view kPointAdvice = "a point is two numbers, x and y, on a line of its own";

/// Whether a file's first line is its name: not two numbers, nor something that begins like one
/// with a point or an exponent, which would be a damaged point.
bool is_title(const Tokens& tokens) {
  if (!parse_real(tokens[0])) return true;
  if (tokens.size() == 2 && parse_real(tokens[1])) return false;
  return parse_whole(tokens[0]).has_value();
}

Vec3 point_of(const Rows& rows, std::size_t line, const Tokens& tokens) {
  if (tokens.size() != 2) {
    throw rows.error(
        line,
        fmt::format("holds {} words or numbers, the first {}", tokens.size(), quoted(tokens[0])),
        kPointAdvice);
  }
  // Beyond that squares and their sums overflow.
  constexpr double kLargest = 1e100;
  Vec3 point = Vec3::Zero();
  for (int c = 0; c < 2; ++c) {
    const std::string_view token = tokens[static_cast<std::size_t>(c)];
    const std::optional<double> value = parse_real(token);
    if (!value) {
      throw rows.error(line, fmt::format("{} = {} is not a number", "xy"[c], quoted(token)),
                       kPointAdvice);
    }
    if (!(std::abs(*value) <= kLargest)) {
      throw rows.error(line, fmt::format("{} = {} is not finite", "xy"[c], quoted(token)),
                       "give the point, or take its line out");
    }
    point[c] = *value;
  }
  return point;
}

Rows read_rows(std::string_view bytes, const std::string& name) {
  Rows rows{name, {}, {}};
  bool fresh = true;  // the next point begins a run
  bool first = true;
  for (TextLines lines(bytes); lines.next();) {
    const Tokens tokens = tokens_of(lines.line());
    if (tokens.empty()) {
      fresh = true;
      continue;
    }
    if (std::string_view("#!%").find(tokens[0][0]) != std::string_view::npos) continue;
    if (std::exchange(first, false) && is_title(tokens)) {
      rows.title = std::string(lines.line().substr(0, 80));
      continue;
    }
    const Vec3 point = point_of(rows, lines.number(), tokens);
    if (std::exchange(fresh, false)) rows.runs.push_back({{}, lines.number()});
    rows.runs.back().points.push_back(point);
  }
  if (rows.runs.empty()) {
    throw IoError(name + ": holds no points; " + std::string(kPointAdvice));
  }
  return rows;
}

/// Whether the file's first pair are counts: whole, 2 at least, and either right or far from all
/// that follows, as no point of a body is.
bool has_counts(const Rows& rows) {
  const Vec3 pair = rows.runs[0].points[0];
  const auto is_count = [](double v) { return v >= 2 && v == std::floor(v); };
  if (!is_count(pair.x()) || !is_count(pair.y())) return false;
  if (pair.x() + pair.y() == static_cast<double>(rows.points() - 1)) return true;
  Box box;
  for (const Run& run : rows.runs) {
    for (const Vec3& p : run.points) {
      if (&p != rows.runs[0].points.data()) box.add(p);
    }
  }
  const Vec3 nearest = pair.cwiseMax(box.lo).cwiseMin(box.hi);
  return box.empty() || (pair - nearest).norm() > box.size();
}

/// Lednicer's two surfaces; blank lines may stand anywhere but inside a surface.
std::array<Run, 2> take_counted(Rows& rows) {
  Run& front = rows.runs[0];
  const Vec3 counts = front.points[0];
  const std::size_t line = front.line;
  front.points.erase(front.points.begin());
  const std::size_t found = rows.points();
  if (counts.x() + counts.y() != static_cast<double>(found)) {
    throw rows.error(
        line, fmt::format("counts {} and {} points, and {} follow", counts.x(), counts.y(), found),
        "correct the counts, or complete the file");
  }
  std::array<Run, 2> surfaces;
  const auto first = static_cast<std::size_t>(counts.x());
  for (const Run& run : rows.runs) {
    const std::size_t before = surfaces[0].points.size();
    if (before < first && before + run.points.size() > first && run.line != line) {
      throw rows.error(run.line,
                       fmt::format("begins {} points where {} are left of the first surface's {}",
                                   run.points.size(), first - before, first),
                       "correct the counts, or the place of the blank line");
    }
    for (const Vec3& p : run.points) {
      surfaces[surfaces[0].points.size() < first ? 0 : 1].points.push_back(p);
    }
  }
  surfaces[1].line = line;
  return surfaces;
}

double edge_at(const Vec3List& points, std::size_t n) {
  return n + 1 < points.size() ? (points[n + 1] - points[n]).norm() : 0.0;
}

/// Two surfaces that begin at the nose, or the two parts of one loop.
Vec3List joined(const Rows& rows, std::array<Run, 2> halves, AirfoilForm& form) {
  Vec3List& a = halves[0].points;
  const Vec3List& b = halves[1].points;
  const double at_begin = (a.front() - b.front()).norm();
  const double at_end = (a.back() - b.front()).norm();
  // A tenth of the body: the noses of two surfaces need not be one point. A loop goes on by an edge
  // like those before and behind.
  const double near = 0.1 * (size_of(a) + size_of(b));
  const double edge = a.size() < 2 ? 0.0 : edge_at(a, a.size() - 2) + edge_at(b, 0);
  if (at_begin <= at_end ? at_begin > near : at_end > std::max(near, edge)) {
    throw rows.error(halves[1].line,
                     fmt::format("the second surface begins at ({}, {}), and the first runs from "
                                 "({}, {}) to ({}, {})",
                                 b.front().x(), b.front().y(), a.front().x(), a.front().y(),
                                 a.back().x(), a.back().y()),
                     "let both surfaces begin at the nose; give each body a file of its own");
  }
  if (at_begin <= at_end) {
    std::reverse(a.begin(), a.end());
  } else if (form == AirfoilForm::Halves) {
    form = AirfoilForm::Selig;
  }
  a.insert(a.end(), b.begin(), b.end());
  return std::move(a);
}

}  // namespace

AirfoilLoop parse_airfoil(std::string_view bytes, const std::string& name) {
  Rows rows = read_rows(bytes, name);
  AirfoilLoop loop;
  loop.info.title = rows.title;
  if (has_counts(rows)) {
    loop.info.form = AirfoilForm::Lednicer;
    loop.points = joined(rows, take_counted(rows), loop.info.form);
  } else if (rows.runs.size() == 2) {
    loop.info.form = AirfoilForm::Halves;
    loop.points = joined(rows, {rows.runs[0], rows.runs[1]}, loop.info.form);
  } else if (rows.runs.size() == 1) {
    loop.points = std::move(rows.runs[0].points);
  } else {
    throw rows.error(rows.runs[2].line,
                     fmt::format("begins the third of {} groups of points", rows.runs.size()),
                     "a body has one or two; give each body a file of its own");
  }
  loop.info.points = loop.points.size();
  return loop;
}

}  // namespace vdb_offset
