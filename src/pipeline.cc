#include "vdb_offset/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
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

/// Bytes of layers, scaled Jacobians and the largest output buffer.
std::uint64_t mesh_bytes(const Surface& surface, int layers) {
  const auto columns = static_cast<std::uint64_t>(surface.nodes_world.size());
  const auto faces = static_cast<std::uint64_t>(surface.faces());
  const auto count = static_cast<std::uint64_t>(layers);
  std::uint64_t largest_patch = 0;
  for (const Patch& patch : surface.patches) {
    largest_patch = std::max(largest_patch, static_cast<std::uint64_t>(patch.points_world.size()));
  }
  return (columns + largest_patch) * (count + 1) * sizeof(Vec3) + faces * count * sizeof(float);
}

RasterizeOptions band_options(const PipelineOptions& options, const Surface& surface, int layers) {
  RasterizeOptions band = options.rasterize;
  band.distance_world = options.distance_world;
  for (const FamilyLayers& family : options.march.families) {
    if (layers > 0) {
      band.distance_world = std::max(band.distance_world, family.distance_world.value_or(0));
    }
  }
  band.both_sides = band.both_sides || surface.both_sides;
  if (layers > 0) band.other_bytes += mesh_bytes(surface, layers);
  return band;
}

/// Patches without layers become what their neighbours' layers end on.
void take_off(Patches& patches, PipelineOptions& options) {
  for (const FamilyLayers& family : options.march.families) {
    if (!family.off) continue;
    NamedShape shape{family.name, {}, true};
    Patches kept;
    for (Patch& patch : patches) {
      (family.is_of(patch) ? shape.patches : kept).push_back(std::move(patch));
    }
    if (shape.patches.empty() || kept.empty()) {
      throw InputError(fmt::format(
          "family '{}': layers=off leaves {}", family.name,
          kept.empty() ? "no wall at all" : "all as it was: no family or patch has that name"));
    }
    options.surface.shapes.push_back(std::move(shape));
    patches = std::move(kept);
  }
  std::erase_if(options.march.families, [](const FamilyLayers& family) { return family.off; });
}

/// Says what is wrong with families before any work is done.
void check_families(const Patches& patches, const PipelineOptions& options) {
  const std::vector<FamilyLayers>& families = options.march.families;
  if (families.empty()) return;
  check_names(families, patches);
  const LayerSpacing common = solve_spacing(options.distance_world, options.spacing);
  for (std::size_t f = 0; f < families.size(); ++f) {
    const FamilyLayers& family = families[f];
    for (std::size_t g = 0; g < f; ++g) {
      if (families[g].name != family.name) continue;
      throw InputError(
          fmt::format("family '{}' is given twice; say all of it at once", family.name));
    }
    if (family.off) continue;
    SpacingOptions spacing = options.spacing;
    spacing.layers = common.layers;
    spacing.growth.reset();
    spacing.last_cell_world.reset();
    spacing.first_cell_world = family.first_cell_world.value_or(common.first_cell_world);
    try {
      solve_spacing(family.distance_world.value_or(options.distance_world), spacing);
    } catch (const InputError& error) {
      throw InputError(fmt::format("family '{}': {}", family.name, error.what()));
    }
  }
}

struct FieldRun {
  const PipelineOptions& options;
  int layers;  // that will stand on the field, 0 for none
  const Progress& progress;
  std::function<void(std::string_view)> done;
};

/// The stages that both results begin with.
void fill_field(Patches patches, const FieldRun& run, FieldResult& result) {
  result.surface = timed(result.time.surface, [&] {
    return build_surface(std::move(patches), run.options.surface, run.progress);
  });
  if (run.layers > 0) {
    refuse_crossed_cells(result.surface);
    check_names(run.options.conditions, result.surface);
  }
  run.done("surface");
  Band band = timed(result.time.rasterize, [&] {
    return rasterize(result.surface, band_options(run.options, result.surface, run.layers),
                     run.progress);
  });
  result.plan = band.plan;
  run.done("rasterize");
  result.field = timed(result.time.sweep,
                       [&] { return sweep(std::move(band), run.options.sweep, run.progress); });
  run.done("sweep");
}

}  // namespace

void PipelineOptions::validate() const {
  if (!(distance_world > 0 && distance_world < 1e100)) {
    throw InputError(
        fmt::format("distance = {}, but must be above 0 and below 1e100", distance_world));
  }
  surface.validate();
  sweep.validate();
  spacing.validate();
  march.validate();
  repair.validate();
  conditions.validate();
}

Plan plan_mesh(Patches patches, const PipelineOptions& given, const Progress& progress) {
  given.validate();
  PipelineOptions options = given;
  check_families(patches, options);
  take_off(patches, options);
  Plan plan;
  plan.spacing = solve_spacing(options.distance_world, options.spacing);
  plan.surface = build_surface(std::move(patches), options.surface, progress);
  check_names(options.conditions, plan.surface);
  plan.band =
      plan_band(plan.surface, band_options(options, plan.surface, plan.spacing.layers), progress);
  return plan;
}

FieldResult make_field(Patches patches, const PipelineOptions& options, const Progress& progress,
                       const AfterFieldStage& after_stage) {
  options.validate();
  FieldResult result;
  const auto done = [&](std::string_view stage) {
    if (after_stage) after_stage(stage, result);
  };
  fill_field(std::move(patches), {options, 0, progress, done}, result);
  return result;
}

MeshResult make_mesh(Patches patches, const PipelineOptions& given, const Progress& progress,
                     const AfterMeshStage& after_stage) {
  given.validate();
  PipelineOptions options = given;
  check_families(patches, options);
  take_off(patches, options);
  const LayerSpacing spacing = solve_spacing(options.distance_world, options.spacing);
  MeshResult result;
  const auto done = [&](std::string_view stage) {
    if (after_stage) after_stage(stage, result);
  };
  fill_field(std::move(patches), {options, spacing.layers, progress, done}, result);
  result.mesh.layers = timed(result.time.march, [&] {
    return march(result.surface, result.field, spacing, options.march, progress);
  });
  done("march");
  result.mesh = timed(result.time.blocks, [&] {
    return build_blocks(result.surface, std::move(result.mesh.layers), progress);
  });
  if (options.repair.memory_bytes == 0) {
    options.repair.memory_bytes = options.rasterize.memory_bytes;
  }
  RepairResult repaired = timed(result.time.blocks, [&] {
    return repair(result.surface, result.mesh, options.repair, progress);
  });
  result.quality = std::move(repaired.quality);
  result.repair = repaired.report;
  set_conditions(result.surface, options.conditions, result.mesh);
  result.sides =
      timed(result.time.blocks, [&] { return check_sides(result.surface, result.mesh, progress); });
  result.crossings =
      timed(result.time.blocks, [&] { return check_crossings(result.surface, result.mesh); });
  done("blocks");
  return result;
}

}  // namespace vdb_offset
