// The mapping of structured meshes to CGNS is that of the "CFD General Notation System Standard
// Interface Data Structures" (SIDS), version 3.4.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/parallel.h"
#include "io/cgns_cells.h"
#include "io/cgns_families.h"
#include "io/cgns_output.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {
namespace {

/// Node indices from 1, as begin and end.
std::array<cgsize_t, 6> from_one(const BlockRange& range) {
  std::array<cgsize_t, 6> out{};
  for (std::size_t a = 0; a < 3; ++a) {
    out[a] = range.begin[a] + 1;
    out[a + 3] = range.end[a] + 1;
  }
  return out;
}

class MeshWriter {
 public:
  MeshWriter(CgnsOutput& out, const MultiBlock& mesh) : out_(out), mesh_(mesh), families_(out) {}

  void write() {
    for (const BoundaryFace& face : mesh_.boundary_faces) families_.add(face.name, face.condition);
    for (const Block& block : mesh_.blocks) zone_names_.push_back(out_.name(block.name));
    std::vector<CgnsNames> connectivity(mesh_.blocks.size());
    std::vector<CgnsNames> boundaries(mesh_.blocks.size());
    for (const Block& block : mesh_.blocks) write_zone(block);
    for (const Interface& interface : mesh_.interfaces) {
      write_interface(ascending(interface), connectivity);
      write_interface(ascending(reversed(interface)), connectivity);
    }
    for (const BoundaryFace& face : mesh_.boundary_faces) write_boundary(face, boundaries);
  }

 private:
  void write_zone(const Block& block) {
    std::array<cgsize_t, 9> size{};
    const std::array<int, 3> points{block.ni, block.nj, block.nk};
    for (std::size_t a = 0; a < 3; ++a) {
      size[a] = points[a];
      size[a + 3] = points[a] - 1;
    }
    int zone = 0;
    out_.check(cg_zone_write(out_.file(), out_.base(), zone_names_[zones_.size()].c_str(),
                             size.data(), CGNS_ENUMV(Structured), &zone));
    zones_.push_back(zone);
    write_points(block);
    out_.say_lengths(zone);
  }

  /// Points lie column by column, the file wants them level by level: some rows of columns at a
  /// time, and of them as many levels as it takes to read memory in long runs. Rows hold as many
  /// columns as make long runs in the file too (64 KB, below which HDF5 copies once more).
  void write_points(const Block& block) {
    constexpr int kLevels = 128;
    const auto fitting = [](int most, std::size_t of_one) {
      const std::size_t count = std::max<std::size_t>(1, kCgnsSlab / of_one);
      return static_cast<int>(std::min(count, static_cast<std::size_t>(most)));
    };
    const auto ni = static_cast<std::size_t>(block.ni);
    const int levels = fitting(std::min(block.nk, kLevels), ni);
    const int rows = fitting(block.nj, ni * static_cast<std::size_t>(levels));
    for (int k = 0; k < block.nk; k += levels) {
      for (int j = 0; j < block.nj; j += rows) {
        write_part(block, {j, k}, {std::min(block.nj, j + rows), std::min(block.nk, k + levels)});
      }
    }
  }

  /// Rows and levels from `begin` to before `end`.
  void write_part(const Block& block, const std::array<int, 2>& begin,
                  const std::array<int, 2>& end) {
    const auto at = [](int n) { return static_cast<std::size_t>(n); };
    const int* const nodes = block.columns.data() + at(begin[0]) * at(block.ni);
    const std::size_t columns = at(end[0] - begin[0]) * at(block.ni);
    const std::size_t levels = at(end[1] - begin[1]);
    for (std::vector<double>& values : coordinates_) values.resize(columns * levels);
    constexpr std::size_t kGrain = 256;
    parallel::for_ranges(columns, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t c = first; c < last; ++c) {
        const Vec3* point = &mesh_.layers.at(nodes[c], begin[1]);
        for (std::size_t k = 0; k < levels; ++k, ++point) {
          for (std::size_t a = 0; a < 3; ++a) {
            coordinates_[a][k * columns + c] = (*point)[static_cast<Eigen::Index>(a)];
          }
        }
      }
    });
    out_.write_coordinates(
        zones_.back(), {{1, begin[0] + 1, begin[1] + 1}, {block.ni, end[0], end[1]}, coordinates_});
  }

  void write_interface(const Interface& interface, std::vector<CgnsNames>& names) const {
    const auto zone = static_cast<std::size_t>(interface.first.block);
    const auto donor = static_cast<std::size_t>(interface.second.block);
    const std::string wanted = interface.name.empty() ? "to " + zone_names_[donor] : interface.name;
    const std::string name = names[zone].take(wanted);
    const std::array<cgsize_t, 6> range = from_one(interface.first);
    const std::array<cgsize_t, 6> donor_range = from_one(interface.second);
    int index = 0;
    out_.check(cg_1to1_write(out_.file(), out_.base(), zones_[zone], name.c_str(),
                             zone_names_[donor].c_str(), range.data(), donor_range.data(),
                             interface.transform.data(), &index));
  }

  void write_boundary(const BoundaryFace& face, std::vector<CgnsNames>& names) const {
    const auto block = static_cast<std::size_t>(face.range.block);
    const std::string name = names[block].take(face.name);
    const std::array<cgsize_t, 6> range = from_one(ascending(face.range));
    int index = 0;
    out_.check(cg_boco_write(out_.file(), out_.base(), zones_[block], name.c_str(),
                             cgns_bc_type(cgns_type(face.condition)), CGNS_ENUMV(PointRange), 2,
                             range.data(), &index));
    families_.join(zones_[block], index, face.name, face.condition);
  }

  CgnsOutput& out_;
  const MultiBlock& mesh_;
  CgnsFamilies families_;
  std::vector<std::string> zone_names_;
  std::vector<int> zones_;
  std::array<std::vector<double>, 3> coordinates_;
};

}  // namespace

void write_cgns(const std::filesystem::path& file, const MultiBlock& mesh,
                const CgnsWriteOptions& options) {
  if (!mesh.is_structured()) return write_cgns_cells(file, mesh, options);
  CgnsOutput::Content content{3, 0, mesh.blocks.size(),
                              2 * mesh.interfaces.size() + mesh.boundary_faces.size()};
  for (const Block& block : mesh.blocks) {
    check_cgns_size(file, block.name, block.point_count());
    content.points += block.point_count();
  }
  CgnsOutput out(file, content, options);
  MeshWriter(out, mesh).write();
  out.commit();
}

}  // namespace vdb_offset
