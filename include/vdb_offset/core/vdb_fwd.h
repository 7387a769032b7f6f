#pragma once

/// OpenVDB's grid types by name only, so that public headers stay quick to compile.
/// Include <openvdb/openvdb.h> where a grid is used.

#include <openvdb/version.h>

#include <cstdint>

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
template <typename>
class Grid;
namespace tree {
template <typename>
class Tree;
template <typename>
class RootNode;
template <typename, std::uint32_t>
class InternalNode;
template <typename, std::uint32_t>
class LeafNode;
}  // namespace tree
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb

namespace vdb_offset {

template <typename T>
using VdbGrid =
    openvdb::Grid<openvdb::tree::Tree<openvdb::tree::RootNode<openvdb::tree::InternalNode<
        openvdb::tree::InternalNode<openvdb::tree::LeafNode<T, 3>, 4>, 5>>>>;

/// The same type as openvdb::FloatGrid.
using FloatGrid = VdbGrid<float>;

}  // namespace vdb_offset
