// Detection, once for both kinds of PLOT3D. A dialect is a guess until its sizes use up the file
// exactly; that check needs the header and the length only.

#include "io/plot3d_detect.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

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
  std::uint64_t blanks = 0;
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
    ++survey.blanks;
    survey.blanks_set |= blank != 0;
  }
}

/// Fills `survey` as far as it comes. Throws Plot3dMismatch at a number that cannot be one.
template <class Cursor>
void look_at(const Plot3dCandidate<Cursor>& candidate, Survey& survey) {
  constexpr double kTiny = 1e-30;
  constexpr double kHuge = 1e20;
  Cursor data = candidate.data;
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
  return IoError(
      fmt::format("{}: no PLOT3D dialect fits; the nearest is {}, but {}{}; {}", name,
                  nearest.dialect.describe(), nearest.why.what, start.remark(), kPlot3dAdvice),
      {static_cast<std::int64_t>(nearest.why.byte)});
}

/// The best of the candidates by the look of their numbers; the first of equals.
template <class Cursor>
const Plot3dCandidate<Cursor>* best_of(const std::vector<Plot3dCandidate<Cursor>>& found,
                                       Nearest& nearest) {
  if (found.size() == 1 && !found[0].dialect.iblank) return found.data();
  const Plot3dCandidate<Cursor>* best = nullptr;
  int best_rank = std::numeric_limits<int>::max();
  for (const Plot3dCandidate<Cursor>& candidate : found) {
    Survey survey;
    try {
      look_at(candidate, survey);
      const int rank = rank_of(survey, candidate.dialect.iblank);
      if (rank >= best_rank) continue;
      best = &candidate;
      best_rank = rank;
    } catch (const Plot3dMismatch& mismatch) {
      // The length fits, which no other mismatch can say; by accident if no iblank looks like one.
      constexpr int kLengthFits = 10;
      const bool accident = survey.coordinates > 0 && survey.blanks == 0;
      nearest.offer(candidate.dialect, mismatch, accident ? 0 : kLengthFits);
    }
  }
  return best;
}

/// "1 ni nj 1 ..." is one block in a multi-block file. Less one number it has the length of a
/// single block 1 x ni x nj that swallows the last size as a coordinate: refused, unless told.
template <class Cursor>
void check_not_cut(Cursor in, const Plot3dDialect& dialect, const Plot3dBlockSize& size) {
  const bool alike = !dialect.multi_block && !dialect.two_dimensional && size.ni == 1;
  if (!alike || (!dialect.formatted && dialect.records)) return;
  std::int64_t first = 0;
  try {
    first = in.whole();
  } catch (const Plot3dMismatch&) {
    return;  // a coordinate with a point or exponent
  }
  if (first != 1) return;
  throw Plot3dMismatch{
      fmt::format("{} may be the last size of a multi-block file that was cut", in.position()),
      in.byte(), Plot3dMismatch::kBadData};
}

/// All dialects whose sizes use up the file.
template <class Cursor>
std::vector<Plot3dCandidate<Cursor>> fitting(const Cursor& start, const Plot3dHint& hint,
                                             Nearest& nearest) {
  std::vector<Plot3dCandidate<Cursor>> found;
  // Record marks that fit as far as the file goes are no accident: a file like that which was cut
  // must not be read as the C stream that its length happens to fit.
  bool framed = false;
  for (const Plot3dDialect& dialect : dialects(hint, Cursor::kFormatted)) {
    if (framed && !dialect.records) continue;
    Cursor in = start;
    try {
      std::vector<Plot3dBlockSize> blocks = read_header(in, dialect);
      in.check_length(blocks);
      if (!hint.multi_block) check_not_cut(in, dialect, blocks[0]);
      framed |= dialect.records && !dialect.formatted;
      found.push_back({dialect, std::move(blocks), in});
    } catch (const Plot3dMismatch& mismatch) {
      framed |= dialect.records && !dialect.formatted && mismatch.distance < 1.0;
      nearest.offer(dialect, mismatch, in.records_found());
    }
  }
  return found;
}

}  // namespace

template <class Cursor>
Plot3dCandidate<Cursor> detect_plot3d(const std::string& name, const Cursor& start,
                                      const Plot3dHint& hint) {
  Nearest nearest;
  const std::vector<Plot3dCandidate<Cursor>> found = fitting(start, hint, nearest);
  const Plot3dCandidate<Cursor>* best = best_of(found, nearest);
  if (best == nullptr) throw refusal(name, start, nearest);
  return *best;
}

template Plot3dCandidate<Plot3dTextCursor> detect_plot3d(const std::string&,
                                                         const Plot3dTextCursor&,
                                                         const Plot3dHint&);
template Plot3dCandidate<Plot3dBinaryCursor> detect_plot3d(const std::string&,
                                                           const Plot3dBinaryCursor&,
                                                           const Plot3dHint&);

}  // namespace vdb_offset
