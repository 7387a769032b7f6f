#include "surface/polygon_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/sets.h"
#include "surface/solid_angle.h"

namespace vdb_offset {
namespace {

struct EdgeUse {
  int lo, hi;  // points
  int corner;  // of the face that it starts from
};

bool same_edge(const EdgeUse& a, const EdgeUse& b) { return a.lo == b.lo && a.hi == b.hi; }

std::size_t index(int n) { return static_cast<std::size_t>(n); }

/// Faces reached from one another over edges of two faces.
struct Sheet {
  Box box;
  int faces = 0;
  int flips = 0;
  bool twisted = false;
  bool closed = true;
  bool turned = false;  // all of it
};

class PolygonEdges {
 public:
  PolygonEdges(PolygonMesh& mesh, CleanReport& report) : mesh_(mesh), report_(report) {}

  void run(bool turn_outward) {
    gather_uses();
    sort_out_edges();
    count_fans();
    count_parts();
    for (std::size_t f = 0; f < mesh_.faces(); ++f) {
      if (sheet_[f] < 0) flood(static_cast<int>(f));
    }
    find_open_sheets();
    choose_senses(turn_outward);
    turn_faces();
  }

 private:
  std::size_t corners() const { return mesh_.corners.size(); }
  int face_of(const EdgeUse& use) const { return face_of_[index(use.corner)]; }
  int next_corner(int corner) const {
    const std::size_t f = index(face_of_[index(corner)]);
    return index(corner) + 1 == mesh_.first[f + 1] ? static_cast<int>(mesh_.first[f]) : corner + 1;
  }
  const Vec3& position(int point) const { return mesh_.points_world[index(point)]; }
  PolygonFlaw flaw(const EdgeUse& use, std::size_t count) const {
    return {position(use.lo), position(use.hi), static_cast<int>(count)};
  }
  /// Calls visit(first, last) for the uses of every edge.
  template <typename Visit>
  void for_edges(const Visit& visit) const {
    for (std::size_t begin = 0; begin < uses_.size();) {
      std::size_t end = begin + 1;
      while (end < uses_.size() && same_edge(uses_[begin], uses_[end])) ++end;
      visit(begin, end);
      begin = end;
    }
  }
  void gather_uses();
  void sort_out_edges();
  void count_fans();
  void count_parts();
  void flood(int face);
  void visit_neighbours(int face, std::vector<int>& open);
  void find_open_sheets();
  void choose_senses(bool turn_outward);
  std::vector<double> volumes() const;
  double winding(std::size_t sheet, const Vec3& place) const;
  int container(const std::vector<std::size_t>& order, std::size_t place) const;
  void turn_faces();

  PolygonMesh& mesh_;
  CleanReport& report_;
  std::vector<EdgeUse> uses_;  // those of one edge together
  std::vector<int> face_of_;   // of each corner
  std::vector<int> mate_;      // of each corner: the other of an edge of two faces, else -1
  std::vector<int> sheet_;     // of each face
  std::vector<bool> flipped_;  // of each face
  std::vector<Sheet> sheets_;
};

/// Uses are put in order of their lower point by counting, and within it by sorting.
void PolygonEdges::gather_uses() {
  face_of_.resize(corners());
  std::vector<std::size_t> begin(mesh_.points_world.size() + 1, 0);
  const auto ends = [&](int corner) {
    return std::minmax({mesh_.corners[index(corner)], mesh_.corners[index(next_corner(corner))]});
  };
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    for (std::size_t c = mesh_.first[f]; c < mesh_.first[f + 1]; ++c) {
      face_of_[c] = static_cast<int>(f);
    }
  }
  for (std::size_t c = 0; c < corners(); ++c) ++begin[index(ends(static_cast<int>(c)).first) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::size_t> at(begin.begin(), begin.end() - 1);
  uses_.resize(corners());
  for (std::size_t c = 0; c < corners(); ++c) {
    const auto [lo, hi] = ends(static_cast<int>(c));
    uses_[at[index(lo)]++] = {lo, hi, static_cast<int>(c)};
  }
  for (std::size_t p = 0; p + 1 < begin.size(); ++p) {
    std::sort(uses_.begin() + static_cast<std::ptrdiff_t>(begin[p]),
              uses_.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]),
              [](const EdgeUse& a, const EdgeUse& b) {
                return std::tie(a.hi, a.corner) < std::tie(b.hi, b.corner);
              });
  }
}

void PolygonEdges::sort_out_edges() {
  mate_.assign(corners(), -1);
  for_edges([&](std::size_t begin, std::size_t end) {
    if (end - begin == 1) {
      ++report_.boundary_edges;
    } else if (end - begin == 2) {
      mate_[index(uses_[begin].corner)] = uses_[begin + 1].corner;
      mate_[index(uses_[begin + 1].corner)] = uses_[begin].corner;
    } else {
      report_.many_faced_edges.push_back(flaw(uses_[begin], end - begin));
    }
  });
}

/// Corners at a point whose faces share an edge there belong to one fan.
void PolygonEdges::count_fans() {
  Sets fans(corners());
  for_edges([&](std::size_t begin, std::size_t end) {
    const auto corner_at = [&](const EdgeUse& use, int point) {
      return mesh_.corners[index(use.corner)] == point ? use.corner : next_corner(use.corner);
    };
    for (std::size_t u = begin + 1; u < end; ++u) {
      for (const int point : {uses_[u].lo, uses_[u].hi}) {
        fans.join(corner_at(uses_[begin], point), corner_at(uses_[u], point));
      }
    }
  });
  std::vector<int> count(mesh_.points_world.size(), 0);
  for (std::size_t c = 0; c < corners(); ++c) {
    if (fans.root(static_cast<int>(c)) == static_cast<int>(c)) ++count[index(mesh_.corners[c])];
  }
  for (std::size_t p = 0; p < count.size(); ++p) {
    const Vec3& place = mesh_.points_world[p];
    if (count[p] > 1) report_.many_fan_points.push_back({place, place, count[p]});
  }
}

void PolygonEdges::count_parts() {
  Sets parts(mesh_.faces());
  for_edges([&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin + 1; u < end; ++u) {
      parts.join(face_of(uses_[begin]), face_of(uses_[u]));
    }
  });
  std::vector<bool> open(mesh_.faces(), false);
  for_edges([&](std::size_t begin, std::size_t end) {
    if (end - begin == 1) open[index(parts.root(face_of(uses_[begin])))] = true;
  });
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    if (parts.root(static_cast<int>(f)) != static_cast<int>(f)) continue;
    ++report_.parts;
    report_.closed_parts += open[f] ? 0 : 1;
  }
  sheet_.assign(mesh_.faces(), -1);
  flipped_.assign(mesh_.faces(), false);
}

void PolygonEdges::flood(int face) {
  const int sheet = static_cast<int>(sheets_.size());
  sheets_.emplace_back();
  sheet_[index(face)] = sheet;
  std::vector<int> open{face};
  while (!open.empty()) {
    const int from = open.back();
    open.pop_back();
    ++sheets_.back().faces;
    sheets_.back().flips += flipped_[index(from)] ? 1 : 0;
    visit_neighbours(from, open);
  }
}

void PolygonEdges::visit_neighbours(int face, std::vector<int>& open) {
  const std::size_t f = index(face);
  for (std::size_t c = mesh_.first[f]; c < mesh_.first[f + 1]; ++c) {
    if (mate_[c] < 0) continue;
    const auto mate = index(mate_[c]);
    const std::size_t other = index(face_of_[mate]);
    const bool opposed = mesh_.corners[c] != mesh_.corners[mate];  // as it should be
    const bool flipped = flipped_[f] == opposed;                   // what the other has to be
    if (sheet_[other] < 0) {
      sheet_[other] = sheet_[f];
      flipped_[other] = flipped;
      open.push_back(static_cast<int>(other));
      continue;
    }
    Sheet& sheet = sheets_[index(sheet_[f])];
    if (flipped_[other] == flipped || sheet.twisted) continue;
    sheet.twisted = true;
    const int a = mesh_.corners[c];
    const int b = mesh_.corners[index(next_corner(static_cast<int>(c)))];
    report_.twisted_edges.push_back({position(a), position(b), 2});
  }
}

/// A sheet is closed where each edge has two faces of it, whatever other sheets do there.
void PolygonEdges::find_open_sheets() {
  std::vector<int> here;
  for_edges([&](std::size_t begin, std::size_t end) {
    if (end - begin == 2) return;
    here.clear();
    for (std::size_t u = begin; u < end; ++u) here.push_back(sheet_[index(face_of(uses_[u]))]);
    std::sort(here.begin(), here.end());
    for (std::size_t n = 0; n < here.size();) {
      std::size_t m = n + 1;
      while (m < here.size() && here[m] == here[n]) ++m;
      if (m - n != 2) sheets_[index(here[n])].closed = false;
      n = m;
    }
  });
}

/// Of sheets as they are flipped, six times. About a point of each, so that little cancels.
std::vector<double> PolygonEdges::volumes() const {
  std::vector<double> sums(sheets_.size(), 0.0);
  std::vector<int> centre(sheets_.size(), -1);
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    const auto face = mesh_.face(f);
    const std::size_t s = index(sheet_[f]);
    if (centre[s] < 0) centre[s] = face[0];
    const Vec3& o = position(centre[s]);
    double sum = 0.0;
    for (std::size_t n = 1; n + 1 < face.size(); ++n) {
      sum += (position(face[0]) - o).dot((position(face[n]) - o).cross(position(face[n + 1]) - o));
    }
    sums[s] += flipped_[f] ? -sum : sum;
  }
  return sums;
}

/// How often a closed sheet, as it is flipped, goes round a point.
double PolygonEdges::winding(std::size_t sheet, const Vec3& place) const {
  double angle = 0;
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    if (index(sheet_[f]) != sheet) continue;
    const auto face = mesh_.face(f);
    const Vec3& o = position(face[0]);
    for (std::size_t n = 1; n + 1 < face.size(); ++n) {
      const TriangleGeometry t{o, position(face[n]) - o, position(face[n + 1]) - o};
      angle += flipped_[f] ? -solid_angle(t, place) : solid_angle(t, place);
    }
  }
  return angle / (4 * std::numbers::pi);
}

/// The smallest of the closed sheets before `place` in `order` that goes round one; -1: none.
int PolygonEdges::container(const std::vector<std::size_t>& order, std::size_t place) const {
  const std::size_t inner = order[place];
  const Box& box = sheets_[inner].box;
  for (std::size_t n = place; n-- > 0;) {
    const Box& around = sheets_[order[n]].box;
    const bool is_in =
        (box.lo.array() > around.lo.array()).all() && (box.hi.array() < around.hi.array()).all();
    if (!is_in) continue;
    const auto f = std::ranges::find(sheet_, static_cast<int>(inner)) - sheet_.begin();
    const Vec3& point = position(mesh_.face(static_cast<std::size_t>(f))[0]);
    if (std::abs(winding(order[n], point)) > 0.5) return static_cast<int>(order[n]);
  }
  return -1;
}

/// Closed sheets outward; but one within another against that if the file has it so: a hollow, or a
/// body in one.
void PolygonEdges::choose_senses(bool turn_outward) {
  const std::vector<double> volume = volumes();
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < sheets_.size(); ++s) {
    Sheet& sheet = sheets_[s];
    sheet.turned = 2 * sheet.flips > sheet.faces;
    if (turn_outward && sheet.closed && !sheet.twisted && volume[s] != 0) order.push_back(s);
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::abs(volume[a]) > std::abs(volume[b]);
  });
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    for (const int point : mesh_.face(f)) sheets_[index(sheet_[f])].box.add(position(point));
  }
  std::vector<char> is_changed(sheets_.size(), 0);
  for (std::size_t n = 0; n < order.size(); ++n) {
    Sheet& sheet = sheets_[order[n]];
    const int around = container(order, n);
    const bool is_inward = (volume[order[n]] < 0) != sheet.turned;
    const bool change = around < 0 ? is_inward : is_changed[index(around)] != 0;
    if (!change) continue;
    is_changed[order[n]] = 1;
    sheet.turned = !sheet.turned;
    ++report_.turned_parts;
  }
}

void PolygonEdges::turn_faces() {
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    const auto face = mesh_.face(f);
    for (std::size_t n = 1; n + 1 < face.size(); ++n) {
      const Vec3& o = position(face[0]);
      report_.area_world += 0.5 * (position(face[n]) - o).cross(position(face[n + 1]) - o).norm();
    }
    if (flipped_[f] == sheets_[index(sheet_[f])].turned) continue;
    ++report_.turned_faces;
    std::reverse(mesh_.corners.begin() + static_cast<std::ptrdiff_t>(mesh_.first[f]) + 1,
                 mesh_.corners.begin() + static_cast<std::ptrdiff_t>(mesh_.first[f + 1]));
  }
}

}  // namespace

void orient_polygons(PolygonMesh& mesh, bool turn_outward, CleanReport& report) {
  PolygonEdges(mesh, report).run(turn_outward);
}

}  // namespace vdb_offset
