#include "vdb_offset/io/vdb.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tree/LeafManager.h>

#include <cmath>
#include <cstddef>
#include <streambuf>
#include <string>
#include <vector>

#include "io/output_file.h"
#include "io/vdb_grids.h"
#include "vdb_offset/core/version.h"

namespace vdb_offset {
namespace {

/// OpenVDB's own File does not notice a full disk; this one writes the same bytes to our stream,
/// which does.
class StreamArchive : public openvdb::io::Archive {
 public:
  using openvdb::io::Archive::write;
};

/// Whether the space beyond the band lies in front of the wall, as a level set must have it: tells
/// a body from a duct by the band's outermost voxel.
bool outside_is_positive(const openvdb::FloatTree& tree) {
  openvdb::Coord first = openvdb::Coord::max();
  float value = 0;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    if (leaf->origin().x() > first.x()) continue;
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
      if (voxel.getCoord() < first) {
        first = voxel.getCoord();
        value = *voxel;
      }
    }
  }
  return value >= 0;
}

void describe(openvdb::GridBase& grid, const std::string& name) {
  grid.setName(name);
  grid.setCreator(std::string("vdb-offset ") + kVersion);
}

/// A duct filled on both sides: turned round it is a body, as level sets are.
bool is_inside_out(const DistanceField& field) {
  return field.closed && field.both_sides && !outside_is_positive(field.phi->tree());
}

/// Every value becomes `change(value)`.
template <typename Change>
void change_values(openvdb::FloatTree& tree, const Change& change) {
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(tree);
  leaves.foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
    float* values = leaf.buffer().data();
    for (openvdb::Index n = 0; n < leaf.SIZE; ++n) values[n] = change(values[n]);
  });
  auto tile = tree.beginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) tile.setValue(change(*tile));
}

/// Whether sweep() left it as a file needs it: signed, positive far away, filled with `background`.
bool is_level_set(const DistanceField& field, float background) {
  return field.closed && field.phi->getGridClass() == openvdb::GRID_LEVEL_SET &&
         field.phi->background() == background && outside_is_positive(field.phi->tree());
}

/// May take over the tree of `field`, which is of no use afterwards.
openvdb::FloatGrid::Ptr phi_grid(DistanceField& field) {
  const auto background = static_cast<float>(field.background_world);
  const bool inside_out = is_inside_out(field);
  if (is_level_set(field, background)) {
    // The field's own tree, which nobody changes: a copy would double the memory.
    const auto tree = std::const_pointer_cast<openvdb::FloatTree>(field.phi->treePtr());
    auto grid = openvdb::FloatGrid::create(tree);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    return grid;
  }
  const bool sole_owner = field.phi.use_count() == 1 && field.phi->isTreeUnique();
  openvdb::FloatGrid::Ptr grid =
      sole_owner ? std::const_pointer_cast<openvdb::FloatGrid>(field.phi) : field.phi->deepCopy();
  grid->clearMetadata();
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  if (!field.closed) change_values(grid->tree(), [](float v) { return std::abs(v); });
  if (inside_out) change_values(grid->tree(), [](float v) { return -v; });
  openvdb::tools::changeBackground(grid->tree(), background);
  if (field.closed && outside_is_positive(grid->tree())) {
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    openvdb::tools::signedFloodFillWithValues(grid->tree(), background, -background);
  }
  return grid;
}

openvdb::points::PointDataGrid::Ptr level_grid(const DistanceField& field, const Layers& layers) {
  std::vector<openvdb::Vec3d> points;
  points.reserve(layers.stop.size());
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    const Vec3& p = layers.at(static_cast<int>(n), layers.levels() - 1);
    points.emplace_back(p.x(), p.y(), p.z());
  }
  const auto transform = openvdb::math::Transform::createLinearTransform(field.voxel_world);
  auto grid =
      openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                           openvdb::points::PointDataGrid>(points, *transform);
  describe(*grid, "level");
  return grid;
}

openvdb::GridPtrVec make_grids(DistanceField& field, const Layers* layers,
                               const VdbWriteOptions& options, const Progress& progress) {
  openvdb::GridPtrVec grids;
  const auto made = [&](const openvdb::GridBase::Ptr& grid, const char* name) {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(field.voxel_world));
    describe(*grid, name);
    grid->setSaveFloatAsHalf(options.half && !grid->isType<openvdb::Int32Grid>());
    return grid;
  };
  if (options.normal) {
    grids.push_back(
        made(normal_grid(field, is_inside_out(field) ? -1.0F : 1.0F, progress), "normal"));
  }
  if (options.feature_of != nullptr) {
    grids.push_back(made(feature_grid(field, options, progress), "feature"));
  }
  // Made last, because it may take the tree; first in the file, because programs read that one.
  if (options.phi) grids.insert(grids.begin(), made(phi_grid(field), "phi"));
  if (layers != nullptr) grids.push_back(level_grid(field, *layers));
  return grids;
}

/// Passes on what is written until that is cancelled, and then fails.
class CancelledBuffer : public std::streambuf {
 public:
  CancelledBuffer(std::streambuf& to, const Progress& progress) : to_(to), progress_(progress) {}

 protected:
  int_type overflow(int_type c) override {
    if (progress_.cancelled()) return traits_type::eof();
    return to_.sputc(traits_type::to_char_type(c));
  }
  std::streamsize xsputn(const char* data, std::streamsize count) override {
    return progress_.cancelled() ? 0 : to_.sputn(data, count);
  }
  pos_type seekoff(off_type off, std::ios_base::seekdir way, std::ios_base::openmode how) override {
    return to_.pubseekoff(off, way, how);
  }
  pos_type seekpos(pos_type place, std::ios_base::openmode how) override {
    return to_.pubseekpos(place, how);
  }
  int sync() override { return to_.pubsync(); }

 private:
  std::streambuf& to_;
  const Progress& progress_;
};

}  // namespace

void check_vdb_limits(const std::filesystem::path& file, double voxel_world, double reach_world,
                      bool half) {
  if (!(voxel_world >= kLeastVdbVoxel)) {
    throw IoError(fmt::format(
        "{}: OpenVDB holds no voxels below {:g}, and these are {:g}; enlarge everything with "
        "--scale, or give a larger --voxel",
        file.string(), kLeastVdbVoxel, voxel_world));
  }
  constexpr double kLargestHalf = 65504;
  if (half && !(reach_world <= kLargestHalf)) {
    throw IoError(fmt::format(
        "{}: distances reach {:g}, beyond the {:g} of 16-bit floats; leave out --half, or use "
        "--scale",
        file.string(), reach_world, kLargestHalf));
  }
}

void write_vdb(const std::filesystem::path& file, DistanceField field, const Layers* layers,
               const VdbWriteOptions& options, const Progress& progress) {
  check_vdb_limits(file, field.voxel_world, field.background_world, options.half);
  OutputFile output(file);
  CancelledBuffer buffer(*output.stream().rdbuf(), progress);
  std::ostream stream(&buffer);
  try {
    openvdb::initialize();
    const openvdb::GridPtrVec made = make_grids(field, layers, options, progress);
    const openvdb::GridCPtrVec grids(made.begin(), made.end());
    StreamArchive().write(stream, grids, /*seekable=*/true);
  } catch (const openvdb::Exception& error) {
    progress.check();
    throw IoError(file.string() + ": OpenVDB cannot write it: " + error.what());
  }
  progress.check();
  if (!stream) output.stream().setstate(std::ios::badbit);  // commit says what that means
  output.commit();
}

}  // namespace vdb_offset
