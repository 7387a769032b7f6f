// polyMesh as the OpenFOAM user guide describes it: faces with an owner and, inside, a neighbour.

#include "vdb_offset/io/openfoam.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/openfoam_case.h"
#include "io/output_file.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

/// OpenFOAM ends the run when two unit normals of a symmetryPlane differ by more than the root of
/// 1e-15; a tenth of it.
constexpr double kFlatNormals = 3e-9;

constexpr std::array<BlockFace, 6> kFaces{BlockFace::IMin, BlockFace::IMax, BlockFace::JMin,
                                          BlockFace::JMax, BlockFace::KMin, BlockFace::KMax};

/// A list file: header, count, items between brackets; text is sent in pieces.
class ListFile {
 public:
  ListFile(const std::filesystem::path& file, const std::string& kind, std::int64_t count,
           const std::string& note = "")
      : file_(file) {
    const std::string head = openfoam_header(kind, "constant/polyMesh", file.filename().string());
    // The note stands in the header, where OpenFOAM's own files have it.
    const std::size_t end = head.find('}');
    file_.stream() << head.substr(0, end)
                   << (note.empty() ? "" : "    note        \"" + note + "\";\n")
                   << head.substr(end) << count << "\n(\n";
  }

  template <typename... Values>
  void put(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), form, std::forward<Values>(values)...);
    constexpr std::size_t kPiece = std::size_t{1} << 16U;
    if (buffer_.size() >= kPiece) flush();
  }

  void commit() {
    put(")\n");
    flush();
    file_.commit();
  }

 private:
  void flush() {
    file_.stream().write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

  OutputFile file_;
  fmt::memory_buffer buffer_;
};

/// A face inside, seen from its owner.
struct InternalFace {
  std::int32_t neighbour;
  Polygon polygon;
};

/// Those that a cell owns, by neighbour.
class OwnedFaces {
 public:
  explicit OwnedFaces(const CellMesh& cells) : cells_(cells) {}

  const std::vector<InternalFace>& of(int block, const CellMesh::Place& place) {
    const std::int32_t owner = cells_.cell(block, place);
    const std::array<Polygon, 6> faces = polygons(cells_.corners(block, place));
    owned_.clear();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const std::int32_t neighbour = cells_.beyond(block, place, kFaces[f]);
      if (neighbour > owner && faces[f].has_area()) owned_.push_back({neighbour, faces[f]});
    }
    std::ranges::sort(owned_, {}, &InternalFace::neighbour);
    return owned_;
  }

 private:
  const CellMesh& cells_;
  std::vector<InternalFace> owned_;
};

/// `visit(owner, polygon)` for each face of a patch.
template <typename Visit>
void for_faces(const CellMesh& cells, const CellPatch& patch, const Visit& visit) {
  for (const BlockRange& range : patch.ranges) {
    cells.for_cells_behind(range, [&](int block, const CellMesh::Place& place, BlockFace of) {
      const Polygon face = polygons(cells.corners(block, place))[static_cast<std::size_t>(of)];
      if (face.has_area()) visit(cells.cell(block, place), face);
    });
  }
}

struct Counts {
  std::int64_t internal = 0;
  std::int64_t faces = 0;
};

Counts count(const CellMesh& cells) {
  Counts out;
  OwnedFaces owned(cells);
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    out.internal += std::ssize(owned.of(block, place));
  });
  out.faces = out.internal;
  for (const CellPatch& patch : cells.patches()) out.faces += patch.faces;
  if (out.faces > std::numeric_limits<std::int32_t>::max()) {
    throw LimitError(
        fmt::format("{} faces are more than OpenFOAM's labels can number (2^31 - 1); "
                    "write CGNS",
                    out.faces));
  }
  return out;
}

void write_points(const std::filesystem::path& file, const CellMesh& cells) {
  ListFile points(file, "vectorField", cells.points());
  // The shortest text that brings back every double.
  cells.for_points([&](const Vec3& p) { points.put("({} {} {})\n", p.x(), p.y(), p.z()); });
  points.commit();
}

void put_face(ListFile& faces, const Polygon& face) {
  const std::array<std::int32_t, 4>& p = face.points;
  if (face.count == 4) {
    faces.put("4({} {} {} {})\n", p[0], p[1], p[2], p[3]);
  } else {
    faces.put("3({} {} {})\n", p[0], p[1], p[2]);
  }
}

void write_faces(const OutputFolder& folder, const CellMesh& cells, const Counts& counts) {
  const std::string note =
      fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", cells.points(),
                  cells.cells(), counts.faces, counts.internal);
  ListFile faces(folder.piece("faces"), "faceList", counts.faces);
  ListFile owner(folder.piece("owner"), "labelList", counts.faces, note);
  ListFile neighbour(folder.piece("neighbour"), "labelList", counts.internal, note);
  OwnedFaces owned(cells);
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    const std::int32_t cell = cells.cell(block, place);
    for (const InternalFace& face : owned.of(block, place)) {
      put_face(faces, face.polygon);
      owner.put("{}\n", cell);
      neighbour.put("{}\n", face.neighbour);
    }
  });
  for (const CellPatch& patch : cells.patches()) {
    for_faces(cells, patch, [&](std::int32_t cell, const Polygon& face) {
      put_face(faces, face);
      owner.put("{}\n", cell);
    });
  }
  faces.commit();
  owner.commit();
  neighbour.commit();
}

/// The corners of a cell's face, counter-clockwise seen from outside.
std::array<Vec3, 4> face_points(const MultiBlock& mesh, int block, const CellMesh::Place& at,
                                BlockFace face) {
  const std::array<int, 4> ring = mesh.blocks[static_cast<std::size_t>(block)].stack(at[0], at[1]);
  if (axis_of(face) == 2) {
    const int k = at[2] + (is_max(face) ? 1 : 0);
    const bool is_outer = is_max(face);
    return {mesh.layers.at(ring[0], k), mesh.layers.at(ring[is_outer ? 1 : 3], k),
            mesh.layers.at(ring[2], k), mesh.layers.at(ring[is_outer ? 3 : 1], k)};
  }
  const auto side =
      static_cast<std::size_t>(std::ranges::find(kSideFaces, face) - kSideFaces.begin());
  const int from = ring[side];
  const int to = ring[(side + 1) % 4];
  return {mesh.layers.at(from, at[2]), mesh.layers.at(to, at[2]), mesh.layers.at(to, at[2] + 1),
          mesh.layers.at(from, at[2] + 1)};
}

/// Whether OpenFOAM finds all of a patch's normals equal.
bool is_planar(const MultiBlock& mesh, const CellMesh& cells, const CellPatch& patch) {
  Vec3 first = Vec3::Zero();
  bool is_flat = true;
  for (const BlockRange& range : patch.ranges) {
    cells.for_cells_behind(range, [&](int block, const CellMesh::Place& at, BlockFace of) {
      const std::array<Vec3, 4> corner = face_points(mesh, block, at, of);
      const Vec3 area = (corner[2] - corner[0]).cross(corner[3] - corner[1]);
      if (area.squaredNorm() == 0) return;
      const Vec3 normal = area.normalized();
      if (first.isZero()) first = normal;
      is_flat = is_flat && (normal - first).norm() <= kFlatNormals;
    });
  }
  return is_flat;
}

std::string_view type_of(const MultiBlock& mesh, const CellMesh& cells, const CellPatch& patch) {
  switch (patch.condition.kind) {
    case ConditionKind::Wall:
      return "wall";
    case ConditionKind::Symmetry:
      if (patch.is_flat_side) return "empty";
      return is_planar(mesh, cells, patch) ? "symmetryPlane" : "symmetry";
    default:
      return "patch";
  }
}

void write_boundary(const std::filesystem::path& file, const MultiBlock& mesh,
                    const CellMesh& cells, std::int64_t first_face) {
  ListFile out(file, "polyBoundaryMesh", std::ssize(cells.patches()));
  for (const CellPatch& patch : cells.patches()) {
    const std::string_view type = type_of(mesh, cells, patch);
    out.put("    {}\n    {{\n        type            {};\n", patch.name, type);
    if (type == "patch" && patch.condition.kind != ConditionKind::Unspecified) {
      out.put("        physicalType    {};\n", describe(patch.condition));
    }
    out.put("        nFaces          {};\n        startFace       {};\n    }}\n", patch.faces,
            first_face);
    first_face += patch.faces;
  }
  out.commit();
}

}  // namespace

std::filesystem::path openfoam_place(const std::filesystem::path& file) {
  const OpenfoamCase openfoam(file);
  openfoam.check();
  return openfoam.poly_mesh().folder;
}

void write_openfoam(const std::filesystem::path& file, const MultiBlock& mesh) {
  const OpenfoamCase openfoam(file);
  openfoam.check();
  const CellMesh cells(mesh);
  const Counts counts = count(cells);
  NewFolders folders;
  folders.make(openfoam.folder);
  folders.make(openfoam.folder / "constant");
  folders.make(openfoam.folder / "system");
  OutputFolder poly_mesh(openfoam.poly_mesh());
  write_points(poly_mesh.piece("points"), cells);
  write_faces(poly_mesh, cells, counts);
  write_boundary(poly_mesh.piece("boundary"), mesh, cells, counts.internal);
  poly_mesh.swap_in();
  openfoam.write_rest();
  poly_mesh.commit();
  folders.keep();
}

}  // namespace vdb_offset
