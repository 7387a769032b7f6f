#include <fmt/format.h>

#include <utility>

#include "command.h"
#include "exit_codes.h"
#include "gap_words.h"
#include "outputs.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vdb.h"
#include "vdb_offset/surface/splayed_edges.h"

namespace vdb_offset::command {
namespace {

constexpr const char* kEndsOnBoundaries =
    "past which there is no phi, and so no outside to tell an inside from; close it, or leave "
    "boundaries out and take --sign winding, which closes openings";

std::size_t edges_on_boundaries(const Surface& surface) {
  return static_cast<std::size_t>(surface.free_edges()) - splayed_edges(surface).edges;
}

/// What --weld would do, to stand behind what there is to say of an open surface.
std::string gaps_behind(const Surface& surface) {
  const std::string gaps = gaps_in_words(surface);
  return gaps.empty() ? std::string() : "; " + gaps;
}

/// --sign closed is for surfaces that are.
void refuse_open(const Surface& surface, const Settings& settings) {
  if (settings.sign != SignRule::Closed || surface.flat || surface.closed) return;
  const SplayedEdges open = splayed_edges(surface);
  if (open.edges == 0) {
    throw InputError(
        fmt::format("--sign closed: the surface is open: its {} free edges lie on "
                    "boundaries, {}",
                    surface.free_edges(), kEndsOnBoundaries));
  }
  const auto& [from, to] = open.first_world;
  throw InputError(fmt::format(
      "--sign closed: the surface is open, with {} free edges on no boundary, the first from "
      "({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}); mend it, or take winding or "
      "unsigned{}",
      open.edges, from.x(), from.y(), from.z(), to.x(), to.y(), to.z(), gaps_behind(surface)));
}

/// How the side is told, where that was chosen by what the surface is, and where the nearest face
/// does not tell it.
void print_sign(const Console& console, const Surface& surface, const Settings& settings) {
  const std::string overlaps = overlaps_in_words(surface);
  if (!overlaps.empty()) {
    console.warning("sign: by the normal of the nearest face, as of closed surfaces; " + overlaps +
                    "; --sign winding has them as one solid");
    return;
  }
  // A note says why winding numbers, or no sign, were chosen for faces that are no surface.
  if (settings.pipeline.surface.sides != SideRule::Manifold) return;
  const char* const what = surface.flat ? "curve" : "surface";
  if (!surface.closed && !surface.flat && surface.boundaries) {
    console.remark(
        fmt::format("sign: none, for the surface is open: {} of its {} free edges lie on "
                    "boundaries, {}",
                    edges_on_boundaries(surface), surface.free_edges(), kEndsOnBoundaries));
  } else if (!surface.closed) {
    console.remark(
        fmt::format("sign: none, for the {} is open{}", what,
                    surface.flat ? "; close it to have one"
                                 : fmt::format(", with {} free edges; --sign winding gives it one",
                                               surface.free_edges())));
  } else if (settings.sign == SignRule::Auto) {
    console.remark(
        fmt::format("sign: by the normal of the nearest face, for the {} is closed", what));
  }
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
  if (settings.dry_run) {
    const Plan plan = plan_mesh(std::move(patches), pipeline, progress);
    refuse_open(plan.surface, settings);
    print_plan(plan, settings, kField);
    return kDone;
  }
  FieldResult result = make_field(std::move(patches), pipeline, progress,
                                  [&](std::string_view stage, const FieldResult& so_far) {
                                    frame.bar.clear();
                                    print_field_stage(console, stage, so_far);
                                    if (stage != "surface") return;
                                    refuse_open(so_far.surface, settings);
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
    if (settings.feature_grid) grids.feature_of = &result.surface;
    // The last file may have the tree: a copy would double the memory.
    const bool last = &output == &outputs.back();
    write_vdb(output.file, last ? std::move(field) : field, nullptr, grids);
    run.outputs.push_back(output.file.string());
  }
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
