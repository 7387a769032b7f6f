// The inlet of half a pipe is no loop of free edges, but a chain of them: its ends lie on the plane
// of symmetry, and the line that this cuts the inlet's plane along closes it. All planes have the
// whole wall, and so the domain, on one side: beyond a chain's end the domain goes on in the plane,
// along the line of the plane that the chain ends on, until another chain comes or a third plane.

#include "surface/cut_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

#include "surface/plane_chains.h"

namespace vdb_offset {

namespace {

constexpr double kParallel = 1e-6;  // sine of the angle between planes that do not cut each other
constexpr double kFacing = 2e-3;    // radians that planes face each other to
constexpr double kSameLength = 1e-9;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

using Chords = std::vector<CutFace::Chord>;

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

/// A vector within a plane, unit length.
Vec3 within(const Plane& plane, const Vec3& v) {
  return (v - v.dot(plane.normal) * plane.normal).normalized();
}

/// Where a chain of edges ends, and the way into the flow there.
struct ChainEnd {
  std::size_t chain;
  int node;
  Vec3 flow;
  std::size_t next = kNone;  // the end that chords lead to
  Chords chords = {};
};

/// A straight way along the line that another plane cuts the plane of the faces along.
struct Way {
  Vec3 from, direction;
  std::size_t along;  // the other plane
};

/// The faces of one plane.
class PlaneFaces {
 public:
  PlaneFaces(const PlaneFinder& finder, const std::vector<CutPlane>& planes, std::size_t own)
      : finder_(finder), planes_(planes), own_(own), plane_(planes[own].plane) {}

  std::vector<CutFace> find() {
    chains_ = chains_of(finder_, planes_[own_].edges);
    add_ends();
    for (ChainEnd& end : ends_) end.next = follow(end);
    std::vector<CutFace> faces;
    std::vector<bool> seen(ends_.size(), false);
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      if (std::optional<CutFace> face = face_from(e, seen)) faces.push_back(std::move(*face));
    }
    return faces;
  }

 private:
  void add_ends() {
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      if (chains_[c].is_loop) continue;
      std::map<int, std::vector<std::size_t>> at_node;
      for (const std::size_t e : chains_[c].edges) {
        at_node[finder_.edges()[e].a].push_back(e);
        at_node[finder_.edges()[e].b].push_back(e);
      }
      std::vector<ChainEnd> ends;
      for (const auto& [node, here] : at_node) {
        if (here.size() != 1) continue;
        ends.push_back({c, node, within(plane_, finder_.edges()[here.front()].normal)});
      }
      if (ends.size() == 2) ends_.insert(ends_.end(), ends.begin(), ends.end());
    }
  }

  bool is_on(std::size_t plane, const Vec3& p) const {
    return std::abs(height(planes_[plane].plane, p)) <= finder_.tolerance();
  }

  /// Unit length, either way; none along a plane that is parallel.
  std::optional<Vec3> line_along(std::size_t other) const {
    const Vec3 line = plane_.normal.cross(planes_[other].plane.normal);
    if (other == own_ || line.norm() < kParallel) return {};
    return line.normalized();
  }

  /// The way from a chain's end into the flow along one of the planes that it is on.
  std::optional<Way> way_from(const ChainEnd& end) const {
    const Vec3& from = finder_.node(end.node);
    std::optional<Way> best;
    double most = kParallel;
    for (std::size_t q = 0; q < planes_.size(); ++q) {
      std::optional<Vec3> line = line_along(q);
      if (!line || !is_on(q, from)) continue;
      if (line->dot(end.flow) < 0) *line = -*line;
      const auto leads_out = [&](const CutPlane& other) {
        return std::abs(height(other.plane, from)) <= finder_.tolerance() &&
               other.plane.normal.dot(*line) < -kParallel;
      };
      if (line->dot(end.flow) <= most || std::ranges::any_of(planes_, leads_out)) continue;
      most = line->dot(end.flow);
      best = {from, *line, q};
    }
    return best;
  }

  /// The first end on a way, and how far it is.
  std::pair<std::size_t, double> first_end(const Way& way) const {
    std::pair<std::size_t, double> first{kNone, std::numeric_limits<double>::infinity()};
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      const Vec3& p = finder_.node(ends_[e].node);
      const double t = way.direction.dot(p - way.from);
      if (t > finder_.tolerance() && t < first.second && is_on(way.along, p)) first = {e, t};
    }
    return first;
  }

  /// The first plane that a way leads out through.
  std::pair<std::size_t, double> first_plane(const Way& way) const {
    std::pair<std::size_t, double> first{kNone, std::numeric_limits<double>::infinity()};
    for (std::size_t r = 0; r < planes_.size(); ++r) {
      if (r == own_ || r == way.along) continue;
      const double towards = -planes_[r].plane.normal.dot(way.direction);
      if (towards < kParallel) continue;
      const double t = height(planes_[r].plane, way.from) / towards;
      if (t > finder_.tolerance() && t < first.second) first = {r, t};
    }
    return first;
  }

  /// The end that the flow reaches to from another.
  std::size_t follow(ChainEnd& start) const {
    std::optional<Way> way = way_from(start);
    for (std::size_t n = 0; way && n < planes_.size(); ++n) {
      const auto [end, to_end] = first_end(*way);
      const auto [plane, to_plane] = first_plane(*way);
      if (end == kNone && plane == kNone) return kNone;
      const bool is_end = to_end <= to_plane + finder_.tolerance();
      const Vec3 to = way->from + (is_end ? to_end : to_plane) * way->direction;
      start.chords.push_back({way->along, {way->from, to}});
      if (is_end) return way->direction.dot(ends_[end].flow) < 0 ? end : kNone;
      std::optional<Vec3> line = line_along(plane);
      if (!line) return kNone;
      const bool is_back = line->dot(planes_[way->along].plane.normal) < 0;
      way = Way{to, is_back ? Vec3(-*line) : *line, plane};
    }
    return kNone;
  }

  /// The face that a chain's end is on the rim of, if it is closed.
  std::optional<CutFace> face_from(std::size_t first, std::vector<bool>& seen) const {
    CutFace face;
    for (std::size_t e = first; !seen[e];) {
      const std::size_t out = e ^ 1U;  // the two ends of a chain stand side by side
      seen[e] = seen[out] = true;
      const std::size_t next = ends_[out].next;
      if (next == kNone || ends_[next].next != out) return {};
      const std::vector<std::size_t>& edges = chains_[ends_[e].chain].edges;
      face.edges.insert(face.edges.end(), edges.begin(), edges.end());
      face.chords.insert(face.chords.end(), ends_[out].chords.begin(), ends_[out].chords.end());
      e = next;
    }
    return is_around_flow(face) ? std::optional(face) : std::nullopt;
  }

  bool is_around_flow(const CutFace& face) const {
    double area = finder_.rim_of(plane_, face.edges).area;
    for (const CutFace::Chord& chord : face.chords) {
      const Vec3 middle = 0.5 * (chord.ends_world[0] + chord.ends_world[1]);
      const double length = (chord.ends_world[1] - chord.ends_world[0]).norm();
      const Vec3 inward = within(plane_, planes_[chord.plane].plane.normal);
      area += length * (middle - plane_.point_world).dot(inward);
    }
    return !face.edges.empty() && area < 0;
  }

  const PlaneFinder& finder_;
  const std::vector<CutPlane>& planes_;
  std::size_t own_;
  const Plane& plane_;
  std::vector<EdgeChain> chains_;
  std::vector<ChainEnd> ends_;
};

/// What speaks for a face being passed by the flow, the first that differs deciding.
struct Rank {
  enum class Closed { No, WithImage, BySums, ByImages };
  Closed closed = Closed::No;
  std::size_t chords = 0;
  std::size_t planes = 0;
  double length = 0;

  bool is_above(const Rank& other) const {
    if (closed != other.closed) return closed > other.closed;
    if (closed != Closed::ByImages) return true;
    if (chords != other.chords) return chords < other.chords;
    if (planes != other.planes) return planes < other.planes;
    return length < (1 - kSameLength) * other.length;
  }
};

/// Whether some direction in a plane points out through all the planes of a face's chords.
bool is_closed_by_images(const Plane& plane, const CutFace& face,
                         const std::vector<CutPlane>& planes) {
  const Vec3 u = plane.normal.unitOrthogonal();
  const Vec3 v = plane.normal.cross(u);
  std::vector<double> angles;
  for (const CutFace::Chord& chord : face.chords) {
    const Vec3& out = planes[chord.plane].plane.normal;
    angles.push_back(std::atan2(out.dot(v), out.dot(u)));
  }
  std::ranges::sort(angles);
  double gap = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t n = 1; n < angles.size(); ++n) gap = std::max(gap, angles[n] - angles[n - 1]);
  return gap > std::numbers::pi + kFacing;
}

Rank rank_of(const PlaneFinder& finder, const std::vector<CutPlane>& planes, std::size_t plane,
             const CutFace& face) {
  const PlaneRim rim = finder.rim_of(planes[plane].plane, face.edges);
  std::set<std::size_t> others;
  for (const CutFace::Chord& chord : face.chords) others.insert(chord.plane);
  Rank rank{Rank::Closed::No, face.chords.size(), others.size(), rim.length};
  const auto is_half = [&](std::size_t other) { return closes_with_image(rim, planes[other]); };
  if (!planes[plane].is_symmetry && std::ranges::any_of(others, is_half)) {
    rank.closed = Rank::Closed::WithImage;
  }
  if (rim.is_opening()) rank.closed = Rank::Closed::BySums;
  if (is_closed_by_images(planes[plane].plane, face, planes)) rank.closed = Rank::Closed::ByImages;
  return rank;
}

bool has_chord_in(const CutFace& face, std::size_t plane) {
  return std::ranges::any_of(face.chords,
                             [&](const CutFace::Chord& chord) { return chord.plane == plane; });
}

}  // namespace

bool closes_with_image(const PlaneRim& rim, const CutPlane& other) {
  const Vec3& normal = other.plane.normal;
  const double towards = -normal.dot(rim.closing);
  return other.is_symmetry && towards > 0 &&
         (rim.closing + towards * normal).norm() <= kFacing * rim.length;
}

std::vector<CutFace> faces_closed_by_images(const PlaneFinder& finder,
                                            const std::vector<CutPlane>& planes) {
  std::vector<CutFace> faces = PlaneFaces(finder, planes, planes.size() - 1).find();
  std::erase_if(faces, [&](const CutFace& face) {
    return !is_closed_by_images(planes.back().plane, face, planes);
  });
  return faces;
}

std::vector<CutFaces> find_cut_faces(const PlaneFinder& finder,
                                     const std::vector<CutPlane>& planes) {
  std::vector<CutFaces> cut(planes.size());
  std::vector<std::vector<Rank>> ranks(planes.size());
  for (std::size_t p = 0; p < planes.size(); ++p) {
    cut[p].faces = PlaneFaces(finder, planes, p).find();
    for (const CutFace& face : cut[p].faces) ranks[p].push_back(rank_of(finder, planes, p, face));
  }
  const auto is_passed = [&](std::size_t p, std::size_t f) {
    const auto is_above = [&](const CutFace::Chord& chord) {
      const std::vector<CutFace>& beside = cut[chord.plane].faces;
      for (std::size_t g = 0; g < beside.size(); ++g) {
        if (has_chord_in(beside[g], p) && !ranks[p][f].is_above(ranks[chord.plane][g]))
          return false;
      }
      return true;
    };
    return ranks[p][f].closed != Rank::Closed::No &&
           std::ranges::all_of(cut[p].faces[f].chords, is_above);
  };
  for (std::size_t p = 0; p < planes.size(); ++p) {
    for (std::size_t f = 0; f < cut[p].faces.size(); ++f) {
      CutFace& face = cut[p].faces[f];
      face.is_opening = is_passed(p, f);
      if (!face.is_opening || ranks[p][f].closed != Rank::Closed::ByImages) continue;
      for (const CutFace::Chord& chord : face.chords) cut[chord.plane].is_mirror = true;
    }
  }
  return cut;
}

}  // namespace vdb_offset
