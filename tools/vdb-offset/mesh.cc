#include <fmt/format.h>

#include <algorithm>

#include "cad_input.h"
#include "command.h"
#include "exit_codes.h"
#include "field_notes.h"
#include "gap_words.h"
#include "outputs.h"
#include "quality_table.h"
#include "sheet_words.h"
#include "side_warnings.h"
#include "vdb_offset/io/cad.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/neutral_map.h"
#include "vdb_offset/io/openfoam.h"
#include "vdb_offset/io/outer_surface.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/io/stl.h"
#include "vdb_offset/io/su2.h"
#include "vdb_offset/io/topology.h"
#include "vdb_offset/io/vdb.h"
#include "vdb_offset/io/vtk.h"
#include "vdb_offset/surface/overlaps.h"
#include "vdb_offset/surface/splayed_edges.h"

namespace vdb_offset::command {
namespace {

/// Coverage nearer to 1 than this is the promise of the march, kept.
constexpr double kFullCoverage = 1 - 1e-6;
constexpr std::size_t kTableRows = 20;

void write_outer(const Output& output, const MultiBlock& mesh, const Settings& settings) {
  switch (output.format) {
    case Format::Obj:
      return write_outer_obj(output.file, mesh);
    case Format::Stl:
      return write_stl(output.file, outer_level(mesh));
    case Format::Cgns:
      return write_cgns(output.file, outer_level(mesh), {cgns_unit(settings.length_unit)});
    case Format::Step:
      return write_step(output.file, outer_level(mesh), cad_unit(settings.length_unit));
    default:
      return write_plot3d(output.file, outer_level(mesh),
                          {.formatted = output.format == Format::Plot3dFormatted});
  }
}

/// `inverted`, out: cells whose elements in the file are not positive, though they are.
void write(const Output& output, const MeshResult& result, const Settings& settings,
           std::int64_t& inverted) {
  if (output.is_outer_surface) return write_outer(output, result.mesh, settings);
  switch (output.format) {
    case Format::Airfoil:
    case Format::Obj:
    case Format::Stl:
    case Format::Step:
      break;  // not allowed to 'mesh' (run_mesh)
    case Format::Vdb:
      break;  // takes long enough to be interrupted (write_grids)
    case Format::Plot3d:
      return write_plot3d(output.file, result.mesh, {.formatted = false});
    case Format::Plot3dFormatted:
      return write_plot3d(output.file, result.mesh, {.formatted = true});
    case Format::NeutralMap:
      return write_neutral_map(output.file, result.mesh);
    case Format::Cgns:
      return write_cgns(output.file, result.mesh, {cgns_unit(settings.length_unit)});
    case Format::Vtk:
      return write_vtm(output.file, result.mesh, result.quality);
    case Format::Vtu:
      return write_vtu(output.file, result.mesh, result.quality);
    case Format::OpenFoam:
      return write_openfoam(output.file, result.mesh);
    case Format::Su2:
      inverted = write_su2(output.file, result.mesh);
      return;
  }
}

void write_grids(const Output& output, const MeshResult& result, const Settings& settings,
                 const Progress& progress) {
  VdbWriteOptions grids = settings.grids;
  if (settings.feature_grid) grids.feature_of = &result.surface;
  write_vdb(output.file, result.field, &result.mesh.layers, grids, progress);
}

void print_march(const Console& console, const Layers& layers, double seconds) {
  const MarchReport& march = layers.report;
  const LayerSpacing& spacing = layers.spacing;
  console.stage(
      "march",
      fmt::format(
          "{} nodes: {} reached, {} collided, {} limited by neighbours, {}{} left "
          "the band; distance to {:.1e}",
          march.nodes, march.reached, march.collided, march.limited,
          march.internal > 0 ? fmt::format("{} on internal surfaces, ", march.internal) : "",
          march.left_band, march.distance_error_max),
      seconds);
  console.note(fmt::format(
      "{} layers, first cell {:.6g}, last cell {:.6g}, growth {:.6g}{}", spacing.layers,
      spacing.first_cell_world, spacing.last_cell_world, spacing.growth,
      spacing.growth_requested > 0 ? fmt::format(" (requested {:.6g})", spacing.growth_requested)
                                   : ""));
}

void print_blocks(const Console& console, const MeshResult& result) {
  const QualityReport& quality = result.quality.report;
  console.stage("blocks",
                fmt::format("{} blocks, {} cells, scaled Jacobian {:.3f} least, {:.3f} mean",
                            result.mesh.blocks.size(), result.mesh.cells(),
                            quality.min_scaled_jacobian, quality.mean_scaled_jacobian),
                result.time.blocks);
  console.note(
      fmt::format("{} interfaces, {} boundary faces; first cell {:.6g} to {:.6g}, growth "
                  "to {:.4g}",
                  result.mesh.interfaces.size(), result.mesh.boundary_faces.size(),
                  quality.first_cell_min, quality.first_cell_max, quality.growth_max));
  const RepairReport& repair = result.repair;
  if (repair.windows == 0) return;
  console.note(fmt::format(
      "{} of {} columns moved in {} windows, {} of them end lower than marched, "
      "none more than {:.2g} % farther than asked",
      repair.columns, result.surface.nodes(), repair.windows, repair.lowered, 100 * repair.beyond));
  if (repair.fall_short == 0) return;
  console.note(fmt::format("over {} faces of the wall cells are below the quality asked for",
                           repair.fall_short));
}

/// Writes all; kBadCells if a file has cells that are not positive beside those of the blocks.
int write_all(const std::vector<Output>& outputs, const MeshResult& result,
              const Settings& settings, const RunFrame& frame) {
  int code = kDone;
  for (const Output& output : outputs) {
    frame.progress.check();
    std::int64_t inverted = 0;
    if (output.format == Format::Vdb) {
      write_grids(output, result, settings, frame.progress);
    } else {
      write(output, result, settings, inverted);
    }
    if (inverted == 0) continue;
    code = kBadCells;
    frame.console.warning(fmt::format(
        "{}: {} cells with a column of no height have no point that sees all their faces: of the "
        "pyramids and tetrahedra that they are in this format some are not positive; write CGNS, "
        "VTK or OpenFOAM, which have them whole",
        output.file.string(), inverted));
  }
  return code;
}

/// Where the surface is open and ends on nothing: it may be meant, or a flaw of the file.
void print_splayed(const Console& console, const Surface& surface) {
  const SplayedEdges splayed = splayed_edges(surface);
  if (splayed.edges == 0) return;
  const auto place = [&](const Vec3& p) { return in_words(p, surface.flat); };
  const auto& [from, to] = splayed.first_world;
  console.warning(fmt::format(
      "{} on no boundary, which splay (--open-edges refuse names them): {}, the first {}",
      surface.flat ? "ends of curves" : "free edges", splayed.edges,
      surface.flat ? "at " + place(from) : "from " + place(from) + " to " + place(to)));
  for (const auto& [a, b] : surface.report.open_tails) {
    console.warning(fmt::format(
        "open trailing edge: ends of one curve, {:.3g} apart, at {} and {}; end the curve with its "
        "first point to close it",
        (b - a).norm(), place(a), place(b)));
  }
  for (const bool is_slit : {false, true}) {
    const auto& holes = splayed.small_holes;
    const auto first = std::ranges::find(holes, is_slit, &SmallHole::is_slit);
    if (first == holes.end()) continue;
    const auto& [a, b, c] = first->corners_world;
    console.warning(fmt::format("{}: {}, the first between {}, {} and {}; mend the file there",
                                is_slit ? "T-junctions, points on edges that do not use them"
                                        : "holes that one triangle would fill",
                                std::ranges::count(holes, is_slit, &SmallHole::is_slit), place(a),
                                place(b), place(c)));
  }
}

void print_stage(const Console& console, std::string_view stage, const MeshResult& so_far,
                 double weld) {
  print_field_stage(console, stage, so_far);
  if (stage == "surface") {
    print_splayed(console, so_far.surface);
    if (const std::string gaps = gaps_in_words(so_far.surface, weld); !gaps.empty()) {
      console.warning(gaps);
    }
    const std::string overlaps = overlaps_in_words(so_far.surface);
    if (!overlaps.empty()) {
      console.warning(overlaps +
                      ": layers lie in a solid there; unite the bodies, or turn a hollow's normals "
                      "inward");
    }
    const std::string sheets = sheets_in_words(so_far.surface);
    if (!sheets.empty()) console.warning(sheets);
  }
  if (stage == "march") print_march(console, so_far.mesh.layers, so_far.time.march);
  if (stage == "blocks") {
    print_blocks(console, so_far);
    print_quality(console, so_far.mesh, so_far.quality.report);
  }
}

/// Of first cells whose height was given: how many are not as high, and where one is least so.
void print_first_cells(const Console& console, const MultiBlock& mesh,
                       const PipelineOptions& options) {
  constexpr double kMost = 0.05;
  const auto& families = options.march.families;
  if (!options.spacing.first_cell_world &&
      std::ranges::none_of(families,
                           [](const FamilyLayers& of) { return of.first_cell_world.has_value(); }))
    return;
  const Layers& layers = mesh.layers;
  int off = 0;
  double least = 1;
  double most = 1;
  std::size_t worst = 0;
  double worst_off = kMost;
  for (std::size_t n = 0; n < layers.first_cell_world.size(); ++n) {
    if (!(layers.first_asked_world[n] > 0)) continue;
    const double part = layers.first_cell_world[n] / layers.first_asked_world[n];
    least = std::min(least, part);
    most = std::max(most, part);
    off += std::abs(part - 1) > kMost ? 1 : 0;
    if (std::abs(part - 1) <= worst_off) continue;
    worst_off = std::abs(part - 1);
    worst = n;
  }
  if (off == 0) return;
  const int copies = mesh.flat ? 2 : 1;
  const Vec3& place = layers.at(static_cast<int>(worst), 0);
  console.warning(fmt::format(
      "{} of {} first cells are more than {:g} % off what was asked, {:.3g} to {:.3g} times it; "
      "least so at ({:.6g}, {:.6g}, {:.6g})",
      off / copies, mesh.nodes() / copies, 100 * kMost, least, most, place.x(), place.y(),
      place.z()));
}

/// A table of the patches that fall short, the worst first.
void print_coverage(const Console& console, const MultiBlock& mesh) {
  const std::vector<Coverage> parts = coverage(mesh);
  std::vector<std::size_t> rows;
  for (std::size_t b = 0; b < parts.size(); ++b) {
    if (parts[b].min < kFullCoverage) rows.push_back(b);
  }
  if (rows.empty() || console.quiet()) return;
  std::ranges::stable_sort(rows, {}, [&](std::size_t b) { return parts[b].mean; });
  int short_nodes = 0;
  for (int n = 0; n < mesh.nodes(); ++n) short_nodes += mesh.coverage(n) < kFullCoverage ? 1 : 0;
  const int copies = mesh.flat ? 2 : 1;
  console.warning(fmt::format("{} of {} nodes stop short of the distance, in {} of {} {}",
                              short_nodes / copies, mesh.nodes() / copies, rows.size(),
                              mesh.blocks.size(), mesh.flat ? "curves" : "patches"));
  const std::size_t shown = console.verbose() ? rows.size() : std::min(rows.size(), kTableRows);
  fmt::print(stderr, "  {:<24} {:<16} {:>8} {:>8}\n", "patch", "family", "mean", "min");
  for (std::size_t row = 0; row < shown; ++row) {
    const Block& block = mesh.blocks[rows[row]];
    fmt::print(stderr, "  {:<24} {:<16} {:8.4f} {:8.4f}\n", block.name, block.family,
               parts[rows[row]].mean, parts[rows[row]].min);
  }
  if (shown < rows.size()) {
    fmt::print(stderr, "  and {} more (--verbose shows all)\n", rows.size() - shown);
  }
}

/// Names the cells that are bad; kBadCells if there are any.
int check_cells(const Console& console, const MeshResult& result) {
  constexpr std::size_t kAllShown = 100;
  const std::uint64_t bad = result.quality.report.nonpositive_cells;
  if (bad == 0) return kDone;
  console.warning(fmt::format("{} of {} cells not positive", bad, result.mesh.cells()));
  if (console.quiet()) return kBadCells;
  const std::vector<CellPlace> cells =
      nonpositive_cells(result.mesh, result.quality, console.verbose() ? kAllShown : kTableRows);
  fmt::print(stderr, "  {:<24} {:>6} {:>6} {:>6} {:>16}\n", "block", "i", "j", "k",
             "scaled Jacobian");
  for (const CellPlace& cell : cells) {
    const std::string& name = result.mesh.blocks[static_cast<std::size_t>(cell.block)].name;
    fmt::print(stderr, "  {:<24} {:>6} {:>6} {:>6} {:>16.3g}\n", name, cell.i + 1, cell.j + 1,
               cell.k + 1, cell.scaled_jacobian);
  }
  if (cells.size() < bad) {
    fmt::print(stderr, "  and {} more; --report lists the first {}\n", bad - cells.size(),
               kAllShown);
  }
  return kBadCells;
}

void write_topology_of(const GivenSurface& given, const MeshResult& result,
                       const Settings& settings) {
  if (settings.topology.empty()) return;
  write_topology(settings.topology, topology_document(given, result.surface, result.mesh));
}

void warn_of_rounding(const Console& console, const std::vector<Output>& outputs) {
  for (const Output& output : outputs) {
    if (output.format != Format::Stl) continue;
    console.note(
        output.file.string() +
        ": STL holds floats, so its points are the blocks' rounded; .obj has them exactly");
  }
}

RunInfo describe_run(const Settings& settings, const std::vector<Output>& outputs) {
  RunInfo run;
  run.command = "mesh";
  for (const Output& output : outputs) run.outputs.push_back(output.file.string());
  if (!settings.topology.empty()) run.outputs.push_back(settings.topology);
  run.options = echo_options(settings, kMesh);
  run.threads = ThreadLimit::in_force();
  return run;
}

}  // namespace

int run_mesh(const Arguments& arguments) {
  const Stopwatch total;
  Settings settings = parse_run(kMesh, arguments);
  const std::vector<Output> outputs = plan_outputs(
      settings, {"mesh",
                 {Format::Plot3d, Format::Plot3dFormatted, Format::NeutralMap, Format::Cgns,
                  Format::Vtk, Format::Vtu, Format::OpenFoam, Format::Su2, Format::Vdb}});
  RunFrame frame(settings);
  const Console& console = frame.console;
  const Progress& progress = frame.progress;

  const Stopwatch reading;
  PolygonUse polygons{.use = SurfaceUse::Layers, .rule = settings.polygons};
  Patches patches = read_surfaces(settings, polygons);
  const double read_seconds = reading.seconds();
  refuse_unfit(patches, outputs, settings);
  for (const std::string& note : settings.input_notes) console.remark(note);
  for (const std::string& warning : polygons.warnings) console.warning(warning);
  note_unit(settings.length_unit, outputs, console);
  const PipelineOptions pipeline = plan_memory(settings, outputs, /*layers=*/true);
  if (settings.dry_run) {
    const Plan plan = plan_mesh(std::move(patches), pipeline, progress);
    refuse_crossed_cells(plan.surface);
    refuse_unwritable(plan.surface, pipeline, outputs, settings);
    print_plan(plan, settings, kMesh);
    return kDone;
  }
  GivenSurface given;
  if (!settings.topology.empty()) given = {patches, pipeline.surface};
  const MeshResult result =
      make_mesh(std::move(patches), pipeline, progress,
                [&](std::string_view stage, const MeshResult& so_far) {
                  frame.bar.clear();
                  print_stage(console, stage, so_far, pipeline.surface.weld);
                  if (stage == "surface") {
                    refuse_unwritable(so_far.surface, pipeline, outputs, settings);
                  }
                  if (stage == "blocks") {
                    warn_of_sides(console, so_far, pipeline.surface);
                    warn_of_crossings(console, so_far);
                  }
                });

  warn_of_rounding(console, outputs);
  const Stopwatch writing;
  RunInfo run = describe_run(settings, outputs);
  const int written = write_all(outputs, result, settings, frame);
  write_topology_of(given, result, settings);
  const double io_seconds = read_seconds + writing.seconds();
  console.stage("io", fmt::format("{}", fmt::join(run.outputs, ", ")), io_seconds);
  const StageTimes& time = result.time;
  run.seconds = {{"surface", time.surface}, {"rasterize", time.rasterize}, {"sweep", time.sweep},
                 {"march", time.march},     {"blocks", time.blocks},       {"io", io_seconds},
                 {"total", total.seconds()}};
  put_report({&result.surface, &result.plan, &result.field, &result.mesh, &result.quality,
              &result.repair, &result.sides, &result.crossings},
             run, settings);
  print_first_cells(console, result.mesh, pipeline);
  print_coverage(console, result.mesh);
  const int cells = check_cells(console, result);
  const int sweep = check_converged(result.field, settings);
  return sweep != kDone ? sweep : std::max(cells, written);
}

}  // namespace vdb_offset::command
