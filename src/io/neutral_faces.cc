// Faces and types of neutral map files as "Voice 2 Skull: The Neutral Map File" (W. T. Jones, NASA
// Langley, GEOLAB) describes them.

#include "io/neutral_faces.h"

#include <cstdlib>
#include <map>

#include "vdb_offset/blocks/conditions.h"

namespace vdb_offset {
namespace {

constexpr std::array<BlockFace, 6> kFaces{BlockFace::KMin, BlockFace::KMax, BlockFace::IMin,
                                          BlockFace::IMax, BlockFace::JMin, BlockFace::JMax};

Condition condition_of(const std::string& key, const std::string& type) {
  static const std::map<std::string, ConditionKind> kinds = {
      {"WALL", ConditionKind::Wall},
      {"VISCOUS", ConditionKind::Wall},
      {"INVISCID", ConditionKind::InviscidWall},
      {"SYMMETRY", ConditionKind::Symmetry},
      {"SYMMETRY_X", ConditionKind::Symmetry},
      {"SYMMETRY_Y", ConditionKind::Symmetry},
      {"SYMMETRY_Z", ConditionKind::Symmetry},
      {"INFLOW", ConditionKind::Inflow},
      {"OUTFLOW", ConditionKind::Outflow},
      {"FARFIELD", ConditionKind::Farfield},
      {"OVERSET", ConditionKind::Overset},
      {"POLE_DIR1", ConditionKind::Degenerate},
      {"POLE_DIR2", ConditionKind::Degenerate},
      {"COLLAPSED", ConditionKind::Degenerate},
      {"UNPROCESSED", ConditionKind::Unspecified}};
  const auto found = kinds.find(key);
  if (found != kinds.end()) return {found->second};
  return condition_of_cgns(type);
}

}  // namespace

std::array<std::size_t, 2> neutral_axes(BlockFace face) {
  const std::size_t normal = axis_of(face);
  return {(normal + 1) % 3, (normal + 2) % 3};
}

BlockFace neutral_face(int number) { return kFaces[static_cast<std::size_t>(number) - 1]; }

NeutralRange neutral_range(const BlockRange& range) {
  NeutralRange out;
  out.block = range.block + 1;
  while (kFaces[static_cast<std::size_t>(out.face)] != range.face) ++out.face;
  ++out.face;
  const std::array<std::size_t, 2> axes = neutral_axes(range.face);
  for (std::size_t d = 0; d < 2; ++d) {
    out.begin[d] = range.begin[axes[d]] + 1;
    out.end[d] = range.end[axes[d]] + 1;
  }
  return out;
}

BlockRange block_range(const NeutralRange& range, const std::array<int, 3>& sizes) {
  BlockRange out;
  out.block = range.block - 1;
  out.face = neutral_face(range.face);
  const std::size_t normal = axis_of(out.face);
  out.begin[normal] = out.end[normal] = is_max(out.face) ? sizes[normal] - 1 : 0;
  const std::array<std::size_t, 2> axes = neutral_axes(out.face);
  for (std::size_t d = 0; d < 2; ++d) {
    out.begin[axes[d]] = range.begin[d] - 1;
    out.end[axes[d]] = range.end[d] - 1;
  }
  return out;
}

bool is_swapped(const Interface& interface) {
  const std::size_t first = neutral_axes(interface.first.face)[0];
  const std::size_t second = neutral_axes(interface.second.face)[0];
  return std::abs(interface.transform[first]) != static_cast<int>(second) + 1;
}

Interface neutral_interface(const BlockRange& first, const BlockRange& second, bool swapped) {
  Interface out{first, second, {}, {}};
  const std::size_t normal = axis_of(first.face);
  const int through = static_cast<int>(axis_of(second.face)) + 1;
  out.transform[normal] = is_max(first.face) != is_max(second.face) ? through : -through;
  const std::array<std::size_t, 2> from = neutral_axes(first.face);
  const std::array<std::size_t, 2> to = neutral_axes(second.face);
  for (std::size_t d = 0; d < 2; ++d) {
    const std::size_t a = from[d];
    const std::size_t b = to[swapped ? 1 - d : d];
    const bool same = (first.end[a] > first.begin[a]) == (second.end[b] > second.begin[b]);
    out.transform[a] = static_cast<int>(b + 1) * (same ? 1 : -1);
  }
  return out;
}

std::string neutral_key(std::string_view type) {
  std::string key(type);
  for (char& c : key) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    if (c == '-' || c == ' ') c = '_';
  }
  return key;
}

BoundaryFace neutral_boundary(const std::string& type, const BlockRange& range) {
  const Condition condition = condition_of(neutral_key(type), type);
  return {boundary_kind(condition.kind), type, range, condition};
}

}  // namespace vdb_offset
