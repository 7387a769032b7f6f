#include "surface/crossed_curves.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/sets.h"
#include "surface/orient.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kRounding = 1e-14;  // of products of lengths

/// Between points i and i + 1 of a curve.
struct CurvePiece {
  std::size_t patch;
  int i;
  std::array<int, 2> nodes;
  Vec2 from, to;
  int curve = 0;

  double first_x() const { return std::min(from.x(), to.x()); }
  double last_x() const { return std::max(from.x(), to.x()); }
  auto order() const { return std::tie(patch, i); }
};

std::vector<CurvePiece> pieces_of(const Surface& surface) {
  std::vector<CurvePiece> pieces;
  Sets curves(surface.nodes_world.size());
  const auto stand = [&](int node) {
    return static_cast<int>(surface.stands_at(static_cast<std::size_t>(node)));
  };
  // The other side's patches are copies.
  const std::size_t patches = surface.patches.size() / (surface.both_sides ? 2 : 1);
  for (std::size_t p = 0; p < patches; ++p) {
    if (surface.is_fan(p)) continue;
    const Patch& patch = surface.patches[p];
    for (int i = 0; i + 1 < patch.ni; ++i) {
      // Columns of a fan stand in one place.
      const int a = stand(surface.node(static_cast<int>(p), i, 0));
      const int b = stand(surface.node(static_cast<int>(p), i + 1, 0));
      curves.join(a, b);
      if (a == b) continue;
      pieces.push_back({p, i, {a, b}, patch.at(i, 0).head<2>(), patch.at(i + 1, 0).head<2>()});
    }
  }
  for (CurvePiece& piece : pieces) piece.curve = curves.root(piece.nodes[0]);
  return pieces;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// On which side of a piece a point lies, 0 on its line to rounding.
int side_of(const CurvePiece& piece, const Vec2& p) {
  const Vec2 along = piece.to - piece.from;
  const Vec2 away = p - piece.from;
  const double area = cross(along, away);
  const double reach = p.cwiseAbs().maxCoeff() + piece.from.cwiseAbs().maxCoeff();
  if (std::abs(area) <= kRounding * along.norm() * reach) return 0;
  return area > 0 ? 1 : -1;
}

bool overlap(double a, double b, double c, double d) {
  return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
}

/// The place that two pieces have in common, if they do.
std::optional<Vec2> common_place(const CurvePiece& a, const CurvePiece& b) {
  if (!overlap(a.from.x(), a.to.x(), b.from.x(), b.to.x()) ||
      !overlap(a.from.y(), a.to.y(), b.from.y(), b.to.y())) {
    return {};
  }
  const std::array<int, 4> sides{side_of(a, b.from), side_of(a, b.to), side_of(b, a.from),
                                 side_of(b, a.to)};
  if (sides[0] * sides[1] > 0 || sides[2] * sides[3] > 0) return {};
  const double against = cross(a.to - a.from, b.to - b.from);
  if (sides[0] == 0 || against == 0) return b.from;
  return Vec2(a.from + cross(b.from - a.from, b.to - b.from) / against * (a.to - a.from));
}

struct Crossing {
  const CurvePiece* first;
  const CurvePiece* second;
  Vec2 place;
};

/// Pieces by where they begin along x, each with those that begin before it ends.
std::vector<Crossing> find_crossings(std::vector<CurvePiece>& pieces) {
  std::ranges::sort(pieces, [](const CurvePiece& a, const CurvePiece& b) {
    return std::pair(a.first_x(), a.order()) < std::pair(b.first_x(), b.order());
  });
  std::vector<Crossing> crossings;
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    const CurvePiece& a = pieces[n];
    for (std::size_t m = n + 1; m < pieces.size() && pieces[m].first_x() <= a.last_x(); ++m) {
      const CurvePiece& b = pieces[m];
      const bool are_joined = a.nodes[0] == b.nodes[0] || a.nodes[0] == b.nodes[1] ||
                              a.nodes[1] == b.nodes[0] || a.nodes[1] == b.nodes[1];
      if (are_joined || a.curve != b.curve) continue;
      const std::optional<Vec2> place = common_place(a, b);
      if (!place) continue;
      const bool is_first = a.order() < b.order();
      crossings.push_back({is_first ? &a : &b, is_first ? &b : &a, *place});
    }
  }
  return crossings;
}

std::string points_of(const CurvePiece& piece) {
  return fmt::format("between points {} and {}", piece.i + 1, piece.i + 2);
}

}  // namespace

void refuse_crossed_curves(const Surface& surface) {
  std::vector<CurvePiece> pieces = pieces_of(surface);
  const std::vector<Crossing> crossings = find_crossings(pieces);
  if (crossings.empty()) return;
  const Crossing& first = *std::ranges::min_element(crossings, {}, [](const Crossing& crossing) {
    return std::pair(crossing.first->order(), crossing.second->order());
  });
  const auto name = [&](const CurvePiece& piece) {
    return name_of(surface.patches[piece.patch], static_cast<int>(piece.patch));
  };
  const bool is_one = first.first->patch == first.second->patch;
  throw InputError(fmt::format(
      "a curve crosses itself{}: {}, {} and {}{}, at ({:.6g}, {:.6g}): what lies on one side of it "
      "is on the other too; leave out the loop, or mend its points; 'field' takes it as it is",
      crossings.size() > 1 ? fmt::format(" in {} places, the first", crossings.size()) : "",
      name(*first.first), points_of(*first.first), is_one ? "" : name(*first.second) + ", ",
      points_of(*first.second), first.place.x(), first.place.y()));
}

}  // namespace vdb_offset
