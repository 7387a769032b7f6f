#pragma once

#include <array>
#include <string_view>

#include "vdb_offset/io/topology.h"

/// The words of a topology document, by the values of their enums.
namespace vdb_offset::topology_words {

inline constexpr std::string_view kFormat = "vdb-offset topology";
inline constexpr int kVersion = 1;

inline constexpr std::array<std::string_view, 3> kRoles{"wall", "boundary", "internal"};
inline constexpr std::array<std::string_view, 3> kEdges{"wall", "outer", "column"};
inline constexpr std::array<std::string_view, 3> kFaces{"wall", "outer", "side"};
inline constexpr std::array<std::string_view, 6> kSides{"imin", "imax", "jmin",
                                                        "jmax", "kmin", "kmax"};
inline constexpr std::array<std::string_view, 5> kBoundaries{"wall", "outer", "boundary", "free",
                                                             "degenerate"};
inline constexpr std::array<std::string_view, 10> kConditions{
    "unspecified", "wall",     "inviscid-wall", "symmetry",   "inflow",
    "outflow",     "farfield", "overset",       "degenerate", "other"};

}  // namespace vdb_offset::topology_words
