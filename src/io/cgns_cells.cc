// Unstructured zones as the SIDS has them: elements numbered through all sections, those of the
// cells first, then faces, to which the BCs refer.

#include "io/cgns_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/cell_mesh.h"
#include "io/cgns_families.h"
#include "io/cgns_output.h"
#include "io/linear_cell.h"

namespace vdb_offset {
namespace {

using Connectivity = std::vector<cgsize_t>;

/// Elements of one type.
struct Section {
  std::string name;
  ElementType_t type;
  std::size_t corners;
  Connectivity points = {};  // from 1

  cgsize_t count() const { return static_cast<cgsize_t>(points.size() / corners); }
};

class CellsWriter {
 public:
  CellsWriter(CgnsOutput& out, const MultiBlock& mesh, const CellMesh& cells)
      : out_(out), mesh_(mesh), cells_(cells), families_(out) {}

  void write() {
    for (const CellPatch& patch : cells_.patches()) families_.add(patch.name, patch.condition);
    write_zone();
    for (int block = 0; block < static_cast<int>(mesh_.blocks.size()); ++block) {
      write_block(block);
    }
    for (const CellPatch& patch : cells_.patches()) write_patch(patch);
  }

 private:
  void write_zone() {
    const std::array<cgsize_t, 3> size{cells_.points(), cells_.cells(), 0};
    out_.check(cg_zone_write(out_.file(), out_.base(), out_.name("layers").c_str(), size.data(),
                             CGNS_ENUMV(Unstructured), &zone_));
    std::array<std::vector<double>, 3> coordinates;
    cgsize_t first = 1;
    const auto send = [&] {
      const auto count = static_cast<cgsize_t>(coordinates[0].size());
      if (count == 0) return;
      out_.write_coordinates(zone_, {{first, 1, 1}, {first + count - 1, 1, 1}, coordinates});
      first += count;
      for (std::vector<double>& values : coordinates) values.clear();
    };
    cells_.for_points([&](const Vec3& p) {
      for (std::size_t a = 0; a < 3; ++a) {
        coordinates[a].push_back(p[static_cast<Eigen::Index>(a)]);
      }
      if (coordinates[0].size() == kCgnsSlab) send();
    });
    send();
    out_.say_lengths(zone_);
  }

  /// A section for each kind of cell.
  void write_block(int block) {
    const std::string name = mesh_.blocks[static_cast<std::size_t>(block)].name;
    std::array<Section, 4> sections{{{name + " TETRA_4", CGNS_ENUMV(TETRA_4), 4},
                                     {name + " PYRA_5", CGNS_ENUMV(PYRA_5), 5},
                                     {name + " PENTA_6", CGNS_ENUMV(PENTA_6), 6},
                                     {name + " HEXA_8", CGNS_ENUMV(HEXA_8), 8}}};
    cells_.for_cells_of(block, [&](const CellMesh::Place& place) {
      const LinearCell cell = linear_cell(cells_.corners(block, place));
      Connectivity& points = sections[static_cast<std::size_t>(cell.kind)].points;
      for (const std::int32_t point : cell.points()) points.push_back(point + 1);
    });
    for (const Section& section : sections) write_section(section);
  }

  void write_section(const Section& section) {
    if (section.points.empty()) return;
    int index = 0;
    out_.check(cg_section_write(out_.file(), out_.base(), zone_, names_.take(section.name).c_str(),
                                section.type, next_, next_ + section.count() - 1, 0,
                                section.points.data(), &index));
    next_ += section.count();
  }

  void write_patch(const CellPatch& patch) {
    std::array<Section, 2> sections{{{patch.name + " TRI_3", CGNS_ENUMV(TRI_3), 3},
                                     {patch.name + " QUAD_4", CGNS_ENUMV(QUAD_4), 4}}};
    for (const BlockRange& range : patch.ranges) {
      cells_.for_cells_behind(range, [&](int block, const CellMesh::Place& place, BlockFace of) {
        const Polygon face = polygons(cells_.corners(block, place))[static_cast<std::size_t>(of)];
        if (!face.has_area()) return;
        Connectivity& points = sections[face.count == 3 ? 0 : 1].points;
        for (int c = 0; c < face.count; ++c) {
          points.push_back(face.points[static_cast<std::size_t>(c)] + 1);
        }
      });
    }
    std::array<cgsize_t, 2> range{next_, next_};
    for (const Section& section : sections) write_section(section);
    range[1] = next_ - 1;
    int index = 0;
    out_.check(cg_boco_write(out_.file(), out_.base(), zone_, boundaries_.take(patch.name).c_str(),
                             cgns_bc_type(cgns_type(patch.condition)), CGNS_ENUMV(PointRange), 2,
                             range.data(), &index));
    out_.check(
        cg_boco_gridlocation_write(out_.file(), out_.base(), zone_, index, CGNS_ENUMV(FaceCenter)));
    families_.join(zone_, index, patch.name, patch.condition);
  }

  CgnsOutput& out_;
  const MultiBlock& mesh_;
  const CellMesh& cells_;
  CgnsFamilies families_;
  CgnsNames names_;
  CgnsNames boundaries_;
  int zone_ = 0;
  cgsize_t next_ = 1;
};

}  // namespace

void write_cgns_cells(const std::filesystem::path& file, const MultiBlock& mesh,
                      const CgnsWriteOptions& options) {
  const CellMesh cells(mesh);
  const auto points = static_cast<std::size_t>(cells.points());
  check_cgns_size(file, "layers", points);
  CgnsOutput out(file, {3, points, 1, cells.patches().size()}, options);
  CellsWriter(out, mesh, cells).write();
  out.commit();
}

}  // namespace vdb_offset
