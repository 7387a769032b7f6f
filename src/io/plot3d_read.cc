// Reading, once for both kinds of PLOT3D, after detection (plot3d_detect.h).

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

/// Names the point and the number just read, and says what is wrong with it.
template <class Cursor>
IoError point_error(const Subject& subject, const Patch& patch, std::size_t patch_index,
                    std::size_t p, const Cursor& data, const std::string& what) {
  const std::size_t i = p % static_cast<std::size_t>(patch.ni);
  const std::size_t j = p / static_cast<std::size_t>(patch.ni);
  return subject.error(fmt::format("{}, point i = {}, j = {} (from 1), {}: {}", patch.name, i + 1,
                                   j + 1, data.position(), what),
                       kPlot3dAdvice,
                       {static_cast<std::int64_t>(patch_index), static_cast<std::int64_t>(i),
                        static_cast<std::int64_t>(j)});
}

template <class Cursor>
void read_points(const Subject& subject, std::size_t index, Cursor& data, Patch& patch) {
  const auto count = static_cast<std::size_t>(patch.ni) * static_cast<std::size_t>(patch.nj);
  patch.points_world.assign(count, Vec3::Zero());
  for (int c = 0; c < plot3d_dimensions(subject.dialect); ++c) {
    for (std::size_t p = 0; p < count; ++p) {
      const double value = data.coordinate();
      if (!std::isfinite(value)) {
        throw point_error(subject, patch, index, p, data,
                          fmt::format("{} = {} is not finite", "xyz"[c], value));
      }
      patch.points_world[p][c] = value;
    }
  }
  if (!subject.dialect.iblank) return;
  for (std::size_t p = 0; p < count; ++p) {
    if (data.whole() != 0) continue;
    throw point_error(subject, patch, index, p, data,
                      "iblank = 0 makes a hole, and holes are not supported");
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
  Cursor data = candidate.data;
  try {
    for (std::size_t b = 0; b < patches.size(); ++b) {
      const std::uint64_t record = plot3d_record_bytes(candidate.dialect, candidate.blocks[b]);
      data.open_record(record);
      read_points(subject, b, data, patches[b]);
      data.close_record(record);
    }
  } catch (const Plot3dMismatch& mismatch) {
    throw subject.error(mismatch.what, kPlot3dAdvice, {static_cast<std::int64_t>(mismatch.byte)});
  }
  return patches;
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

}  // namespace vdb_offset
