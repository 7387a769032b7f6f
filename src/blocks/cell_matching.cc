// Faces are grouped by their lowest point: a counting sort, 8 bytes a face, and groups of a few.

#include "blocks/cell_matching.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>

namespace vdb_offset {
namespace {

using Points = std::span<const std::int32_t>;

/// A face of a cell, or of a boundary.
struct FaceUse {
  std::int32_t owner;  ///< cell; -1 - n: of boundary n
  std::int32_t face;   ///< in it
};

/// A use with its points, from the lowest on, and the same sorted.
struct Listed {
  FaceUse use{};
  std::vector<std::int32_t> around;
  std::vector<std::int32_t> sorted;
};

template <typename Visit>
void for_uses(const CellZone& mesh, const Visit& visit) {
  for (std::size_t c = 0; c < mesh.kinds.size(); ++c) {
    std::int32_t face = 0;
    for_cell_faces(mesh.kinds[c], mesh.cells[c], [&](Points points) {
      visit(FaceUse{static_cast<std::int32_t>(c), face++}, points);
    });
  }
  for (std::size_t b = 0; b < mesh.boundaries.size(); ++b) {
    const PointLists& faces = mesh.boundaries[b].faces;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      visit(FaceUse{-1 - static_cast<std::int32_t>(b), static_cast<std::int32_t>(f)}, faces[f]);
    }
  }
}

Listed listed(const CellZone& mesh, const FaceUse& use) {
  Listed out{use, {}, {}};
  const auto keep = [&](Points points) { out.around.assign(points.begin(), points.end()); };
  if (use.owner < 0) {
    keep(mesh.boundaries[static_cast<std::size_t>(-1 - use.owner)]
             .faces[static_cast<std::size_t>(use.face)]);
  } else {
    const auto c = static_cast<std::size_t>(use.owner);
    std::int32_t face = 0;
    for_cell_faces(mesh.kinds[c], mesh.cells[c], [&](Points points) {
      if (face++ == use.face) keep(points);
    });
  }
  std::ranges::rotate(out.around, std::ranges::min_element(out.around));
  out.sorted = out.around;
  std::ranges::sort(out.sorted);
  return out;
}

/// What was found wrong of one kind: how often, and the first place.
struct Found {
  std::uint64_t count = 0;
  std::string first = {};
};

class Matching {
 public:
  Matching(const CellZone& mesh, const Mirrored& mirrored, CellCheck& check)
      : mesh_(mesh), mirrored_(mirrored), check_(check) {}

  std::vector<MeshFault> run() {
    group();
    std::vector<Listed> faces;
    for (std::size_t p = 0; p + 1 < first_.size(); ++p) {
      faces.clear();
      for (std::size_t n = first_[p]; n < first_[p + 1]; ++n) {
        faces.push_back(listed(mesh_, uses_[n]));
      }
      std::ranges::stable_sort(faces, {}, &Listed::sorted);
      for (std::size_t begin = 0; begin < faces.size();) {
        std::size_t end = begin + 1;
        while (end < faces.size() && faces[end].sorted == faces[begin].sorted) ++end;
        judge({faces.data() + begin, end - begin});
        begin = end;
      }
    }
    return report();
  }

 private:
  void group() {
    first_.assign(mesh_.points_world.size() + 1, 0);
    const auto lowest = [](Points points) {
      return static_cast<std::size_t>(*std::ranges::min_element(points));
    };
    for_uses(mesh_, [&](FaceUse, Points points) { ++first_[lowest(points)]; });
    std::size_t sum = 0;
    for (std::size_t& n : first_) sum += std::exchange(n, sum);
    uses_.resize(sum);
    for_uses(mesh_, [&](FaceUse use, Points points) { uses_[first_[lowest(points)]++] = use; });
    for (std::size_t p = first_.size() - 1; p > 0; --p) first_[p] = first_[p - 1];
    first_[0] = 0;
  }

  std::string words(const Listed& face) const {
    const std::string of =
        face.use.owner < 0
            ? "boundary '" + mesh_.boundaries[static_cast<std::size_t>(-1 - face.use.owner)].name +
                  "'"
            : fmt::format("cell {}", face.use.owner);
    return fmt::format("{}, points {}", of, fmt::join(face.around, " "));
  }

  void add(FaultKind kind, const std::string& where) {
    Found& found = found_[kind];
    if (found.count++ == 0) found.first = where;
  }

  bool is_mirrored(const Listed& face) const {
    const CellKind kind = mesh_.kinds[static_cast<std::size_t>(face.use.owner)];
    return mirrored_[static_cast<std::size_t>(kind)];
  }

  /// All uses of one face.
  void judge(std::span<const Listed> faces) {
    const auto cells = static_cast<std::size_t>(
        std::ranges::count_if(faces, [](const Listed& face) { return face.use.owner >= 0; }));
    const std::size_t boundaries = faces.size() - cells;
    if (cells == 1 && boundaries == 1) {
      ++check_.boundary_faces;
    } else if (cells == 2 && boundaries == 0) {
      ++check_.inner_faces;
      std::vector<std::int32_t> back = faces[1].around;
      if (is_mirrored(faces[0]) == is_mirrored(faces[1])) {
        std::reverse(back.begin() + 1, back.end());
      }
      if (back != faces[0].around) {
        add(FaultKind::Misoriented,
            words(faces[0]) + fmt::format(", and cell {}", faces[1].use.owner));
      }
    } else if (cells == 1 && boundaries == 0) {
      note_uncovered(faces[0]);
    } else if (cells == 0 && boundaries == 1) {
      add(FaultKind::Range, words(faces[0]));
    } else {
      add(FaultKind::DoublyCovered,
          words(faces[0]) + fmt::format(": {} cells, {} boundaries", cells, boundaries));
    }
  }

  /// Of two in one place each is a gap's side, points that should be one.
  void note_uncovered(const Listed& face) {
    std::vector<std::array<double, 3>> place;
    for (const std::int32_t p : face.around) {
      const Vec3& x = mesh_.points_world[static_cast<std::size_t>(p)];
      place.push_back({x.x(), x.y(), x.z()});
    }
    std::ranges::sort(place);
    const auto [at, is_new] = uncovered_.try_emplace(std::move(place), words(face));
    if (is_new) return;
    if (!mesh_.names_boundaries) {
      ++check_.coincident_pairs;
    } else {
      add(FaultKind::Gap, at->second + ", and " + words(face));
    }
    uncovered_.erase(at);
  }

  /// Triangles that lie on half of a quad: the cells behind do not match.
  void find_halves() {
    for (const auto& [place, where] : uncovered_) {
      for (std::size_t left_out = 0; place.size() == 4 && left_out < 4; ++left_out) {
        auto half = place;
        half.erase(half.begin() + static_cast<std::ptrdiff_t>(left_out));
        const auto found = uncovered_.find(half);
        if (found != uncovered_.end()) add(FaultKind::Gap, where + ", and " + found->second);
      }
    }
  }

  std::vector<MeshFault> report() {
    if (!mesh_.names_boundaries) {
      check_.boundary_faces += uncovered_.size() + 2 * check_.coincident_pairs;
      find_halves();
    } else {
      for (const auto& [place, where] : uncovered_) add(FaultKind::Uncovered, where);
    }
    const auto text = [](FaultKind kind) {
      switch (kind) {
        case FaultKind::Range:
          return "faces of boundaries that no cell has";
        case FaultKind::Uncovered:
          return "faces of one cell, in no boundary";
        case FaultKind::DoublyCovered:
          return "faces of more than two cells, or of cells and boundaries";
        case FaultKind::Gap:
          return "pairs of faces in one place that are not one face: an interface is missing";
        default:
          return "faces that both cells see from one side";
      }
    };
    std::vector<MeshFault> out;
    for (const auto& [kind, found] : found_) {
      MeshFault fault;
      fault.kind = kind;
      fault.count = found.count;
      fault.text = fmt::format("{} {}; the first: {}", found.count, text(kind), found.first);
      out.push_back(std::move(fault));
    }
    return out;
  }

  const CellZone& mesh_;
  const Mirrored& mirrored_;
  CellCheck& check_;
  std::vector<std::size_t> first_;  // use of each point, and the end
  std::vector<FaceUse> uses_;
  std::map<FaultKind, Found> found_;
  std::map<std::vector<std::array<double, 3>>, std::string> uncovered_;
};

}  // namespace

std::vector<MeshFault> match_faces(const CellZone& mesh, const Mirrored& mirrored,
                                   CellCheck& check) {
  return Matching(mesh, mirrored, check).run();
}

std::vector<MeshFault> find_unused(const CellZone& mesh) {
  std::vector<char> used(mesh.points_world.size(), 0);
  for (std::size_t c = 0; c < mesh.kinds.size(); ++c) {
    for_cell_faces(mesh.kinds[c], mesh.cells[c], [&](Points points) {
      for (const std::int32_t p : points) used[static_cast<std::size_t>(p)] = 1;
    });
  }
  const auto count = static_cast<std::uint64_t>(std::ranges::count(used, 0));
  if (count == 0) return {};
  MeshFault fault;
  fault.kind = FaultKind::Unused;
  fault.count = count;
  fault.text = fmt::format("{} points that no cell has; the first: {}", count,
                           std::ranges::find(used, 0) - used.begin());
  return {fault};
}

}  // namespace vdb_offset
