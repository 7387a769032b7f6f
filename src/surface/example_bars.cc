#include <array>
#include <cmath>
#include <numbers>

#include "surface/example_grid.h"

// Bars: a plane section of rectangles, extruded along z. Sharp, the rectangles are the end faces.
// With fillets the rectangles shrink to a core, and a rim joins the core to the rounded outline;
// rim patches meet at the middle of each arc, where both have right angles.

namespace vdb_offset::example {

namespace {

using Pair = std::array<int, 2>;

/// Where an outline edge starts (indices of grid lines), and its name.
struct OutlineEdge {
  Pair from;
  std::string name;
};

/// A section on a grid of lines x = const, y = const.
struct Section {
  std::array<std::vector<double>, 2> lines;       ///< of the sharp section
  std::array<std::vector<double>, 2> core_lines;  ///< of the core inside the rim
  std::array<std::vector<int>, 2> counts;         ///< cells between neighbouring lines
  std::vector<Pair> rectangles;                   ///< by the indices of their lower lines
  std::vector<OutlineEdge> outline;               ///< counter-clockwise
  double inset = 0;                               ///< width of the rim
};

using Lines = std::array<std::vector<double>, 2>;

Vec3 corner(const Lines& lines, const Pair& at) {
  return {lines[0][static_cast<std::size_t>(at[0])], lines[1][static_cast<std::size_t>(at[1])], 0};
}

/// Points along the grid lines from one crossing to another, which differ in one direction.
Curve path(const Section& section, const Lines& lines, Pair from, const Pair& to) {
  const std::size_t d = from[0] == to[0] ? 1 : 0;
  const int step = from[d] < to[d] ? 1 : -1;
  Curve curve;
  while (from[d] != to[d]) {
    Pair next = from;
    next[d] += step;
    const auto gap = static_cast<std::size_t>(std::min(from[d], next[d]));
    const int count = section.counts[d][gap];
    curve = join(std::move(curve), line(corner(lines, from), corner(lines, next), count));
    from = next;
  }
  return curve;
}

Patch rectangle(const Section& section, const Lines& lines, const Pair& low) {
  const Pair east{low[0] + 1, low[1]};
  const Pair north{low[0], low[1] + 1};
  const Pair far{low[0] + 1, low[1] + 1};
  return transfinite("", {path(section, lines, low, east), path(section, lines, east, far),
                          path(section, lines, north, far), path(section, lines, low, north)});
}

/// Half of the fillet at vertex `v`, from the arc's middle to where it touches the edge that leaves
/// along `out`; the other edge comes along `in`.
Curve half_arc(const Vec3& v, const Vec3& in, const Vec3& out, std::pair<double, int> arc) {
  const auto [radius, count] = arc;
  const Vec3 centre = v - radius * in + radius * out;
  const Vec3 middle = (v - centre).normalized();
  const Vec3 touch = (v + radius * out - centre) / radius;
  Curve curve;
  for (int k = 0; k <= count; ++k) {
    const double angle = 0.25 * std::numbers::pi * k / count;
    const double rest = 0.25 * std::numbers::pi - angle;
    curve.push_back(centre + radius * std::numbers::sqrt2 *
                                 (std::sin(rest) * middle + std::sin(angle) * touch));
  }
  return curve;
}

/// Corner number k of the outline, counted round and round.
Pair outline_corner(const Section& section, std::size_t k) {
  return section.outline[k % section.outline.size()].from;
}

/// The filleted outline edge k: half an arc, a straight part, half an arc; `count` cells.
Curve rounded_edge(const Section& section, std::size_t k, double radius, int count) {
  const std::size_t size = section.outline.size();
  std::array<Vec3, 4> v;
  for (std::size_t n = 0; n < 4; ++n) {
    v[n] = corner(section.lines, outline_corner(section, k + size - 1 + n));
  }
  const Vec3 before = (v[1] - v[0]).normalized();
  const Vec3 along = (v[2] - v[1]).normalized();
  const Vec3 after = (v[3] - v[2]).normalized();
  const double arc = 0.25 * std::numbers::pi * radius;
  const double straight = (v[2] - v[1]).norm() - 2 * radius;
  const int wanted = static_cast<int>(std::lround(count * arc / (2 * arc + straight)));
  const int arc_count = std::clamp(wanted, count >= 6 ? 2 : 1, (count - 1) / 2);

  const Curve start = half_arc(v[1], before, along, {radius, arc_count});
  const Curve end = half_arc(v[2], -after, -along, {radius, arc_count});
  const double first = arc / arc_count / straight;
  Curve middle;
  for (const double t : stretch(count - 2 * arc_count, first, first)) {
    middle.push_back((1 - t) * start.back() + t * end.back());
  }
  return join(join(start, middle), reversed(end));
}

Face sharp_face(const Section& section) {
  Face face;
  for (const Pair& low : section.rectangles) {
    face.parts.push_back(rectangle(section, section.lines, low));
    face.parts.back().name = std::to_string(face.parts.size());
  }
  for (std::size_t k = 0; k < section.outline.size(); ++k) {
    face.outline.push_back(
        {section.outline[k].name,
         path(section, section.lines, outline_corner(section, k), outline_corner(section, k + 1))});
  }
  return face;
}

Face rounded_face(const Section& section, double radius, int rim) {
  Face face;
  for (const Pair& low : section.rectangles) {
    face.parts.push_back(rectangle(section, section.core_lines, low));
    face.parts.back().name = "core " + std::to_string(face.parts.size());
  }
  for (std::size_t k = 0; k < section.outline.size(); ++k) {
    const Curve inner = path(section, section.core_lines, outline_corner(section, k),
                             outline_corner(section, k + 1));
    const int count = static_cast<int>(inner.size()) - 1;
    const Curve outer = rounded_edge(section, k, radius, count);
    const Sides sides{outer, line(outer.back(), inner.back(), rim), inner,
                      line(outer.front(), inner.front(), rim)};
    face.parts.push_back(transfinite("rim " + section.outline[k].name, sides));
    face.outline.push_back({section.outline[k].name, outer});
  }
  return face;
}

Patches make_bar(Section section, const ExampleOptions& options) {
  const bool rounded = options.fillet > 0;
  for (std::size_t d = 0; d < 2; ++d) {
    for (std::size_t k = 1; k < section.lines[d].size(); ++k) {
      const double width = section.lines[d][k] - section.lines[d][k - 1];
      section.counts[d].push_back(cells(options, width, rounded ? 3 : 1));
    }
  }
  const Face face = rounded ? rounded_face(section, options.fillet, cells(options, section.inset))
                            : sharp_face(section);
  return extrude(face, cells(options, 1));
}

}  // namespace

Patches l_bar(const ExampleOptions& options) {
  Section section;
  const double w = section.inset = 0.15;
  section.lines = {{{0, 0.5, 1}, {0, 0.5, 1}}};
  section.core_lines = {{{w, 0.5 - w, 1 - w}, {w, 0.5 - w, 1 - w}}};
  section.rectangles = {{0, 0}, {1, 0}, {0, 1}};
  section.outline = {{{0, 0}, "bottom"},     {{2, 0}, "right"}, {{2, 1}, "inner floor"},
                     {{1, 1}, "inner wall"}, {{1, 2}, "top"},   {{0, 2}, "left"}};
  Patches patches = make_bar(section, options);
  set_family(patches, "l-bar");
  return patches;
}

Patches u_slot(const ExampleOptions& options) {
  Section section;
  const double w = section.inset = 0.12;
  section.lines = {{{0, 0.4, 0.6, 1}, {0, 0.5, 1}}};
  section.core_lines = {{{w, 0.4 - w, 0.6 + w, 1 - w}, {w, 0.5 - w, 1 - w}}};
  section.rectangles = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {2, 1}};
  section.outline = {{{0, 0}, "bottom"},     {{3, 0}, "right"},      {{3, 2}, "top right"},
                     {{2, 2}, "slot right"}, {{2, 1}, "slot floor"}, {{1, 1}, "slot left"},
                     {{1, 2}, "top left"},   {{0, 2}, "left"}};
  Patches patches = make_bar(section, options);
  set_family(patches, "u-slot");
  return patches;
}

}  // namespace vdb_offset::example
