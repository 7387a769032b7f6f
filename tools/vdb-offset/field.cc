#include <fmt/format.h>

#include <utility>

#include "command.h"
#include "exit_codes.h"
#include "field_notes.h"
#include "outputs.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vdb.h"

namespace vdb_offset::command {
namespace {

/// Of a field both sides are a matter of the band: there are no blocks to double patches for.
void take_both_sides(PipelineOptions& pipeline) {
  if (pipeline.surface.side != MarchSide::Both) return;
  pipeline.surface.side = MarchSide::Along;
  pipeline.rasterize.both_sides = true;
}

}  // namespace

int run_field(const Arguments& arguments) {
  const Stopwatch total;
  Settings settings = parse_run(kField, arguments);
  const std::vector<Output> outputs = plan_outputs(settings, {"field", {Format::Vdb}});
  RunFrame frame(settings);
  const Console& console = frame.console;
  const Progress& progress = frame.progress;

  const Stopwatch reading;
  PolygonUse polygons{.use = SurfaceUse::Distance};
  Patches patches = read_surfaces(settings, polygons);
  const SideRule sides = settings.pipeline.surface.sides =
      side_rule(settings.sign, polygons, settings.input_notes);
  const double read_seconds = reading.seconds();
  for (const std::string& note : settings.input_notes) console.remark(note);
  for (const std::string& warning : polygons.warnings) console.warning(warning);
  PipelineOptions pipeline = plan_memory(settings, outputs, /*layers=*/false);
  // The distance goes on past free edges, but for boundaries that are named.
  pipeline.surface.open_edges = OpenEdges::Splay;
  // An open surface's phi is written without sign; its normals need the wall's.
  pipeline.rasterize.unsigned_if_open = !settings.grids.normal || sides == SideRule::Unsigned;
  pipeline.surface.sides = sides;
  take_both_sides(pipeline);
  // Cleaning has welded what there is to weld.
  if (polygons.is_all_welded) pipeline.surface.weld = 0;
  if (settings.dry_run) {
    const Plan plan = plan_mesh(std::move(patches), pipeline, progress);
    refuse_open(plan.surface, settings);
    refuse_unwritable(plan.surface, pipeline, outputs, settings);
    print_plan(plan, settings, kField);
    return kDone;
  }
  FieldResult result = make_field(std::move(patches), pipeline, progress,
                                  [&](std::string_view stage, const FieldResult& so_far) {
                                    frame.bar.clear();
                                    print_field_stage(console, stage, so_far);
                                    if (stage == "rasterize") {
                                      print_closed_gap(console, so_far, polygons, settings);
                                    }
                                    if (stage != "surface") return;
                                    refuse_open(so_far.surface, settings);
                                    refuse_unwritable(so_far.surface, pipeline, outputs, settings);
                                    print_sign(console, so_far.surface, settings);
                                  });

  const Stopwatch writing;
  RunInfo run;
  run.command = "field";
  run.options = echo_options(settings, kField);
  run.threads = ThreadLimit::in_force();
  DistanceField field = std::move(result.field);  // its report stays
  for (const Output& output : outputs) {
    progress.check();
    VdbWriteOptions grids = settings.grids;
    if (settings.feature_grid) {
      grids.feature_of = &result.surface;
      grids.face_numbers =
          numbers_in_files(result.surface, polygons, settings.pipeline.surface.side);
    }
    // The last file may have the tree: a copy would double the memory.
    const bool last = &output == &outputs.back();
    write_vdb(output.file, last ? std::move(field) : field, nullptr, grids, progress);
    run.outputs.push_back(output.file.string());
  }
  result.surface.both_sides = result.field.both_sides;  // as it was asked for
  const double io_seconds = read_seconds + writing.seconds();
  console.stage("io", fmt::format("{}", fmt::join(run.outputs, ", ")), io_seconds);
  const StageTimes& time = result.time;
  run.seconds = {{"surface", time.surface},
                 {"rasterize", time.rasterize},
                 {"sweep", time.sweep},
                 {"io", io_seconds},
                 {"total", total.seconds()}};
  put_report({&result.surface, &result.plan, &result.field, nullptr, nullptr}, run, settings);
  return check_converged(result.field, settings);
}

}  // namespace vdb_offset::command
