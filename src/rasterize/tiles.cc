// Octree descent over cubes of leaf tiles: the distance of a cube's centre to the wall says that it
// is outside the band, inside, behind the wall, or must be split.

#include "rasterize/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

namespace {

// A count keeps no more tiles than this.
constexpr double kMostKept = 1e6;

enum class Place { Outside, Inside, Mixed };

/// A cube to judge, and a place on the wall that bounds the search: its parent's nearest.
struct Asked {
  TileCube cube;
  Vec3 wall_point;  // not a number: none known
};

struct Judged {
  Place place;
  TileSite centre;
  Vec3 wall_point;  // nearest to that centre
};

/// Whether each voxel of a tile must ask for its side: near an open edge, where the wall's side
/// goes on as a plane, and where bodies that do not agree are about equally near.
bool must_ask(const TileQuery& query, const WallPoint& nearest, const SideBall& ball,
              bool near_wall) {
  if (nearest.on_free_edge || query.winding != nullptr) return true;
  if (query.parts == nullptr || query.parts->agree()) return false;
  return near_wall ? !query.parts->has_one_part(ball) : !query.parts->has_one_side(ball);
}

/// A leaf tile of a band without sides: boxes tell as much of it as is asked, at once.
Judged judge_tile(const Wall& wall, const TileQuery& query, const Asked& asked) {
  const double h = query.voxel_world;
  const Vec3 lo = h * (kTile * Vec3(asked.cube.x, asked.cube.y, asked.cube.z));
  Box box;
  box.add(lo);
  box.add(Vec3(lo.array() + (kTile - 1) * h));
  Judged judged{Place::Mixed, {asked.cube, false, false, false}, asked.wall_point};
  judged.centre.near_wall = wall.is_near_box(box, query.seed_reach_voxels * h * (1 + 1e-9));
  const bool in_band = judged.centre.near_wall || wall.is_near_box(box, query.reach_world);
  if (!in_band) judged.place = Place::Outside;
  return judged;
}

Judged judge_ball(const Wall& wall, const TileQuery& query, const Asked& asked,
                  const Vec3& centre) {
  const double half = half_diagonal_world(asked.cube, query.voxel_world);
  const double bound = (centre - asked.wall_point).norm() * (1 + 1e-9) + 1e-9 * half;
  const double limit = std::fmin(query.reach_world + half, bound);
  const WallPoint nearest = query.sides && query.winding == nullptr
                                ? wall.closest(centre, limit)
                                : wall.closest_place(centre, limit);
  Judged judged{Place::Outside, {asked.cube, false, false, false}, nearest.point_world};
  if (nearest.triangle < 0) return judged;
  const double seed_reach = query.seed_reach_voxels * query.voxel_world;
  const bool near_wall = nearest.distance_world <= half + seed_reach;
  judged.centre.near_wall = near_wall;
  const bool inside = nearest.distance_world + half <= query.reach_world;
  judged.place = inside ? Place::Inside : Place::Mixed;
  if (!query.sides) return judged;
  judged.centre.behind = query.winding == nullptr && nearest.side(centre) < 0;
  judged.centre.ask_voxels =
      must_ask(query, nearest, {centre, nearest.distance_world, half}, near_wall);
  if (query.both_sides) return judged;
  if (near_wall || judged.centre.ask_voxels) {
    // Without a sign on the whole cube, only its tiles can tell which of them lie behind.
    judged.place = Place::Mixed;
  } else if (judged.centre.behind) {
    judged.place = Place::Outside;
  }
  return judged;
}

Judged judge_cube(const Wall& wall, const TileQuery& query, const Asked& asked) {
  Vec3 centre = centre_world(asked.cube, query.voxel_world);
  const Judged outside{Place::Outside, {asked.cube, false, false, false}, asked.wall_point};
  if (query.flat) {
    if (asked.cube.z > 0 || asked.cube.z + asked.cube.edge <= 0) return outside;
    centre.z() = 0;
  }
  bool cut = query.flat;
  if (query.boundaries != nullptr) {
    const double margin =
        half_diagonal_world(asked.cube, query.voxel_world) + kOnBoundaryVoxels * query.voxel_world;
    const double within = query.boundaries->side(centre);
    if (within < -margin) return outside;
    cut = cut || within < margin;
  }
  Judged judged = asked.cube.edge == 1 && !query.sides ? judge_tile(wall, query, asked)
                                                       : judge_ball(wall, query, asked, centre);
  judged.centre.cut = cut;
  if (cut && judged.place == Place::Inside) judged.place = Place::Mixed;
  return judged;
}

/// The cubes of one power-of-two edge that cover the wall's reach; empty if the lattice is too
/// fine.
std::vector<Asked> roots(const Wall& wall, const TileQuery& query) {
  const double tile_world = kTile * query.voxel_world;
  const Vec3 lo = (wall.bounds().lo.array() - query.reach_world) / tile_world;
  const Vec3 hi = (wall.bounds().hi.array() + query.reach_world) / tile_world;
  constexpr double kIndexLimit = 1 << 27;  // tiles; voxel indices stay below 2^30
  if (!(lo.cwiseAbs().maxCoeff() < kIndexLimit) || !(hi.cwiseAbs().maxCoeff() < kIndexLimit)) {
    return {};
  }
  const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::int32_t edge = 1;
  while (edge < (hi - lo).maxCoeff() / 4) edge *= 2;
  std::vector<Asked> cubes;
  const auto first = [&](int a) { return static_cast<std::int32_t>(std::floor(lo[a] / edge)); };
  const auto last = [&](int a) {
    return static_cast<std::int32_t>(std::floor((hi[a] + 1) / edge));
  };
  for (std::int32_t x = first(0); x <= last(0); ++x) {
    for (std::int32_t y = first(1); y <= last(1); ++y) {
      for (std::int32_t z = first(2); z <= last(2); ++z) {
        cubes.push_back({{x * edge, y * edge, z * edge, edge}, unknown});
      }
    }
  }
  return cubes;
}

/// What the wall's bounding box alone says of cubes far from it: seen from there all of the wall is
/// about equally near, and a query looks at much of it.
class FarJudge {
 public:
  FarJudge(const Wall& wall, const TileQuery& query) : box_(wall.bounds()), query_(query) {
    if (!query.one_body) return;
    const Vec3 beyond = (box_.hi.array() + box_.size()).matrix();
    behind_ = wall.closest(beyond).side(beyond) < 0;
  }

  /// Nothing where only a query can tell.
  std::optional<Judged> judge(const Asked& asked) const {
    const Vec3 centre = centre_world(asked.cube, query_.voxel_world);
    const double half = half_diagonal_world(asked.cube, query_.voxel_world);
    const Vec3 below = box_.lo - centre;
    const Vec3 above = centre - box_.hi;
    const double least = below.cwiseMax(above).cwiseMax(0.0).norm();
    const double most = below.cwiseAbs().cwiseMax(above.cwiseAbs()).norm();
    Judged judged{Place::Outside, {asked.cube, false, false, behind_}, asked.wall_point};
    if (least > query_.reach_world + half) return judged;
    const double near = half + query_.seed_reach_voxels * query_.voxel_world;
    if (!query_.one_body || least <= near) return {};
    if (behind_ && !query_.both_sides) return judged;
    const bool inside = most + half <= query_.reach_world;
    const bool mixed = most <= query_.reach_world + half && least + half > query_.reach_world;
    if (!inside && !mixed) return {};
    judged.place = inside ? Place::Inside : Place::Mixed;
    return judged;
  }

 private:
  Box box_;
  TileQuery query_;
  bool behind_ = false;
};

/// Polls `progress`, but does not report: nobody knows how many cubes are to come.
template <typename Judge>
std::vector<Judged> judge_all(const std::vector<Asked>& cubes, const Progress& progress,
                              const Judge& judge) {
  const Progress silent{{}, progress.cancel};
  std::vector<Judged> judged(cubes.size());
  parallel::for_ranges({silent, "rasterize"}, cubes.size(), 64,
                       [&](std::size_t begin, std::size_t end) {
                         for (std::size_t c = begin; c < end; ++c) judged[c] = judge(cubes[c]);
                       });
  return judged;
}

void split(const Judged& judged, std::vector<Asked>& parts) {
  const TileCube& cube = judged.centre.cube;
  const std::int32_t half = cube.edge / 2;
  for (int part = 0; part < 8; ++part) {
    const TileCube child{cube.x + (part & 4 ? half : 0), cube.y + (part & 2 ? half : 0),
                         cube.z + (part & 1 ? half : 0), half};
    parts.push_back({child, judged.wall_point});
  }
}

/// Whether all tiles of a cube are in the band, on one side and without seeds.
bool is_alike(const TileQuery& query, const Judged& judged) {
  return query.closed && judged.place == Place::Inside && !judged.centre.near_wall &&
         !judged.centre.ask_voxels;
}

/// All tiles of a cube that has one side and no seeds.
void fill(const Judged& judged, std::vector<TileSite>& tiles) {
  const TileCube& cube = judged.centre.cube;
  for (std::int32_t x = cube.x; x < cube.x + cube.edge; ++x) {
    for (std::int32_t y = cube.y; y < cube.y + cube.edge; ++y) {
      for (std::int32_t z = cube.z; z < cube.z + cube.edge; ++z) {
        tiles.push_back(judged.centre);
        tiles.back().cube = {x, y, z, 1};
      }
    }
  }
}

/// Keeps an even sample of the cubes; returns how many each of them stands for.
double thin_out(std::vector<Asked>& cubes, std::size_t sample) {
  if (cubes.size() <= sample) return 1;
  // A stride without a factor of 2 does not prefer one octant of the cubes' parents.
  const std::size_t stride = cubes.size() / sample | 1U;
  if (stride == 1) return 1;
  const auto before = static_cast<double>(cubes.size());
  std::size_t kept = 0;
  for (std::size_t c = 0; c < cubes.size(); c += stride) cubes[kept++] = cubes[c];
  cubes.resize(kept);
  return before / static_cast<double>(kept);
}

}  // namespace

Vec3 centre_world(const TileCube& cube, double voxel_world) {
  const double half = 0.5 * (kTile * cube.edge - 1);
  return voxel_world * (kTile * Vec3(cube.x, cube.y, cube.z).array() + half).matrix();
}

double half_diagonal_world(const TileCube& cube, double voxel_world) {
  return 0.5 * std::sqrt(3.0) * (kTile * static_cast<double>(cube.edge) - 1) * voxel_world;
}

std::optional<double> count_tiles(const Wall& wall, const TileQuery& query,
                                  const Progress& progress, std::vector<TileSite>* sites) {
  std::vector<Asked> cubes = roots(wall, query);
  if (cubes.empty()) return std::nullopt;
  const FarJudge far(wall, query);
  const auto judge = [&](const Asked& asked) {
    const std::optional<Judged> judged = far.judge(asked);
    return judged ? *judged : judge_cube(wall, query, asked);
  };
  double count = 0;
  double weight = 1;
  while (!cubes.empty()) {
    const std::vector<Judged> judged = judge_all(cubes, progress, judge);
    std::vector<Asked> next;
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      if (judged[c].place == Place::Outside) continue;
      const bool whole =
          sites != nullptr ? is_alike(query, judged[c]) : judged[c].place == Place::Inside;
      if (whole || cubes[c].cube.edge == 1) {
        count += weight * std::pow(cubes[c].cube.edge, 3);
        if (sites != nullptr && count < kMostKept) fill(judged[c], *sites);
      } else {
        split(judged[c], next);
      }
    }
    weight *= thin_out(next, query.sample);
    if (sites != nullptr && (weight > 1 || count >= kMostKept)) {
      *sites = {};
      sites = nullptr;
    }
    cubes.swap(next);
  }
  return weight > 1 ? 1.03 * count : count;
}

std::vector<TileSite> find_tiles(const Wall& wall, const TileQuery& query,
                                 const Progress& progress) {
  std::vector<TileSite> tiles;
  std::vector<Asked> cubes = roots(wall, query);
  while (!cubes.empty()) {
    const std::vector<Judged> judged = judge_all(
        cubes, progress, [&](const Asked& asked) { return judge_cube(wall, query, asked); });
    std::vector<Asked> next;
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      if (judged[c].place == Place::Outside) continue;
      if (cubes[c].cube.edge == 1 || is_alike(query, judged[c])) {
        fill(judged[c], tiles);
      } else {
        split(judged[c], next);
      }
    }
    cubes.swap(next);
  }
  return tiles;
}

}  // namespace vdb_offset
