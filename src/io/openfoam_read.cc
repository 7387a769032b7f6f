// polyMesh as the OpenFOAM user guide describes it. Which shape a cell has is not said: it is that
// whose faces it has.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "io/foam_text.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/openfoam.h"

namespace vdb_offset {
namespace {

namespace fs = std::filesystem;
using Points = std::span<const std::int32_t>;
using List = std::vector<std::int32_t>;

/// The faces of one cell, counter-clockwise seen from outside.
using CellFaces = std::vector<List>;

bool contains(const List& face, std::int32_t point) {
  return std::ranges::find(face, point) != face.end();
}

/// Where the edge leads that leaves `point` of `base` and lies on no edge of it; -1: nowhere, or to
/// several places.
std::int32_t across(const CellFaces& faces, const List& base, std::int32_t point) {
  std::int32_t to = -1;
  for (const List& face : faces) {
    const auto at = std::ranges::find(face, point);
    if (at == face.end() || &face == &base) continue;
    const std::size_t n = static_cast<std::size_t>(at - face.begin());
    for (const std::size_t step : {std::size_t{1}, face.size() - 1}) {
      const std::int32_t other = face[(n + step) % face.size()];
      if (contains(base, other)) continue;
      if (to >= 0 && to != other) return -1;
      to = other;
    }
  }
  return to;
}

struct Shape {
  CellKind kind;
  List corners;
};

std::size_t count_points(const CellFaces& faces) {
  std::set<std::int32_t> points;
  for (const List& face : faces) points.insert(face.begin(), face.end());
  return points.size();
}

/// A base, seen from within, and what its corners lead to.
std::optional<Shape> swept(const CellFaces& faces, std::size_t base_size, CellKind kind) {
  const auto base = std::ranges::find(faces, base_size, &List::size);
  if (base == faces.end()) return {};
  Shape shape{kind, {base->rbegin(), base->rend()}};
  const List ring = shape.corners;
  const bool is_pointed = kind == CellKind::Pyramid || kind == CellKind::Tetrahedron;
  for (const std::int32_t point : ring) {
    const std::int32_t to = across(faces, *base, point);
    if (to < 0) return {};
    if (!is_pointed || point == ring.front()) shape.corners.push_back(to);
    if (is_pointed && to != shape.corners.back()) return {};
  }
  return shape;
}

Shape polyhedron(const CellFaces& faces) {
  Shape shape{CellKind::Polyhedron, {static_cast<std::int32_t>(faces.size())}};
  for (const List& face : faces) {
    shape.corners.push_back(static_cast<std::int32_t>(face.size()));
    shape.corners.insert(shape.corners.end(), face.begin(), face.end());
  }
  return shape;
}

Shape shape_of(const CellFaces& faces) {
  const auto of_size = [&](std::size_t size) {
    return std::ranges::count(faces, size, &List::size);
  };
  const auto triangles = of_size(3);
  const auto quads = of_size(4);
  const std::size_t points = count_points(faces);
  const bool is_simple = triangles + quads == std::ssize(faces);
  std::optional<Shape> found;
  if (is_simple && triangles == 0 && quads == 6 && points == 8) {
    found = swept(faces, 4, CellKind::Hexahedron);
  } else if (is_simple && triangles == 2 && quads == 3 && points == 6) {
    found = swept(faces, 3, CellKind::Prism);
  } else if (is_simple && triangles == 4 && quads == 1 && points == 5) {
    found = swept(faces, 4, CellKind::Pyramid);
  } else if (is_simple && triangles == 4 && quads == 0 && points == 4) {
    found = swept(faces, 3, CellKind::Tetrahedron);
  }
  return found ? *std::move(found) : polyhedron(faces);
}

/// Whether each edge is run along once in each sense.
bool is_closed(const CellFaces& faces) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const List& face : faces) {
    for (std::size_t n = 0; n < face.size(); ++n) {
      const std::int32_t a = face[n];
      const std::int32_t b = face[(n + 1) % face.size()];
      if (a < b) {
        edges[{a, b}] += 1;
      } else {
        edges[{b, a}] += 1'000'000;
      }
    }
  }
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 1'000'001; });
}

class Reader {
 public:
  explicit Reader(fs::path folder) : folder_(std::move(folder)) {}

  CellZone read() {
    read_points();
    read_faces();
    owner_ = read_labels("owner", faces_.size());
    if (owner_.size() != faces_.size()) {
      throw IoError(fmt::format("{}: has {} labels, but there are {} faces",
                                (folder_ / "owner").string(), owner_.size(), faces_.size()));
    }
    neighbour_ = read_labels("neighbour", faces_.size());
    read_boundary();
    build_cells();
    return std::move(mesh_);
  }

 private:
  void read_points() {
    FoamText text(folder_, "points", "vectorField");
    const std::size_t count = text.begin_list(8);  // "(0 0 0)\n"
    for (std::size_t p = 0; p < count; ++p) {
      text.expect("(");
      Vec3 point;
      for (double& x : point) x = text.real();
      text.expect(")");
      mesh_.points_world.push_back(point);
    }
    text.expect(")");
  }

  void read_faces() {
    FoamText text(folder_, "faces", "faceList");
    const std::size_t count = text.begin_list(8);  // "3(0 1 2)"
    const std::int64_t last = std::ssize(mesh_.points_world) - 1;
    List face;
    for (std::size_t f = 0; f < count; ++f) {
      const std::int64_t corners = text.whole("points of a face", 3, 1 << 16U);
      text.expect("(");
      face.clear();
      for (std::int64_t n = 0; n < corners; ++n) {
        face.push_back(static_cast<std::int32_t>(text.whole("point", 0, last)));
      }
      text.expect(")");
      faces_.add(face);
    }
    text.expect(")");
  }

  /// Cells: each has four faces at least, and each face has two cells at most.
  List read_labels(const char* name, std::size_t most) {
    FoamText text(folder_, name, "labelList");
    const std::size_t count = text.begin_list(2);
    if (count > most) text.refuse(fmt::format("{} labels, but there are {} faces", count, most));
    const std::int64_t last = std::ssize(faces_.first) / 2;
    List labels;
    for (std::size_t n = 0; n < count; ++n) {
      labels.push_back(static_cast<std::int32_t>(text.whole("cell", 0, last)));
      cells_ = std::max(cells_, static_cast<std::size_t>(labels.back()) + 1);
    }
    text.expect(")");
    return labels;
  }

  void read_boundary() {
    FoamText text(folder_, "boundary", "polyBoundaryMesh");
    const std::size_t count = text.begin_list(8);
    for (std::size_t b = 0; b < count; ++b) read_patch(text);
    text.expect(")");
  }

  void read_patch(FoamText& text) {
    CellBoundary boundary{std::string(text.next())};
    text.expect("{");
    const std::int64_t all = std::ssize(faces_.first) - 1;
    std::int64_t faces = 0;
    std::int64_t start = 0;
    for (std::string_view key = text.next(); key != "}"; key = text.next()) {
      if (key == "nFaces") {
        faces = text.whole("nFaces", 0, all);
      } else if (key == "startFace") {
        start = text.whole("startFace", 0, all);
      } else if (key == "type") {
        boundary.type = std::string(text.next());
      }
      while (text.next() != ";") continue;
    }
    if (start + faces > all) {
      text.refuse(fmt::format("patch {}: faces {} to {}, but there are {}", boundary.name, start,
                              start + faces, all));
    }
    for (std::int64_t f = start; f < start + faces; ++f) {
      boundary.faces.add(faces_[static_cast<std::size_t>(f)]);
    }
    mesh_.boundaries.push_back(std::move(boundary));
  }

  void build_cells() {
    std::vector<std::vector<std::int32_t>> of_cell(cells_);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      of_cell[static_cast<std::size_t>(owner_[f])].push_back(static_cast<std::int32_t>(f));
      if (f >= neighbour_.size()) continue;
      of_cell[static_cast<std::size_t>(neighbour_[f])].push_back(-1 - static_cast<std::int32_t>(f));
    }
    std::size_t open = 0;
    for (std::size_t c = 0; c < cells_; ++c) {
      CellFaces faces;
      for (const std::int32_t f : of_cell[c]) {
        const Points points = faces_[static_cast<std::size_t>(f < 0 ? -1 - f : f)];
        faces.emplace_back(points.begin(), points.end());
        if (f < 0) std::ranges::reverse(faces.back());
      }
      const bool closes = is_closed(faces);
      if (!closes && open++ == 0) first_open_ = c;
      const Shape shape = closes ? shape_of(faces) : polyhedron(faces);
      mesh_.add(shape.kind, shape.corners);
    }
    if (open == 0) return;
    mesh_.faults.push_back(
        fmt::format("{} cells whose faces do not close, or run against each other; the first: {}",
                    open, first_open_));
  }

  fs::path folder_;
  PointLists faces_;
  List owner_;
  List neighbour_;
  std::size_t cells_ = 0;
  std::size_t first_open_ = 0;
  CellZone mesh_;
};

fs::path poly_mesh_of(const fs::path& file) {
  std::error_code ignored;
  const fs::path folder = file.extension() == ".foam" ? file.parent_path() : file;
  for (const fs::path& place : {folder / "constant" / "polyMesh", folder / "polyMesh", folder}) {
    if (fs::exists(place / "faces", ignored) || fs::exists(place / "faces.gz", ignored)) {
      return place;
    }
  }
  throw IoError(file.string() +
                ": is no case of OpenFOAM with a mesh: there is no constant/polyMesh/faces in it");
}

}  // namespace

CellZone read_openfoam(const std::filesystem::path& file) {
  return Reader(poly_mesh_of(file)).read();
}

}  // namespace vdb_offset
