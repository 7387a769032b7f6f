#include "vdb_offset/pipeline.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

/// Runs a stage and adds its seconds.
template <typename Stage>
auto timed(double& seconds, const Stage& stage) {
  const auto start = std::chrono::steady_clock::now();
  auto result = stage();
  seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// Bytes of layers, quality fields and the largest output buffer.
std::uint64_t mesh_bytes(const Surface& surface, int layers) {
  const auto columns = static_cast<std::uint64_t>(surface.nodes_world.size());
  const auto faces = static_cast<std::uint64_t>(surface.faces());
  const auto count = static_cast<std::uint64_t>(layers);
  std::uint64_t largest_patch = 0;
  for (const Patch& patch : surface.patches) {
    largest_patch = std::max(largest_patch, static_cast<std::uint64_t>(patch.points_world.size()));
  }
  return (columns + largest_patch) * (count + 1) * sizeof(Vec3) + faces * count * 2 * sizeof(float);
}

RasterizeOptions band_options(const PipelineOptions& options, const Surface& surface, int layers) {
  RasterizeOptions band = options.rasterize;
  band.distance_world = options.distance_world;
  band.both_sides = band.both_sides || surface.both_sides;
  if (layers > 0) band.other_bytes += mesh_bytes(surface, layers);
  return band;
}

}  // namespace

void PipelineOptions::validate() const {
  if (!(distance_world > 0) || !std::isfinite(distance_world)) {
    throw InputError(fmt::format("distance = {}, but must be above 0 and finite", distance_world));
  }
  surface.validate();
  sweep.validate();
  spacing.validate();
  march.validate();
}

Plan plan_mesh(Patches patches, const PipelineOptions& options, const Progress& progress) {
  options.validate();
  Plan plan;
  plan.spacing = solve_spacing(options.distance_world, options.spacing);
  plan.surface = build_surface(std::move(patches), options.surface, progress);
  plan.band = plan_band(plan.surface, band_options(options, plan.surface, plan.spacing.layers));
  return plan;
}

FieldResult make_field(Patches patches, const PipelineOptions& options, const Progress& progress) {
  options.validate();
  FieldResult result;
  result.surface = timed(result.time.surface, [&] {
    return build_surface(std::move(patches), options.surface, progress);
  });
  Band band = timed(result.time.rasterize, [&] {
    return rasterize(result.surface, band_options(options, result.surface, 0), progress);
  });
  result.plan = band.plan;
  result.field =
      timed(result.time.sweep, [&] { return sweep(std::move(band), options.sweep, progress); });
  return result;
}

MeshResult make_mesh(Patches patches, const PipelineOptions& options, const Progress& progress) {
  options.validate();
  const LayerSpacing spacing = solve_spacing(options.distance_world, options.spacing);
  MeshResult result;
  result.surface = timed(result.time.surface, [&] {
    return build_surface(std::move(patches), options.surface, progress);
  });
  Band band = timed(result.time.rasterize, [&] {
    return rasterize(result.surface, band_options(options, result.surface, spacing.layers),
                     progress);
  });
  result.plan = band.plan;
  result.field =
      timed(result.time.sweep, [&] { return sweep(std::move(band), options.sweep, progress); });
  Layers layers = timed(result.time.march, [&] {
    return march(result.surface, result.field, spacing, options.march, progress);
  });
  result.mesh = timed(result.time.blocks,
                      [&] { return build_blocks(result.surface, std::move(layers), progress); });
  result.quality = timed(result.time.blocks, [&] { return judge(result.mesh, progress); });
  return result;
}

}  // namespace vdb_offset
