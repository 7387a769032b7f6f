// Zhao, A fast sweeping method for eikonal equations, 2005; the upwind scheme is Rouy and Tourin's,
// A viscosity solutions approach to shape-from-shading, 1992.
//
// With a <= b <= c sorted and p = b - a, q = c - a, t = phi - a:
//   one axis    t = h                                            while t <= p
//   two axes    t^2 + (t - p)^2 = h^2              -> t = (p + sqrt(2 h^2 - p^2)) / 2        while
//   t <= q three axes  t^2 + (t - p)^2 + (t - q)^2 = h^2  -> t = (s + sqrt(s^2 - 3 (p^2 + q^2 -
//   h^2))) / 3,
//               s = p + q
// Differences to the least neighbour keep the digits that the paper's form loses far from the wall.

#include "sweep/tile_sweep.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset {

float godunov(float a, float b, float c, float h) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  const float p = b - a;
  if (h <= p) return a + h;
  const float q = c - a;
  float t = 0.5F * (p + std::sqrt(2 * h * h - p * p));
  if (t <= q) return a + t;
  const float s = p + q;
  t = (s + std::sqrt(std::max(0.0F, s * s - 3 * (p * p + q * q - h * h)))) * (1.0F / 3.0F);
  return a + t;
}

float sweep_tile(HaloTile& tile, const Octant& octant, float h) {
  float change = 0;
  const auto first = [](int step) { return step > 0 ? 0 : 7; };
  const auto& stride = HaloTile::kStride;
  float* const phi = tile.phi.data();
  for (int i = 0, x = first(octant.x); i < 8; ++i, x += octant.x) {
    for (int j = 0, y = first(octant.y); j < 8; ++j, y += octant.y) {
      for (int k = 0, z = first(octant.z); k < 8; ++k, z += octant.z) {
        const int n = HaloTile::index(x, y, z);
        const float floor = tile.floor[static_cast<std::size_t>(n)];
        const float old = phi[n];
        if (floor == old) continue;
        const float a = std::min(phi[n - stride[0]], phi[n + stride[0]]);
        const float b = std::min(phi[n - stride[1]], phi[n + stride[1]]);
        const float c = std::min(phi[n - stride[2]], phi[n + stride[2]]);
        if (std::min({a, b, c}) >= old) continue;
        const float fresh = std::max(floor, std::min(old, godunov(a, b, c, h)));
        change = std::max(change, old - fresh);
        phi[n] = fresh;
      }
    }
  }
  return change;
}

}  // namespace vdb_offset
