#include "vdb_offset/blocks/check_cells.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "blocks/cell_matching.h"
#include "core/parallel.h"
#include "vdb_offset/blocks/widen_minima.h"

namespace vdb_offset {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The worst of some cells, and what the mean is made of.
struct Sum {
  std::array<QualityMinima, kCellKinds> kinds;
  std::array<double, kCellKinds> scaled_jacobians{};
  std::vector<CellCheck::BadCell> bad = {};
};

/// By the divergence theorem, faces as triangles about their middles.
double polyhedron_volume(const CellZone& mesh, std::size_t cell) {
  const auto point = [&](std::int32_t p) -> const Vec3& {
    return mesh.points_world[static_cast<std::size_t>(p)];
  };
  const Vec3 origin = point(mesh.cells[cell][2]);
  double six_fold = 0;
  for_cell_faces(CellKind::Polyhedron, mesh.cells[cell], [&](std::span<const std::int32_t> face) {
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t p : face) middle += point(p) - origin;
    middle /= static_cast<double>(face.size());
    for (std::size_t n = 0; n < face.size(); ++n) {
      const Vec3 a = point(face[n]) - origin;
      const Vec3 b = point(face[(n + 1) % face.size()]) - origin;
      six_fold += middle.dot(a.cross(b));
    }
  });
  return six_fold / 6;
}

Vec3 middle_of(const CellZone& mesh, std::size_t cell) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for_cell_faces(mesh.kinds[cell], mesh.cells[cell], [&](std::span<const std::int32_t> face) {
    for (const std::int32_t p : face) {
      sum += mesh.points_world[static_cast<std::size_t>(p)];
      ++count;
    }
  });
  return count > 0 ? Vec3(sum / count) : sum;
}

/// The top and the base change places: the mirror image.
std::array<Vec3, 8> corners_of(const CellZone& mesh, std::size_t cell, bool mirrored) {
  const std::array<std::int32_t, 8> corners = as_hexahedron(mesh.kinds[cell], mesh.cells[cell]);
  std::array<Vec3, 8> out;
  for (std::size_t n = 0; n < 8; ++n) {
    out[mirrored ? n ^ 4U : n] = mesh.points_world[static_cast<std::size_t>(corners[n])];
  }
  return out;
}

void judge_cell(const CellZone& mesh, std::size_t cell, const Mirrored& mirrored, Sum& sum) {
  const auto kind = static_cast<std::size_t>(mesh.kinds[cell]);
  QualityMinima one;
  one.cells = 1;
  if (mesh.kinds[cell] == CellKind::Polyhedron) {
    one.min_volume = (mirrored[kind] ? -1 : 1) * polyhedron_volume(mesh, cell);
    one.nonpositive_cells = one.min_volume > 0 ? 0 : 1;
  } else {
    const std::array<Vec3, 8> corners = corners_of(mesh, cell, mirrored[kind]);
    const CellQuality quality = cell_quality(corners);
    const CellShape shape = cell_shape(corners);
    one.nonpositive_cells = quality.positive ? 0 : 1;
    one.min_scaled_jacobian = quality.scaled_jacobian;
    one.min_jacobian = quality.min_jacobian;
    one.min_volume = quality.volume;
    one.max_skewness = shape.skewness;
    one.max_aspect_ratio = shape.aspect_ratio;
    sum.scaled_jacobians[kind] += quality.scaled_jacobian;
  }
  widen(one, sum.kinds[kind]);
  if (one.nonpositive_cells > 0 && sum.bad.size() < kMostListed) {
    sum.bad.push_back(
        {static_cast<std::int32_t>(cell), one.min_scaled_jacobian, middle_of(mesh, cell)});
  }
}

/// In pieces of one size, added in order: the same for any number of threads.
Sum judge_all(const CellZone& mesh, const Mirrored& mirrored, const Progress& progress) {
  constexpr std::size_t kPiece = 4096;
  const std::size_t cells = mesh.kinds.size();
  std::vector<Sum> pieces((cells + kPiece - 1) / kPiece);
  parallel::for_ranges(
      {progress, "check"}, pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin * kPiece; c < std::min(cells, end * kPiece); ++c) {
          judge_cell(mesh, c, mirrored, pieces[c / kPiece]);
        }
      });
  Sum all;
  for (const Sum& piece : pieces) {
    for (std::size_t kind = 0; kind < kCellKinds; ++kind) {
      widen(piece.kinds[kind], all.kinds[kind]);
      all.scaled_jacobians[kind] += piece.scaled_jacobians[kind];
    }
    const std::size_t room = std::min(kMostListed - all.bad.size(), piece.bad.size());
    all.bad.insert(all.bad.end(), piece.bad.begin(),
                   piece.bad.begin() + static_cast<std::ptrdiff_t>(room));
  }
  return all;
}

void add_faults(std::vector<MeshFault> faults, CellCheck& check) {
  for (MeshFault& fault : faults) {
    ++check.fault_count;
    if (check.faults.size() < kMostListed) check.faults.push_back(std::move(fault));
  }
}

/// Kinds of which most cells are not positive, but are in the mirror.
Mirrored find_mirrored(const CellZone& mesh, const Sum& plain, const Progress& progress) {
  Mirrored mirrored{};
  bool is_any = false;
  for (std::size_t kind = 0; kind < kCellKinds; ++kind) {
    mirrored[kind] = 2 * plain.kinds[kind].nonpositive_cells > plain.kinds[kind].cells;
    is_any = is_any || mirrored[kind];
  }
  if (!is_any) return mirrored;
  const Sum other = judge_all(mesh, mirrored, progress);
  for (std::size_t kind = 0; kind < kCellKinds; ++kind) {
    mirrored[kind] =
        mirrored[kind] && other.kinds[kind].nonpositive_cells < plain.kinds[kind].nonpositive_cells;
  }
  return mirrored;
}

/// What holds for all cells; of polyhedra only volumes and numbers.
void sum_up(const Sum& sum, CellCheck& check) {
  constexpr auto kPolyhedron = static_cast<std::size_t>(CellKind::Polyhedron);
  check.kinds = sum.kinds;
  check.nonpositive = sum.bad;
  double scaled_jacobians = 0;
  for (std::size_t kind = 0; kind < kPolyhedron; ++kind) {
    widen(sum.kinds[kind], check.quality);
    scaled_jacobians += sum.scaled_jacobians[kind];
  }
  if (check.quality.cells > 0) {
    check.mean_scaled_jacobian = scaled_jacobians / static_cast<double>(check.quality.cells);
  }
  const QualityMinima& polyhedra = sum.kinds[kPolyhedron];
  if (polyhedra.cells == 0) return;
  const double volume = check.quality.cells > 0 ? check.quality.min_volume : kInfinity;
  check.quality.min_volume = std::min(volume, polyhedra.min_volume);
  check.quality.cells += polyhedra.cells;
  check.quality.nonpositive_cells += polyhedra.nonpositive_cells;
}

}  // namespace

CellCheck check_cells(const CellZone& mesh, const Progress& progress) {
  CellCheck check;
  for (const std::string& text : mesh.faults) {
    add_faults({{FaultKind::Unreadable, text}}, check);
  }
  Sum sum = judge_all(mesh, {}, progress);
  const Mirrored mirrored = find_mirrored(mesh, sum, progress);
  if (std::ranges::count(mirrored, true) > 0) sum = judge_all(mesh, mirrored, progress);
  for (std::size_t kind = 0; kind < kCellKinds; ++kind) {
    if (!mirrored[kind] || kind == static_cast<std::size_t>(CellKind::Prism)) continue;
    add_faults(
        {{FaultKind::LeftHanded, fmt::format("{} are left-handed: base and top are exchanged",
                                             name_of(static_cast<CellKind>(kind)))}},
        check);
  }
  sum_up(sum, check);
  progress.check();
  add_faults(match_faces(mesh, mirrored, check), check);
  add_faults(find_unused(mesh), check);
  return check;
}

}  // namespace vdb_offset
