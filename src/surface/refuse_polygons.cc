#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>

#include "surface/corner_touch.h"
#include "surface/other_weld.h"
#include "surface/single_edges.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/clean_polygons.h"

namespace vdb_offset {
namespace {

std::string text_of(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

/// Flaws of one kind.
struct Refusal {
  std::string what;
  std::string_view advice;
};

Refusal crossed(const std::vector<PolygonFlaw>& flaws) {
  const PolygonFlaw& first = flaws.front();
  return {
      fmt::format("{} face{} that cross themselves, as a bow tie does, the first face {}, whose "
                  "edge from {} to {} another one crosses",
                  flaws.size(), plural(flaws.size()), first.face, text_of(first.from_world),
                  text_of(first.to_world)),
      "give the corners of each in the order that they have around it (of four, exchange two "
      "that follow one another)"};
}

Refusal many_faced(const std::vector<PolygonFlaw>& flaws) {
  const PolygonFlaw& first = flaws.front();
  static const std::string kAdvice =
      std::string("remove inner and doubled faces there; ") + kStandsThere;
  return {fmt::format("{} edge{} of more than two faces, the first of {} from {} to {}, and a wall "
                      "has one or two",
                      flaws.size(), plural(flaws.size()), first.count, text_of(first.from_world),
                      text_of(first.to_world)),
          kAdvice};
}

/// The faces around a point, as the ways to their corners beside it.
struct Corner {
  int next, previous;
};
using Corners = std::map<int, std::vector<Corner>>;

/// Of the points of flaws.
Corners corners_at(const PolygonMesh& mesh, const std::vector<PolygonFlaw>& flaws) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::vector<Vec3> places;
  for (const PolygonFlaw& flaw : flaws) places.push_back(flaw.from_world);
  std::ranges::sort(places, less);
  Corners corners;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t c = 0; c < face.size(); ++c) {
      const Vec3& place = mesh.points_world[static_cast<std::size_t>(face[c])];
      if (!std::ranges::binary_search(places, place, less)) continue;
      corners[face[c]].push_back(
          {face[(c + 1) % face.size()], face[(c + face.size() - 1) % face.size()]});
    }
  }
  return corners;
}

/// Edges that end where parts touch: those that run along others, or on faces, without their
/// points.
struct Touching {
  std::array<std::size_t, 3> count{};  // by CornerTouch
  std::array<std::array<Vec3, 2>, 3> first;
};

Touching touching_at(const PolygonMesh& mesh, const std::vector<PolygonFlaw>& flaws) {
  const auto at = [&](int point) { return mesh.points_world[static_cast<std::size_t>(point)]; };
  Touching touching;
  for (const auto& [point, corners] : corners_at(mesh, flaws)) {
    std::map<int, int> uses;  // of edges from here, by their other end
    for (const Corner& corner : corners) {
      ++uses[corner.next];
      ++uses[corner.previous];
    }
    for (const auto& [end, count] : uses) {
      if (count != 1) continue;
      const Vec3 way = at(end) - at(point);
      auto most = CornerTouch::Apart;
      for (const Corner& corner : corners) {
        if (corner.next == end || corner.previous == end) continue;
        most = std::max(
            most, corner_touch(way, at(corner.next) - at(point), at(corner.previous) - at(point)));
      }
      const auto kind = static_cast<std::size_t>(most);
      if (touching.count[kind]++ == 0) touching.first[kind] = {at(point), at(end)};
    }
  }
  return touching;
}

Refusal many_fans(const PolygonMesh& mesh, const std::vector<PolygonFlaw>& flaws) {
  const Touching touching = touching_at(mesh, flaws);
  const auto edges = [&](CornerTouch kind, std::string_view what) {
    const auto k = static_cast<std::size_t>(kind);
    const std::size_t count = touching.count[k];
    return fmt::format("{} edge{} {}, the first from {} to {}", count, plural(count), what,
                       text_of(touching.first[k][0]), text_of(touching.first[k][1]));
  };
  if (touching.count[static_cast<std::size_t>(CornerTouch::OnFace)] > 0) {
    return {edges(CornerTouch::OnFace, "of one part that lie across faces of another") +
                ": three faces meet there, and a wall has one or two at an edge",
            kStandsThere};
  }
  if (touching.count[static_cast<std::size_t>(CornerTouch::AlongSide)] > 0) {
    return {edges(CornerTouch::AlongSide,
                  "that run along others and do not end where those do (T-junctions)") +
                ", and a wall has the same points on both sides of an edge",
            "split the longer ones at the points that lie on them"};
  }
  const PolygonFlaw& first = flaws.front();
  return {fmt::format("{} point{} where parts touch in a point alone, the first of {} parts at {}, "
                      "and the faces at a point of a wall go round it in one fan",
                      flaws.size(), plural(flaws.size()), first.count, text_of(first.from_world)),
          "join the parts along an edge, or move them apart"};
}

Refusal twisted(const std::vector<PolygonFlaw>& flaws) {
  const PolygonFlaw& first = flaws.front();
  return {
      fmt::format("{} part{} with one side only, as a Moebius strip has, seen from {} to {}, and "
                  "a wall has two",
                  flaws.size(), plural(flaws.size()), text_of(first.from_world),
                  text_of(first.to_world)),
      "cut it open there"};
}

Refusal refusal_of(const PolygonMesh& mesh, const CleanReport& report) {
  if (!report.crossed_faces.empty()) return crossed(report.crossed_faces);
  if (!report.many_faced_edges.empty()) return many_faced(report.many_faced_edges);
  if (!report.many_fan_points.empty()) return many_fans(mesh, report.many_fan_points);
  return twisted(report.twisted_edges);
}

}  // namespace

void refuse_unmeshable(const PolygonMesh& mesh, const CleanReport& report,
                       const std::string& more) {
  if (report.is_meshable()) return;
  const Refusal refusal = refusal_of(mesh, report);
  throw InputError(fmt::format("{}: {}; {}{}; or take 'field', which needs distances alone",
                               mesh.file.empty() ? "the surface" : mesh.file, refusal.what,
                               refusal.advice, more));
}

std::string weld_advice(const PolygonMesh& mesh, const CleanOptions& options) {
  const auto cleaned = [&](double weld) {
    CleanOptions other = options;
    other.weld = weld;
    return clean_polygons(mesh, other);
  };
  const auto judge = [&](double weld) -> std::optional<std::size_t> {
    const CleanedPolygons with = cleaned(weld);
    if (!with.report.is_meshable()) return {};
    CellEdges edges;
    for (std::size_t f = 0; f < with.mesh.faces(); ++f) edges.add(with.mesh.face(f));
    return std::move(edges).single().size();
  };
  return weld_advice(options.weld, cleaned(options.weld).report.welded_near > 0, judge);
}

}  // namespace vdb_offset
