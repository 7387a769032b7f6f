// Detection and reading, once for both kinds of PLOT3D. A dialect is a guess until its sizes use
// up the file exactly; that check needs the header and the length only.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "io/plot3d_cursor.h"
#include "io/plot3d_parse.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

constexpr std::string_view kAdvice =
    "check that the file is whole, or force the dialect with --input-format";

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

/// A dialect that fits, its sizes, and a cursor at the first block's data.
template <class Cursor>
struct Candidate {
  Plot3dDialect dialect;
  std::vector<Plot3dBlockSize> blocks;
  Cursor data;
};

std::vector<bool> choices(const std::optional<bool>& told, bool first, bool both = true) {
  if (told) return {*told};
  return both ? std::vector<bool>{first, !first} : std::vector<bool>{first};
}

/// Every dialect that the hint leaves open, in the order of preference that plot3d.h states.
std::vector<Plot3dDialect> dialects(const Plot3dHint& hint, bool formatted) {
  Plot3dDialect first;
  first.formatted = formatted;
  std::vector<Plot3dDialect> all = {first};
  const auto split = [&all](bool Plot3dDialect::*member, const std::vector<bool>& values) {
    std::vector<Plot3dDialect> more;
    for (const Plot3dDialect& dialect : all) {
      for (const bool value : values) {
        more.push_back(dialect);
        more.back().*member = value;
      }
    }
    all = std::move(more);
  };
  if (!formatted) split(&Plot3dDialect::records, choices(hint.records, true));
  split(&Plot3dDialect::multi_block, choices(hint.multi_block, true));
  split(&Plot3dDialect::two_dimensional, choices(hint.two_dimensional, false));
  split(&Plot3dDialect::iblank, choices(hint.iblank, false));
  if (!formatted) split(&Plot3dDialect::double_precision, choices(hint.double_precision, true));
  if (!formatted) split(&Plot3dDialect::big_endian, choices(hint.big_endian, false));
  return all;
}

template <class Cursor>
std::int64_t read_block_count(Cursor& in) {
  in.open_record(4);
  const std::int64_t count = in.whole();
  if (count < 1 || static_cast<std::uint64_t>(count) > in.size()) {
    throw Plot3dMismatch{
        fmt::format("the number of blocks, {}, is {}; a file of {} bytes may have 1 to that many",
                    in.position(), count, in.size()),
        in.byte(), Plot3dMismatch::kBadCount};
  }
  in.close_record(4);
  return count;
}

/// More points than memory can hold, and few enough for sums of bytes in 64 bits.
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 48;

/// One block's sizes; `points` are those of the blocks before, and grow. Nothing overflows: the
/// product is compared by division before it is formed.
template <class Cursor>
Plot3dBlockSize read_size(Cursor& in, int dimensions, std::uint64_t& points) {
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::uint64_t product = 1;
  for (int d = 0; d < dimensions; ++d) {
    const std::int64_t value = in.whole();
    if (value < 1) {
      throw Plot3dMismatch{
          fmt::format("a block's size, {}, is {}, and must be at least 1", in.position(), value),
          in.byte(), Plot3dMismatch::kBadSize};
    }
    if (static_cast<std::uint64_t>(value) > (kMostPoints - points) / product) {
      throw Plot3dMismatch{
          fmt::format("a block's size, {}, is {}, which makes the grid too large for any file",
                      in.position(), value),
          in.byte(), Plot3dMismatch::kTooBig};
    }
    product *= static_cast<std::uint64_t>(value);
    size[static_cast<std::size_t>(d)] = value;
  }
  points += product;
  return {size[0], size[1], size[2]};
}

template <class Cursor>
std::vector<Plot3dBlockSize> read_header(Cursor& in, const Plot3dDialect& dialect) {
  in.set_dialect(dialect);
  const std::int64_t count = dialect.multi_block ? read_block_count(in) : 1;
  const int dimensions = plot3d_dimensions(dialect);
  const std::uint64_t bytes =
      4 * static_cast<std::uint64_t>(count) * static_cast<std::uint64_t>(dimensions);
  in.open_record(bytes);
  // Grown as sizes are found, not by what `count` claims.
  std::vector<Plot3dBlockSize> blocks;
  std::uint64_t points = 0;
  for (std::int64_t b = 0; b < count; ++b) blocks.push_back(read_size(in, dimensions, points));
  in.close_record(bytes);
  return blocks;
}

/// What the numbers of a candidate look like.
struct Survey {
  std::uint64_t coordinates = 0;
  std::uint64_t absurd = 0;  ///< not finite, or of a size that no geometry has
  bool all_whole = true;     ///< coordinates written as whole numbers (text only)
  bool blanks_set = false;   ///< some iblank is not 0
};

template <class Cursor>
void survey_blanks(Cursor& data, std::uint64_t points, Survey& survey) {
  // 1, 0, 2 for walls, minus the number of the neighbour: not the bits of a coordinate.
  constexpr std::int64_t kLargest = 1'000'000;
  for (std::uint64_t p = 0; p < points; ++p) {
    const std::int64_t blank = data.whole();
    if (std::abs(blank) > kLargest) {
      throw Plot3dMismatch{
          fmt::format("iblank at {} is {}, which no iblank is", data.position(), blank),
          data.byte(), Plot3dMismatch::kBadData};
    }
    survey.blanks_set |= blank != 0;
  }
}

/// Throws Plot3dMismatch at a number that cannot be one.
template <class Cursor>
Survey survey_of(const Candidate<Cursor>& candidate) {
  constexpr double kTiny = 1e-30;
  constexpr double kHuge = 1e20;
  Cursor data = candidate.data;
  Survey survey;
  const auto dimensions = static_cast<std::uint64_t>(plot3d_dimensions(candidate.dialect));
  for (const Plot3dBlockSize& size : candidate.blocks) {
    const std::uint64_t points = plot3d_points(size);
    const std::uint64_t record = plot3d_record_bytes(candidate.dialect, size);
    data.open_record(record);
    for (std::uint64_t n = 0; n < points * dimensions; ++n) {
      const double value = std::abs(data.coordinate());
      survey.absurd += value == 0.0 || (value >= kTiny && value <= kHuge) ? 0 : 1;
      survey.all_whole &= data.whole_literal();
    }
    survey.coordinates += points * dimensions;
    if (candidate.dialect.iblank) survey_blanks(data, points, survey);
    data.close_record(record);
  }
  return survey;
}

/// 0 is best: iblanks that look like it are better evidence than coordinates that do.
int rank_of(const Survey& survey, bool iblank) {
  if (survey.absurd * 100 > survey.coordinates) return 2;
  if (!iblank) return 1;
  return survey.blanks_set && !survey.all_whole ? 0 : 2;
}

/// The mismatch that came nearest, and its dialect.
struct Nearest {
  Plot3dDialect dialect;
  Plot3dMismatch why{"", 0, std::numeric_limits<double>::infinity()};

  void offer(const Plot3dDialect& other, Plot3dMismatch mismatch, int evidence) {
    constexpr double kEvidence = 10.0;  // above all distances
    mismatch.distance -= kEvidence * evidence;
    if (!(mismatch.distance < why.distance)) return;
    dialect = other;
    why = std::move(mismatch);
  }
};

template <class Cursor>
IoError refusal(const std::string& name, const Cursor& start, const Nearest& nearest) {
  return IoError(fmt::format("{}: no PLOT3D dialect fits; the nearest is {}, but {}{}; {}", name,
                             nearest.dialect.describe(), nearest.why.what, start.remark(), kAdvice),
                 {static_cast<std::int64_t>(nearest.why.byte)});
}

/// The best of the candidates by the look of their numbers; the first of equals.
template <class Cursor>
const Candidate<Cursor>* best_of(const std::vector<Candidate<Cursor>>& found, Nearest& nearest) {
  if (found.size() == 1 && !found[0].dialect.iblank) return found.data();
  const Candidate<Cursor>* best = nullptr;
  int best_rank = std::numeric_limits<int>::max();
  for (const Candidate<Cursor>& candidate : found) {
    try {
      const int rank = rank_of(survey_of(candidate), candidate.dialect.iblank);
      if (rank >= best_rank) continue;
      best = &candidate;
      best_rank = rank;
    } catch (const Plot3dMismatch& mismatch) {
      constexpr int kLengthFits = 10;  // which no other mismatch can say
      nearest.offer(candidate.dialect, mismatch, kLengthFits);
    }
  }
  return best;
}

/// All dialects whose sizes use up the file.
template <class Cursor>
std::vector<Candidate<Cursor>> fitting(const Cursor& start, const Plot3dHint& hint,
                                       Nearest& nearest) {
  std::vector<Candidate<Cursor>> found;
  // Record marks that fit as far as the file goes are no accident: a file like that which was cut
  // must not be read as the C stream that its length happens to fit.
  bool framed = false;
  for (const Plot3dDialect& dialect : dialects(hint, Cursor::kFormatted)) {
    if (framed && !dialect.records) continue;
    Cursor in = start;
    try {
      std::vector<Plot3dBlockSize> blocks = read_header(in, dialect);
      in.check_length(blocks);
      framed |= dialect.records && !dialect.formatted;
      found.push_back({dialect, std::move(blocks), in});
    } catch (const Plot3dMismatch& mismatch) {
      framed |= dialect.records && !dialect.formatted && mismatch.distance < 1.0;
      nearest.offer(dialect, mismatch, in.records_found());
    }
  }
  return found;
}

template <class Cursor>
Candidate<Cursor> detect(const std::string& name, const Cursor& start, const Plot3dHint& hint) {
  Nearest nearest;
  const std::vector<Candidate<Cursor>> found = fitting(start, hint, nearest);
  const Candidate<Cursor>* best = best_of(found, nearest);
  if (best == nullptr) throw refusal(name, start, nearest);
  return *best;
}

/// A patch without points, of the two sizes that are not 1; i fastest stays i fastest.
Patch shape_of(const Subject& subject, const Plot3dBlockSize& size, std::size_t block) {
  std::vector<std::int64_t> sides;
  for (const std::int64_t n : {size.ni, size.nj, size.nk}) {
    if (n > 1) sides.push_back(n);
  }
  const bool fits = std::all_of(sides.begin(), sides.end(), [](std::int64_t n) {
    return n <= std::numeric_limits<int>::max();
  });
  if (sides.size() != 2 || !fits) {
    const std::string_view kind = sides.size() == 3   ? "a volume"
                                  : sides.size() == 2 ? "too large"
                                                      : "a curve or a point";
    throw subject.error(
        fmt::format("block {} is {}: {} x {} x {} points", block + 1, kind, size.ni, size.nj,
                    size.nk),
        "a surface has exactly one size of 1; write the wall's surface to a file of its own",
        {static_cast<std::int64_t>(block)});
  }
  Patch patch;
  patch.name = fmt::format("patch {}", block + 1);
  patch.ni = static_cast<int>(sides[0]);
  patch.nj = static_cast<int>(sides[1]);
  return patch;
}

/// Names the point and the number just read, and says what is wrong with it.
template <class Cursor>
IoError point_error(const Subject& subject, const Patch& patch, std::size_t patch_index,
                    std::size_t p, const Cursor& data, const std::string& what) {
  const std::size_t i = p % static_cast<std::size_t>(patch.ni);
  const std::size_t j = p / static_cast<std::size_t>(patch.ni);
  return subject.error(fmt::format("{}, point i = {}, j = {} (from 1), {}: {}", patch.name, i + 1,
                                   j + 1, data.position(), what),
                       kAdvice,
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
Patches read_patches(const std::string& name, const Candidate<Cursor>& candidate) {
  const Subject subject{name, candidate.dialect};
  Patches patches;
  for (const Plot3dBlockSize& size : candidate.blocks) {
    patches.push_back(shape_of(subject, size, patches.size()));
  }
  Cursor data = candidate.data;
  try {
    for (std::size_t b = 0; b < patches.size(); ++b) {
      const std::uint64_t record = plot3d_record_bytes(candidate.dialect, candidate.blocks[b]);
      data.open_record(record);
      read_points(subject, b, data, patches[b]);
      data.close_record(record);
    }
  } catch (const Plot3dMismatch& mismatch) {
    throw subject.error(mismatch.what, kAdvice, {static_cast<std::int64_t>(mismatch.byte)});
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
    return use(detect(name, Plot3dTextCursor(bytes), hint));
  }
  return use(detect(name, Plot3dBinaryCursor(bytes), hint));
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
