// Patches are cut along whole grid lines, where the surface has a crease or a neighbour has a
// corner; then all rows of points that sides tie together get one set of parameters, the mean of
// what their lengths ask for. A spline by such a set depends on its own points alone.

#include "io/cad/spline_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace vdb_offset::cad {
namespace {

constexpr double kCrease = std::numbers::pi / 6;  // a turn of less is a curved wall
constexpr double kCreased = 0.25;                 // of a grid line's edges, to be a crease
constexpr double kLeastStep = 1e-6;               // between two parameters

std::size_t at(int n) { return static_cast<std::size_t>(n); }

using Place = std::array<std::uint64_t, 3>;

Place place_of(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
          std::bit_cast<std::uint64_t>(p.z() + 0.0)};
}

/// A patch with its directions in either order, and its lines across the first that are cut.
struct Lines {
  const Patch& patch;
  bool turned;
  std::vector<char> cut;

  Lines(const Patch& of, bool is_turned) : patch(of), turned(is_turned), cut(at(count()), 0) {
    cut.front() = cut.back() = 1;
  }
  int count() const { return turned ? patch.nj : patch.ni; }
  int length() const { return turned ? patch.ni : patch.nj; }
  const Vec3& point(int line, int along) const {
    return turned ? patch.at(along, line) : patch.at(line, along);
  }
  Vec3 normal(int line, int along) const {
    return (point(line + 1, along + 1) - point(line, along))
        .cross(point(line + 1, along) - point(line, along + 1));
  }
  /// Of the surface over one edge of a line; 0 at the rim.
  double turn(int line, int along) const {
    if (line <= 0 || line >= count() - 1) return 0;
    const Vec3 a = normal(line - 1, along);
    const Vec3 b = normal(line, along);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }
  /// Sharp, and not a step of a curved wall of large cells.
  bool is_crease(int line, int along) const {
    const double here = turn(line, along);
    return here > kCrease && std::min(turn(line - 1, along), turn(line + 1, along)) < here / 2;
  }
  void cut_creases() {
    for (int line = 1; line + 1 < count(); ++line) {
      int creased = 0;
      for (int s = 0; s + 1 < length(); ++s) creased += is_crease(line, s) ? 1 : 0;
      if (creased > kCreased * (length() - 1)) cut[at(line)] = 1;
    }
  }
  /// Whether the first or last point of a line is one of a pole.
  bool is_on_pole(int line, int along) const {
    const Vec3& here = point(line, along);
    return (line > 0 && point(line - 1, along) == here) ||
           (line + 1 < count() && point(line + 1, along) == here);
  }
  std::ptrdiff_t pieces() const { return std::ranges::count(cut, 1) - 1; }
};

/// Both directions of all patches.
using Cuts = std::vector<std::array<Lines, 2>>;

std::ptrdiff_t pieces_of(const Cuts& cuts) {
  std::ptrdiff_t sum = 0;
  for (const auto& [i, j] : cuts) sum += i.pieces() * j.pieces();
  return sum;
}

/// Leads lines on where a neighbour has a corner, over all patches; false if they become too many.
bool match_corners(Cuts& cuts) {
  const std::ptrdiff_t most = 4 * pieces_of(cuts) + 64;
  std::set<Place> corners;
  const auto for_ends = [&](const auto& visit) {
    for (auto& both : cuts) {
      for (Lines& lines : both) {
        for (int line = 0; line < lines.count(); ++line) {
          for (const int end : {0, lines.length() - 1}) {
            if (!lines.is_on_pole(line, end)) visit(lines.cut[at(line)], lines.point(line, end));
          }
        }
      }
    }
  };
  for (std::size_t known = 1; known != corners.size();) {
    known = corners.size();
    for_ends([&](char& cut, const Vec3& p) {
      if (cut != 0) corners.insert(place_of(p));
    });
    for_ends([&](char& cut, const Vec3& p) {
      if (cut == 0 && corners.contains(place_of(p))) cut = 1;
    });
    if (pieces_of(cuts) > most) return false;
  }
  return true;
}

Cuts cut(const Patches& patches) {
  Cuts cuts;
  for (const Patch& patch : patches) {
    cuts.push_back({Lines(patch, false), Lines(patch, true)});
    for (Lines& lines : cuts.back()) lines.cut_creases();
  }
  return cuts;
}

Patch part_of(const Patch& patch, std::array<int, 2> i, std::array<int, 2> j) {
  Patch part{.name = patch.name, .family = patch.family, .points_world = {}};
  part.ni = i[1] - i[0] + 1;
  part.nj = j[1] - j[0] + 1;
  for (int b = j[0]; b <= j[1]; ++b) {
    for (int a = i[0]; a <= i[1]; ++a) part.points_world.push_back(patch.at(a, b));
  }
  return part;
}

/// The pairs of neighbouring lines that are cut.
std::vector<std::array<int, 2>> spans(const Lines& lines) {
  std::vector<std::array<int, 2>> out;
  for (int line = 1, from = 0; line < lines.count(); ++line) {
    if (lines.cut[at(line)] == 0) continue;
    out.push_back({from, line});
    from = line;
  }
  return out;
}

/// Directions of pieces, and the sides that tie them.
class Parameters {
 public:
  explicit Parameters(std::vector<SplinePiece>& pieces) : pieces_(pieces) {}

  void set() {
    tie_sides();
    std::vector<char> seen(2 * pieces_.size(), 0);
    for (std::size_t d = 0; d < seen.size(); ++d) {
      if (seen[d] == 0) set_from(d, seen);
    }
  }

 private:
  struct Tie {
    std::size_t other;
    bool is_turned;
  };
  struct Member {
    std::size_t direction;  // twice the piece, and 1 for j
    bool is_turned;
  };

  /// Rows along a direction; of them the first and last are sides.
  Lines rows(std::size_t d) const { return {pieces_[d / 2].patch, d % 2 == 0}; }

  void tie_sides() {
    std::map<std::vector<Place>, Member> sides;
    ties_.resize(2 * pieces_.size());
    for (std::size_t d = 0; d < ties_.size(); ++d) {
      const Lines lines = rows(d);
      for (const int row : {0, lines.count() - 1}) {
        std::vector<Place> side;
        for (int s = 0; s < lines.length(); ++s) side.push_back(place_of(lines.point(row, s)));
        if (std::ranges::count(side, side.front()) == std::ssize(side)) continue;  // a pole
        const bool is_turned = std::ranges::lexicographical_compare(side.rbegin(), side.rend(),
                                                                    side.begin(), side.end());
        if (is_turned) std::ranges::reverse(side);
        const auto [found, is_new] = sides.try_emplace(std::move(side), Member{d, is_turned});
        if (is_new) continue;
        const bool is_against = found->second.is_turned != is_turned;
        ties_[d].push_back({found->second.direction, is_against});
        ties_[found->second.direction].push_back({d, is_against});
      }
    }
  }

  /// The same parameters for all directions that are tied to one.
  void set_from(std::size_t first, std::vector<char>& seen) {
    std::vector<Member> members{{first, false}};
    seen[first] = 1;
    std::vector<double> steps;
    for (std::size_t m = 0; m < members.size(); ++m) {
      const Member member = members[m];
      add_steps(member, steps);
      for (const Tie& tie : ties_[member.direction]) {
        if (seen[tie.other] != 0) continue;
        seen[tie.other] = 1;
        members.push_back({tie.other, member.is_turned != tie.is_turned});
      }
    }
    const std::vector<double> values = values_of(steps);
    for (const Member& member : members) {
      SplinePiece& piece = pieces_[member.direction / 2];
      std::vector<double>& out = member.direction % 2 == 0 ? piece.u : piece.v;
      out = values;
      if (!member.is_turned) continue;
      std::ranges::reverse(out);
      for (double& value : out) value = 1 - value;
    }
  }

  /// Adds the parts that steps have of the lengths of rows.
  void add_steps(const Member& member, std::vector<double>& sum) const {
    const Lines lines = rows(member.direction);
    const int steps = lines.length() - 1;
    sum.resize(at(steps), 0);
    std::vector<double> lengths(at(steps));
    for (int row = 0; row < lines.count(); ++row) {
      double whole = 0;
      for (int s = 0; s < steps; ++s) {
        const int step = member.is_turned ? steps - 1 - s : s;
        lengths[at(step)] = (lines.point(row, s + 1) - lines.point(row, s)).norm();
        whole += lengths[at(step)];
      }
      for (int s = 0; s < steps && whole > 0; ++s) sum[at(s)] += lengths[at(s)] / whole;
    }
  }

  static std::vector<double> values_of(const std::vector<double>& steps) {
    double whole = 0;
    for (const double step : steps) whole += step;
    std::vector<double> values{0};
    for (const double step : steps) {
      const double part = whole > 0 ? step / whole : 0;
      values.push_back(values.back() + std::max(part, kLeastStep));
    }
    for (double& value : values) value /= values.back();
    return values;
  }

  std::vector<SplinePiece>& pieces_;
  std::vector<std::vector<Tie>> ties_;
};

}  // namespace

std::vector<SplinePiece> spline_pieces(const Patches& patches) {
  Cuts cuts = cut(patches);
  // Lines that wind round and round: let sides meet parts of sides, to a tolerance.
  if (!match_corners(cuts)) cuts = cut(patches);
  std::vector<SplinePiece> pieces;
  for (const auto& [along_i, along_j] : cuts) {
    for (const auto& j : spans(along_j)) {
      for (const auto& i : spans(along_i)) {
        pieces.push_back({part_of(along_i.patch, i, j), {}, {}});
      }
    }
  }
  Parameters(pieces).set();
  return pieces;
}

}  // namespace vdb_offset::cad
