// Reading, once for both kinds of PLOT3D, after detection (plot3d_detect.h).

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

#include "io/plot3d_detect.h"
#include "io/plot3d_parse.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

/// What is being read, for messages.
struct Subject {
  const std::string& name;
  const Plot3dDialect& dialect;

  IoError error(std::string_view what, std::string_view advice,
                std::vector<std::int64_t> indices) const {
    return IoError(fmt::format("{} ({}): {}; {}", name, dialect.describe(), what, advice),
                   std::move(indices));
  }
};

/// Sizes that are not 1: three of a volume, two of a surface, one of a curve.
std::vector<std::int64_t> sides_of(const Plot3dBlockSize& size) {
  std::vector<std::int64_t> sides;
  for (const std::int64_t n : {size.ni, size.nj, size.nk}) {
    if (n > 1) sides.push_back(n);
  }
  return sides;
}

constexpr std::array<std::string_view, 4> kKinds = {"a point", "a curve", "a surface", "a volume"};

/// A patch without points, of the sizes that are not 1; i fastest stays i fastest.
Patch shape_of(const Subject& subject, const Plot3dBlockSize& size, std::size_t block) {
  const std::vector<std::int64_t> sides = sides_of(size);
  const bool fits = std::all_of(sides.begin(), sides.end(), [](std::int64_t n) {
    return n <= std::numeric_limits<int>::max();
  });
  const bool known = sides.size() == 1 || sides.size() == 2;
  if (!known || !fits) {
    throw subject.error(
        fmt::format("block {} is {}: {} x {} x {} points", block + 1,
                    known ? "too large" : kKinds[sides.size()], size.ni, size.nj, size.nk),
        "a surface has exactly one size of 1, a curve two; write the wall to a file of its own",
        {static_cast<std::int64_t>(block)});
  }
  Patch patch;
  patch.name = fmt::format("patch {}", block + 1);
  patch.ni = static_cast<int>(sides[0]);
  patch.nj = sides.size() == 2 ? static_cast<int>(sides[1]) : 1;
  return patch;
}

/// Curves bound a plane, surfaces a space: never both.
void check_one_kind(const Subject& subject, const Patches& patches) {
  const auto is_curve = [](const Patch& patch) { return patch.nj == 1; };
  const bool first = is_curve(patches.front());
  const auto other = std::find_if(patches.begin(), patches.end(),
                                  [&](const Patch& patch) { return is_curve(patch) != first; });
  if (other == patches.end()) return;
  const auto block = other - patches.begin();
  throw subject.error(fmt::format("block 1 is {} of {} x {} points, and block {} {} of {} x {}",
                                  kKinds[first ? 1 : 2], patches[0].ni, patches[0].nj, block + 1,
                                  kKinds[first ? 2 : 1], other->ni, other->nj),
                      "write curves and surfaces to files of their own", {block});
}

/// A block whose points are to be read: `ni x nj x nk`, nk = 1 for surfaces and curves.
struct Target {
  std::string name;
  std::size_t index;
  int ni, nj, nk;
  Vec3List& points;
};

/// Names the point and the number just read, and says what is wrong with it.
template <class Cursor>
IoError point_error(const Subject& subject, const Target& target, std::size_t p, const Cursor& data,
                    const std::string& what) {
  const std::size_t row = p / static_cast<std::size_t>(target.ni);
  const std::size_t i = p % static_cast<std::size_t>(target.ni);
  const std::size_t j = row % static_cast<std::size_t>(target.nj);
  const std::size_t k = row / static_cast<std::size_t>(target.nj);
  const bool is_volume = target.nk > 1;
  std::vector<std::int64_t> indices{static_cast<std::int64_t>(target.index),
                                    static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)};
  if (is_volume) indices.push_back(static_cast<std::int64_t>(k));
  return subject.error(
      fmt::format("{}, point i = {}, j = {}{} (from 1), {}: {}", target.name, i + 1, j + 1,
                  is_volume ? fmt::format(", k = {}", k + 1) : "", data.position(), what),
      kPlot3dAdvice, std::move(indices));
}

template <class Cursor>
void read_points(const Subject& subject, Cursor& data, const Target& target) {
  const auto count = static_cast<std::size_t>(target.ni) * static_cast<std::size_t>(target.nj) *
                     static_cast<std::size_t>(target.nk);
  target.points.assign(count, Vec3::Zero());
  for (int c = 0; c < plot3d_dimensions(subject.dialect); ++c) {
    for (std::size_t p = 0; p < count; ++p) {
      const double value = data.coordinate();
      if (!std::isfinite(value)) {
        throw point_error(subject, target, p, data,
                          fmt::format("{} = {} is not finite", "xyz"[c], value));
      }
      target.points[p][c] = value;
    }
  }
  if (!subject.dialect.iblank) return;
  for (std::size_t p = 0; p < count; ++p) {
    if (data.whole() != 0) continue;
    throw point_error(subject, target, p, data,
                      "iblank = 0 makes a hole, and holes are not supported");
  }
}

/// Reads the records of all blocks, each into its target.
template <class Cursor>
void read_blocks(const Subject& subject, const Plot3dCandidate<Cursor>& candidate,
                 std::vector<Target>& targets) {
  Cursor data = candidate.data;
  try {
    for (const Target& target : targets) {
      const std::uint64_t record =
          plot3d_record_bytes(candidate.dialect, candidate.blocks[target.index]);
      data.open_record(record);
      read_points(subject, data, target);
      data.close_record(record);
    }
  } catch (const Plot3dMismatch& mismatch) {
    throw subject.error(mismatch.what, kPlot3dAdvice, {static_cast<std::int64_t>(mismatch.byte)});
  }
}

template <class Cursor>
Patches read_patches(const std::string& name, const Plot3dCandidate<Cursor>& candidate) {
  const Subject subject{name, candidate.dialect};
  Patches patches;
  for (const Plot3dBlockSize& size : candidate.blocks) {
    patches.push_back(shape_of(subject, size, patches.size()));
    patches.back().file = name;
  }
  check_one_kind(subject, patches);
  std::vector<Target> targets;
  for (Patch& patch : patches) {
    targets.push_back({patch.name, targets.size(), patch.ni, patch.nj, 1, patch.points_world});
  }
  read_blocks(subject, candidate, targets);
  return patches;
}

/// A zone without points; of two dimensions as `ni x 1 x nj`, to be made thick.
Zone zone_shape_of(const Subject& subject, const Plot3dBlockSize& size, std::size_t block) {
  const std::size_t dimensions = subject.dialect.two_dimensional ? 2 : 3;
  const std::vector<std::int64_t> sides = sides_of(size);
  const bool fits = std::all_of(sides.begin(), sides.end(), [](std::int64_t n) {
    return n <= std::numeric_limits<int>::max();
  });
  if (sides.size() != dimensions || !fits) {
    throw subject.error(
        fmt::format("block {} is {}: {} x {} x {} points", block + 1,
                    fits ? kKinds[sides.size()] : "too large", size.ni, size.nj, size.nk),
        "a mesh has cells in every block; a surface is what 'info' and 'mesh' read",
        {static_cast<std::int64_t>(block)});
  }
  Zone zone{fmt::format("block {}", block + 1), "", static_cast<int>(size.ni), 1,
            static_cast<int>(size.nj)};
  if (dimensions == 3) {
    zone.nj = static_cast<int>(size.nj);
    zone.nk = static_cast<int>(size.nk);
  }
  return zone;
}

/// Twice the area of a plane mesh, above zero if its i, k and z are right-handed.
double area_of(const Zone& zone) {
  double area = 0;
  for (int k = 0; k + 1 < zone.nk; ++k) {
    for (int i = 0; i + 1 < zone.ni; ++i) {
      const Vec3 a = zone.at(i + 1, 0, k + 1) - zone.at(i, 0, k);
      const Vec3 b = zone.at(i, 0, k + 1) - zone.at(i + 1, 0, k);
      area += a.x() * b.y() - a.y() * b.x();
    }
  }
  return area;
}

/// A plane mesh one cell thick along j: as thick as its middle cell is wide, to that side on which
/// it is right-handed; from which side a plane is seen is nobody's fault.
void make_thick(Zone& zone) {
  const std::size_t middle = zone.index(zone.ni / 2, 0, zone.nk / 2);
  const double width = (zone.points_world[middle] - zone.points_world[middle - 1]).norm();
  const Vec3 across{0, 0, (area_of(zone) > 0 ? -1.0 : 1.0) * (width > 0 ? width : 1.0)};
  Vec3List points;
  points.reserve(2 * zone.points_world.size());
  for (int k = 0; k < zone.nk; ++k) {
    const auto begin = zone.points_world.begin() + static_cast<std::ptrdiff_t>(k) * zone.ni;
    points.insert(points.end(), begin, begin + zone.ni);
    std::transform(begin, begin + zone.ni, std::back_inserter(points),
                   [&](const Vec3& p) -> Vec3 { return p + across; });
  }
  zone.nj = 2;
  zone.points_world = std::move(points);
}

template <class Cursor>
ZoneMesh read_zones(const std::string& name, const Plot3dCandidate<Cursor>& candidate) {
  const Subject subject{name, candidate.dialect};
  ZoneMesh mesh;
  for (const Plot3dBlockSize& size : candidate.blocks) {
    mesh.zones.push_back(zone_shape_of(subject, size, mesh.zones.size()));
  }
  std::vector<Target> targets;
  for (Zone& zone : mesh.zones) {
    targets.push_back({zone.name, targets.size(), zone.ni, zone.nj, zone.nk, zone.points_world});
  }
  read_blocks(subject, candidate, targets);
  if (subject.dialect.two_dimensional) std::ranges::for_each(mesh.zones, make_thick);
  return mesh;
}

/// Text or not: the sizes at the front of a binary file are small numbers in four bytes each, so
/// it has zero bytes there, and text none. A tenth may be damaged.
bool looks_formatted(std::string_view bytes) {
  constexpr std::size_t kLooked = 4096;
  const std::string_view front = bytes.substr(0, kLooked);
  const auto text = std::count_if(front.begin(), front.end(), [](char c) {
    return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r');
  });
  return static_cast<std::size_t>(text) * 10 >= front.size() * 9;
}

/// Detects the dialect and hands the candidate on; `use` is called with one of the two kinds.
template <class Use>
auto with_candidate(std::string_view bytes, const std::string& name, const Plot3dHint& hint,
                    const Use& use) {
  if (bytes.empty()) throw IoError(name + ": is empty; a PLOT3D grid starts with its sizes");
  if (hint.formatted.value_or(looks_formatted(bytes))) {
    return use(detect_plot3d(name, Plot3dTextCursor(bytes), hint));
  }
  return use(detect_plot3d(name, Plot3dBinaryCursor(bytes), hint));
}

}  // namespace

Plot3dInfo inspect_plot3d_bytes(std::string_view bytes, const std::string& name,
                                const Plot3dHint& hint) {
  return with_candidate(bytes, name, hint, [](const auto& candidate) {
    return Plot3dInfo{candidate.dialect, candidate.blocks};
  });
}

Patches read_plot3d_bytes(std::string_view bytes, const std::string& name, const Plot3dHint& hint) {
  return with_candidate(bytes, name, hint,
                        [&name](const auto& candidate) { return read_patches(name, candidate); });
}

ZoneMesh read_plot3d_mesh_bytes(std::string_view bytes, const std::string& name,
                                const Plot3dHint& hint) {
  return with_candidate(bytes, name, hint,
                        [&name](const auto& candidate) { return read_zones(name, candidate); });
}

}  // namespace vdb_offset
