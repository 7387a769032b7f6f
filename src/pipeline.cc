#include "vdb_offset/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "vdb_offset/blocks/repair.h"
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

std::set<std::string> names_of(const Patches& patches) {
  std::set<std::string> names;
  for (const Patch& patch : patches) {
    names.insert(patch.name);
    if (!patch.family.empty()) names.insert(patch.family);
  }
  return names;
}

/// Patches without layers become what their neighbours' layers end on.
void take_off(Patches& patches, PipelineOptions& options) {
  for (const FamilyLayers& family : options.march.families) {
    if (!family.off) continue;
    NamedShape shape{family.name, {}, true};
    Patches kept;
    for (Patch& patch : patches) {
      const bool off = patch.family == family.name || patch.name == family.name;
      (off ? shape.patches : kept).push_back(std::move(patch));
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
  for (std::size_t f = 0; f < families.size(); ++f) {
    const FamilyLayers& family = families[f];
    const auto is_named = [&](const Patch& patch) {
      return patch.family == family.name || patch.name == family.name;
    };
    if (std::none_of(patches.begin(), patches.end(), is_named)) {
      throw InputError(fmt::format("no family or patch is called '{}'; there are: {}", family.name,
                                   fmt::join(names_of(patches), ", ")));
    }
    for (std::size_t g = 0; g < f; ++g) {
      if (families[g].name != family.name) continue;
      throw InputError(
          fmt::format("family '{}' is given twice; say all of it at once", family.name));
    }
    if (family.off) continue;
    SpacingOptions spacing = options.spacing;
    const LayerSpacing common = solve_spacing(options.distance_world, options.spacing);
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
}

Plan plan_mesh(Patches patches, const PipelineOptions& given, const Progress& progress) {
  given.validate();
  PipelineOptions options = given;
  check_families(patches, options);
  take_off(patches, options);
  Plan plan;
  plan.spacing = solve_spacing(options.distance_world, options.spacing);
  plan.surface = build_surface(std::move(patches), options.surface, progress);
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
  timed(result.time.blocks, [&] { return repair(result.surface, {}, result.mesh, progress); });
  result.quality = timed(result.time.blocks, [&] { return judge(result.mesh, progress); });
  done("blocks");
  return result;
}

}  // namespace vdb_offset
