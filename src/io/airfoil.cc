#include "vdb_offset/io/airfoil.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "io/airfoil_parse.h"
#include "io/curve_points.h"
#include "io/input_file.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

constexpr const char* kKind = "an airfoil's coordinates";

/// Angle between two directions, radians.
double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// What the edge from a loop's last to its first point is.
enum class Gap { None, Base, MissingPoint };

Gap judge_gap(const Vec3List& loop, double size) {
  constexpr double kSamePoint = 1e-5;   // of the body's size: half a unit in five digits
  constexpr double kPartOfEdge = 0.1;   // finer than that no file is spaced at its end
  constexpr double kLongestBase = 0.2;  // of the body's size
  constexpr double kTurn = 30 * std::numbers::pi / 180;
  const Vec3 in = loop.back() - loop[loop.size() - 2];
  const Vec3 gap = loop.front() - loop.back();
  const Vec3 out = loop[1] - loop.front();
  const double edge = std::min(in.norm(), out.norm());
  if (gap.norm() <= std::min(kSamePoint * size, kPartOfEdge * edge)) return Gap::None;
  const bool across = angle(in, gap) > kTurn && angle(gap, out) > kTurn;
  return across && gap.norm() <= kLongestBase * size ? Gap::Base : Gap::MissingPoint;
}

/// The base from the loop's end to its beginning, in cells about as long as their neighbours, but
/// no more of them than the loop has.
Vec3List base_of(const Vec3List& loop) {
  const Vec3& a = loop.back();
  const Vec3& b = loop.front();
  const double edge = 0.5 * ((a - loop[loop.size() - 2]).norm() + (loop[1] - b).norm());
  const double cells =
      std::clamp(std::round((b - a).norm() / edge), 1.0, static_cast<double>(loop.size() - 1));
  Vec3List base;
  for (double k = 0; k < cells; ++k) base.push_back((a * (cells - k) + b * k) / cells);
  base.front() = a;
  base.push_back(b);
  return base;
}

double chord_of(const Vec3List& loop) {
  const Vec3 tail = 0.5 * (loop.front() + loop.back());
  double chord = 0.0;
  for (const Vec3& p : loop) chord = std::max(chord, (p - tail).norm());
  return chord;
}

Patch curve(std::string name, std::string family, Vec3List points) {
  return {std::move(name), std::move(family), static_cast<int>(points.size()), 1,
          std::move(points)};
}

/// Counter-clockwise and without repeats, or refused.
void tidy(const std::string& name, AirfoilLoop& loop) {
  Vec3List& points = loop.points;
  const double size = size_of(points);
  drop_repeats(points, size);
  loop.info.repeated = loop.info.points - points.size();
  const double area = enclosed_area(points);
  if (points.size() < 3 || !(std::abs(area) > 1e-9 * size * size)) {
    throw IoError(
        fmt::format("{}: its points ({}, {} of them different from the one before) "
                    "enclose no area; a body's outline needs three at least, round it",
                    name, loop.info.points, points.size()));
  }
  if (points.size() >= static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw IoError(fmt::format("{}: {} points are too many for a curve", name, points.size()));
  }
  loop.info.turned = area < 0;
  if (loop.info.turned) std::reverse(points.begin(), points.end());
}

/// First and last point become one.
void close(AirfoilLoop& loop, Gap gap) {
  loop.info.end_added = gap == Gap::MissingPoint;
  if (loop.info.end_added) {
    loop.points.push_back(loop.points.front());
  } else {
    loop.points.front() = 0.5 * (loop.points.front() + loop.points.back());
    loop.points.back() = loop.points.front();
  }
}

}  // namespace

std::string describe(AirfoilForm form) {
  switch (form) {
    case AirfoilForm::Selig:
      return "Selig, one loop from the trailing edge";
    case AirfoilForm::Lednicer:
      return "Lednicer, counts, then upper and lower surface";
    case AirfoilForm::Halves:
      break;
  }
  return "two surfaces from the nose, without counts";
}

Patches read_airfoil_bytes(std::string_view bytes, const std::string& name, AirfoilInfo& info) {
  AirfoilLoop loop = parse_airfoil(bytes, name);
  tidy(name, loop);
  loop.info.gap_world = (loop.points.front() - loop.points.back()).norm();
  const Gap gap = judge_gap(loop.points, size_of(loop.points));
  loop.info.blunt = gap == Gap::Base;
  if (!loop.info.blunt) close(loop, gap);
  loop.info.chord_world = chord_of(loop.points);
  Patches patches;
  const std::string stem = std::filesystem::path(name).stem().string();
  patches.push_back(curve("airfoil", stem, std::move(loop.points)));
  if (loop.info.blunt) {
    patches.push_back(curve("trailing edge", "trailing edge", base_of(patches[0].points_world)));
  }
  for (Patch& patch : patches) patch.file = name;
  info = std::move(loop.info);
  return patches;
}

AirfoilInfo inspect_airfoil(const std::filesystem::path& file) {
  AirfoilInfo info;
  read_airfoil_bytes(contents_of(file, kKind), file.string(), info);
  return info;
}

Patches read_airfoil(const std::filesystem::path& file) {
  AirfoilInfo info;
  return read_airfoil_bytes(contents_of(file, kKind), file.string(), info);
}

}  // namespace vdb_offset
