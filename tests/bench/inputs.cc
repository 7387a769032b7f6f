#include "bench/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <random>
#include <utility>

#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::bench {

namespace {

const Vec3 kOffLattice(0.11, -0.23, 0.37);

Input from_patches(const std::string& name, Patches patches, double voxel_world) {
  const Surface surface = build_surface(std::move(patches));
  Input in{name, surface.wall->vertices(), {}, surface.closed};
  in.triangles.assign(surface.wall->triangles().begin(), surface.wall->triangles().end());
  std::sort(in.triangles.begin(), in.triangles.end());  // as the patches have them
  for (Vec3& v : in.vertices) v = v / voxel_world + kOffLattice;
  return in;
}

/// So fine that the surface's diagonal is `voxels` long.
Input across(const std::string& name, const Patches& patches, double voxels) {
  Box box;
  for (const Patch& patch : patches) {
    for (const Vec3& p : patch.points_world) box.add(p);
  }
  return from_patches(name, patches, box.size() / voxels);
}

void add_sheet(Input& in, int cells, double edge, double z) {
  const auto base = static_cast<int>(in.vertices.size());
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      in.vertices.push_back(Vec3(i * edge / cells, j * edge / cells, z) + kOffLattice);
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = base + j * (cells + 1) + i;
      const int c = a + cells + 2;
      in.triangles.push_back(z > 0 ? Wall::Triangle{a, a + 1, c} : Wall::Triangle{a, c, a + 1});
      in.triangles.push_back(z > 0 ? Wall::Triangle{a, c, c - 1} : Wall::Triangle{a, c - 1, c});
    }
  }
}

/// Two sheets a tenth of a voxel apart, open at the rim: no sign to be had.
Input thin_plate() {
  Input in{"thin-plate", {}, {}, false};
  add_sheet(in, 200, 400, 0);
  add_sheet(in, 200, 400, 0.1);
  return in;
}

/// Triangles of a tenth of a voxel.
Input tiny_triangles() {
  Input in{"tiny-triangles", {}, {}, false};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto point = [&](double edge) {
    const double x = unit(random);
    const double y = unit(random);
    return Vec3(edge * Vec3(x, y, unit(random)));
  };
  for (int n = 0; n < 100'000; ++n) {
    const Vec3 centre = point(100);
    for (int c = 0; c < 3; ++c) in.vertices.push_back(centre + point(0.1));
    in.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return in;
}

}  // namespace

Surface Input::surface() && {
  Surface surface;
  surface.wall = std::make_shared<const Wall>(std::move(vertices), std::move(triangles));
  surface.closed = closed;
  surface.topology.components = 1;
  return surface;
}

Input sphere(double radius_voxels) {
  return from_patches(fmt::format("sphere-{:.0f}", radius_voxels),
                      make_example("sphere", {.points = 83}), 1 / radius_voxels);
}

std::vector<InputCase> input_cases(const std::string& bwb) {
  const auto tube = [] { return across("draft-tube", make_example("draft-tube"), 400); };
  const auto wing = [bwb] { return across("bwb", read_plot3d(bwb), 400); };
  return {{"sphere-100", {20, 60}, [] { return sphere(100); }},
          {"sphere-300", {20, 60}, [] { return sphere(300); }},
          {"draft-tube", {20}, tube},
          {"bwb", {20}, wing},
          {"thin-plate", {20}, thin_plate},
          {"tiny-triangles", {20}, tiny_triangles}};
}

}  // namespace vdb_offset::bench
