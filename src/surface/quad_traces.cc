// Eppstein, Goodrich, Kim, Tamstorf, Motorcycle graphs: canonical quad mesh partitioning, 2008:
// lines run at the same speed from the irregular points and stop at the tracks of others. At no
// point then do two borders leave more than a straight angle between them, and by the theorem of
// Gauss and Bonnet what has no irregular point inside and such a border is a rectangle, a tube, or,
// without any border, a torus.

#include "surface/quad_traces.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Half-edges that leave a point, counter-clockwise.
void fan_of(const QuadEdges& edges, int start, std::vector<int>& fan) {
  fan.clear();
  int h = start;
  do {
    fan.push_back(h);
    h = edges.turn_left(h);
  } while (h >= 0 && h != start);
}

/// Adds the edges inside each run of three quads or more between two borders of a fan.
void add_starts(const QuadEdges& edges, const QuadCuts& cuts, const std::vector<int>& fan,
                std::vector<int>& starts) {
  const bool open = edges.turn_left(fan.back()) < 0;
  const auto border = std::find_if(fan.begin(), fan.end(), [&](int h) { return cuts.is_cut(h); });
  if (border == fan.end()) {
    if (fan.size() != 4) starts.insert(starts.end(), fan.begin(), fan.end());
    return;
  }
  const std::size_t count = fan.size();
  const auto first = static_cast<std::size_t>(border - fan.begin());
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin + 1;
    while (end < count && !cuts.is_cut(fan[(first + end) % count])) ++end;
    for (std::size_t n = begin + 1; end - begin > 2 && n < end; ++n) {
      starts.push_back(fan[(first + n) % count]);
    }
    begin = end;
    if (open && first + end >= count) break;
  }
}

std::vector<int> find_starts(const QuadEdges& edges, const QuadCuts& cuts) {
  std::vector<int> starts;
  std::vector<int> fan;
  for (const int start : edges.start) {
    if (start < 0) continue;
    fan_of(edges, start, fan);
    add_starts(edges, cuts, fan, starts);
  }
  std::sort(starts.begin(), starts.end(), [&](int a, int b) {
    const bool same = edges.from(a) == edges.from(b);
    return same ? edges.before(edges.to(a), edges.to(b))
                : edges.before(edges.from(a), edges.from(b));
  });
  return starts;
}

/// Whether borders already cross the line that ends with h.
bool is_crossed(const QuadEdges& edges, const QuadCuts& cuts, int h) {
  return cuts.is_cut(QuadEdges::next(h)) || cuts.is_cut(QuadEdges::previous(edges.twin_of(h)));
}

/// Quads that hang together without a border between them.
class Regions {
 public:
  explicit Regions(const QuadEdges& edges) : edges_(edges), seen_(at(edges.size() / 4), 0) {}

  /// The region of a face, empty if it was asked for before.
  const std::vector<int>& flood(const QuadCuts& cuts, int face) {
    faces_.clear();
    add(face);
    for (std::size_t n = 0; n < faces_.size(); ++n) {
      const int f = faces_[n];
      for (int h = 4 * f; h < 4 * f + 4; ++h) {
        if (!cuts.is_cut(h)) add(edges_.twin_of(h) / 4);
      }
    }
    return faces_;
  }

 private:
  void add(int face) {
    if (seen_[at(face)] != 0) return;
    seen_[at(face)] = 1;
    faces_.push_back(face);
  }
  const QuadEdges& edges_;
  std::vector<char> seen_;
  std::vector<int> faces_;
};

template <typename Visit>
void for_halves(const std::vector<int>& faces, const Visit& visit) {
  for (const int face : faces) {
    for (int h = 4 * face; h < 4 * face + 4; ++h) visit(h);
  }
}

int length_of_loop(const QuadEdges& edges, int start) {
  int length = 1;
  for (int h = edges.straight_on(start); h != start; h = edges.straight_on(h)) ++length;
  return length;
}

/// Cuts a torus along the shorter of the two grid lines through its lowest point.
void cut_round(const QuadEdges& edges, QuadCuts& cuts, const std::vector<int>& faces) {
  int lowest = 4 * faces[0];
  for_halves(faces, [&](int h) {
    if (edges.before(edges.from(h), edges.from(lowest))) lowest = h;
  });
  std::vector<int> fan;
  fan_of(edges, lowest, fan);
  std::sort(fan.begin(), fan.end(),
            [&](int a, int b) { return edges.before(edges.to(a), edges.to(b)); });
  const int start = *std::min_element(fan.begin(), fan.end(), [&](int a, int b) {
    return length_of_loop(edges, a) < length_of_loop(edges, b);
  });
  int h = start;
  do {
    cuts.set(edges, h, Cut::Trace);
    h = edges.straight_on(h);
  } while (h != start);
}

/// Whether a seam that ends where h begins makes a T-junction (-1) or meets a corner (1) beyond.
int worth_of_end(const QuadEdges& edges, const QuadCuts& cuts, int h) {
  const int across = edges.twin_of(h);
  if (across < 0) return 0;
  return cuts.is_cut(QuadEdges::next(across)) ? 1 : -1;
}

/// The line across a tube from where its border half-edge h begins.
std::vector<int> line_across(const QuadEdges& edges, const QuadCuts& cuts, int h) {
  std::vector<int> line{edges.twin_of(QuadEdges::previous(h))};
  while (!cuts.is_cut(QuadEdges::next(line.back()))) line.push_back(edges.straight_on(line.back()));
  return line;
}

/// Cuts a tube across, where corners of neighbours are met if there are any.
void cut_across(const QuadEdges& edges, QuadCuts& cuts, const std::vector<int>& faces) {
  int best = -1;
  int best_worth = 0;
  for_halves(faces, [&](int h) {
    if (!cuts.is_cut(h)) return;
    const std::vector<int> line = line_across(edges, cuts, h);
    const int end = QuadEdges::next(line.back());
    const int worth = worth_of_end(edges, cuts, h) + worth_of_end(edges, cuts, end);
    const bool wins = best < 0 || worth > best_worth ||
                      (worth == best_worth && edges.before(edges.from(h), edges.from(best)));
    if (!wins) return;
    best = h;
    best_worth = worth;
  });
  for (const int h : line_across(edges, cuts, best)) cuts.set(edges, h, Cut::Trace);
}

}  // namespace

void trace_lines(const QuadEdges& edges, QuadCuts& cuts) {
  std::vector<int> running = find_starts(edges, cuts);
  std::vector<int> next;
  while (!running.empty()) {
    next.clear();
    for (const int h : running) {
      if (cuts.is_cut(h)) continue;
      cuts.set(edges, h, Cut::Trace);
      const bool stops = !edges.is_regular(edges.to(h)) || is_crossed(edges, cuts, h);
      if (!stops) next.push_back(edges.straight_on(h));
    }
    std::swap(running, next);
  }
}

int cut_seams(const QuadEdges& edges, QuadCuts& cuts) {
  Regions regions(edges);
  int seams = 0;
  for (int face = 0; face < edges.size() / 4; ++face) {
    const std::vector<int>& faces = regions.flood(cuts, face);
    if (faces.empty()) continue;
    bool has_corner = false;
    bool has_border = false;
    for_halves(faces, [&](int h) {
      has_corner = has_corner || cuts.is_corner(h);
      has_border = has_border || cuts.is_cut(h);
    });
    if (has_corner) continue;
    if (!has_border) cut_round(edges, cuts, faces);
    cut_across(edges, cuts, faces);
    seams += has_border ? 1 : 2;
  }
  return seams;
}

}  // namespace vdb_offset
