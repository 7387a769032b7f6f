#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <span>

#include "boundary_lines.h"
#include "command.h"
#include "config_file.h"
#include "exit_codes.h"
#include "inputs.h"
#include "interrupt.h"
#include "surface_options.h"
#include "vdb_offset/core/units.h"
#include "vdb_offset/rasterize/thin_parts.h"
#include "vdb_offset/surface/overlaps.h"

namespace vdb_offset::command {
namespace {

const char* rule_in_words(VoxelRule rule) {
  switch (rule) {
    case VoxelRule::Given:
      return "as given";
    case VoxelRule::Distance:
      return "a twelfth of the distance";
    case VoxelRule::SurfaceEdge:
      return "median surface edge";
    case VoxelRule::Memory:
      return "enlarged to fit the memory";
  }
  return "";
}

std::string surface_figures(const Surface& surface) {
  const int free = surface.free_edges();
  if (surface.flat) {
    return fmt::format("{} curve{}, {} points, {} cells, in two dimensions", surface.patches.size(),
                       surface.patches.size() == 1 ? "" : "s", surface.points() / 2,
                       surface.faces());
  }
  return fmt::format("{} patches, {} points, {} nodes, {} faces, {}", surface.patches.size(),
                     surface.points(), surface.nodes_world.size(), surface.faces(),
                     (free == 0 ? "closed" : fmt::format("open ({} free edges)", free)) +
                         (surface.winding ? ", sides by winding numbers" : ""));
}

/// A voxel that had no distance yet falls from a number that means nothing.
std::string last_change(const SweepReport& sweep) {
  return reached_new_voxels(sweep)
             ? "last change: voxels reached for the first time"
             : fmt::format("last change {:.2g} voxels", sweep.last_change_voxels);
}

void print_sweep(const Console& console, const SweepReport& sweep, double seconds) {
  console.stage("sweep",
                fmt::format("{} voxels, {} sweeps, {}{}", sweep.active_voxels, sweep.sweeps,
                            last_change(sweep), sweep.converged ? "" : ", NOT SETTLED"),
                seconds);
  const double visits = static_cast<double>(sweep.tile_visits) * 512;
  if (visits > 0) {
    console.note(fmt::format("{} tile visits, {:.1f} ns each voxel visited", sweep.tile_visits,
                             1e9 * seconds / visits));
  }
}

/// One line, shortened unless --verbose asks for all names.
void print_flipped(const Console& console, const Surface& surface) {
  constexpr std::size_t kShown = 6;
  const std::vector<int>& flipped = surface.report.flipped;
  if (flipped.empty()) return;
  const std::size_t shown = console.verbose() ? flipped.size() : std::min(flipped.size(), kShown);
  std::vector<std::string> names;
  for (std::size_t n = 0; n < shown; ++n) {
    names.push_back(surface.patches[static_cast<std::size_t>(flipped[n])].name);
  }
  const std::size_t hidden = flipped.size() - shown;
  const int parts = surface.report.turned_parts;
  console.remark(fmt::format(
      "{} of {} patches turned round to agree with their neighbours{}: {}{}", flipped.size(),
      surface.patches.size(),
      parts == 0 ? "" : fmt::format(", and {} closed part{} outward", parts, parts == 1 ? "" : "s"),
      fmt::join(names, ", "), hidden > 0 ? fmt::format(" and {} more", hidden) : ""));
}

/// What became of sharp edges.
void print_fans(const Console& console, const Surface& surface) {
  const SurfaceReport& report = surface.report;
  if (report.fans == 0) return;
  console.remark(fmt::format(
      "sharp edges opened: {} fans, {} corners{}", report.fans, report.fan_corners,
      report.split_patches > 0
          ? fmt::format("; {} pieces more, of patches split along them", report.split_patches)
          : ""));
}

/// Parts of the body that the voxels do not see, thinnest first.
void print_thin(const Console& console, const Surface& surface, double voxel_world) {
  constexpr std::size_t kShown = 3;
  std::vector<ThinPart> parts = thin_parts(surface, voxel_world);
  if (parts.empty()) return;
  std::ranges::stable_sort(parts, {}, &ThinPart::thickness_world);
  std::vector<std::string> words;
  for (std::size_t p = 0; p < std::min(parts.size(), kShown); ++p) {
    const ThinPart& part = parts[p];
    words.push_back(fmt::format(
        "'{}' ({:.3g} at {}, {} cells)", surface.patches[static_cast<std::size_t>(part.patch)].name,
        part.thickness_world, in_words(part.place_world, surface.flat), part.cells));
  }
  const std::size_t hidden = parts.size() - words.size();
  console.remark(fmt::format(
      "thinner than two voxels: {}{}; distances are exact there, but no voxel need lie within; "
      "--voxel {:.3g} sees it",
      fmt::join(words, ", "), hidden > 0 ? fmt::format(" and {} patches more", hidden) : "",
      parts.front().thickness_world / 2));
}

void check_ranges(const CLI::App& app, const Settings& settings) {
  const bool threads_fit = settings.threads >= 1 && settings.threads <= 1024;
  if (app.count("--threads") > 0 && !threads_fit) {
    throw InputError(fmt::format("--threads = {}, but must be in [1, 1024]", settings.threads));
  }
  if (app.count("--voxel") > 0 && !(settings.pipeline.rasterize.voxel_world > 0)) {
    throw InputError(fmt::format("--voxel = {}, but must be > 0; leave it out to have it chosen",
                                 settings.pipeline.rasterize.voxel_world));
  }
  if (app.count("--surface-size") > 0 && !(settings.cad.size_world > 0)) {
    throw InputError(
        fmt::format("--surface-size = {}, but must be > 0; leave it out to have it chosen",
                    settings.cad.size_world));
  }
  settings.pipeline.validate();
}

/// Options that are small languages; files that they name are read later.
void parse_texts(Settings& settings) {
  for (const std::string& text : settings.planes) {
    settings.pipeline.surface.planes.push_back(parse_plane(text));
  }
  for (const std::string& text : settings.shapes) parse_shape("--boundary", text);
  for (const std::string& text : settings.internals) parse_shape("--internal", text);
  for (const std::string& text : settings.families) {
    settings.pipeline.march.families.push_back(parse_family(text));
  }
  settings.pipeline.march.splay = radians(settings.splay_degrees);
  for (const std::string& text : settings.conditions) {
    settings.pipeline.conditions.named.push_back(parse_named_condition(text));
  }
}

}  // namespace

void parse(CLI::App& app, Arguments arguments) {
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
    throw;
  }
}

Settings parse_run(CommandBit command, const Arguments& arguments) {
  const bool mesh = command == kMesh;
  CLI::App app(mesh ? "Hexahedral layers near a wall, as face-matching blocks."
                    : "Distance to a wall, as an OpenVDB grid.",
               mesh ? "vdb-offset mesh" : "vdb-offset field");
  Settings settings;
  add_options(app, settings, command);
  app.config_formatter(config_reader(app, settings, command));
  parse(app, arguments);

  if (settings.surfaces.empty()) throw CLI::RequiredError("SURFACE: a surface file");
  if (app.count("--distance") == 0) throw CLI::RequiredError("--distance");
  if (settings.outputs.empty() && !settings.dry_run) throw CLI::RequiredError("-o FILE");
  try {
    parse_texts(settings);
    check_ranges(app, settings);
  } catch (const InputError& error) {
    throw InputError(with_config_place(error.what(), settings));
  }
  return settings;
}

struct ThreadLimit::Control {
  explicit Control(std::size_t threads)
      : limit(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control limit;  // made in place: a copy that is destroyed lifts the limit
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads <= 0) return;
  control_ = std::make_unique<Control>(static_cast<std::size_t>(threads));
}

ThreadLimit::~ThreadLimit() = default;

int ThreadLimit::in_force() {
  using tbb::global_control;
  return static_cast<int>(global_control::active_value(global_control::max_allowed_parallelism));
}

RunFrame::RunFrame(const Settings& settings)
    : console(settings.quiet, settings.verbose), threads(settings.threads), bar(!settings.quiet) {
  progress.report = [this](std::string_view stage, double part) { bar.update(stage, part); };
  progress.cancel = catch_interrupts();
}

void print_plan(const Plan& plan, const Settings& settings, CommandBit command) {
  const BandPlan& band = plan.band;
  fmt::print("surface    {}\n", surface_figures(plan.surface));
  fmt::print("voxel      {:.6g} ({})\n", band.voxel_world, rule_in_words(band.rule));
  fmt::print("band       {} leaf tiles at most, {}\n", band.tiles,
             format_bytes(static_cast<double>(band.bytes)));
  if (command == kMesh) {
    const LayerSpacing& s = plan.spacing;
    std::size_t cells = 0;
    for (const Patch& patch : plan.surface.patches) {
      cells += patch.cells() * static_cast<std::size_t>(s.layers);
    }
    fmt::print(
        "spacing    {} layers, first cell {:.6g}, last cell {:.6g}, growth {:.6g}{}\n", s.layers,
        s.first_cell_world, s.last_cell_world, s.growth,
        s.growth_requested > 0 ? fmt::format(" (requested {:.6g})", s.growth_requested) : "");
    fmt::print("blocks     {} blocks, {} cells\n", plan.surface.patches.size(), cells);
  }
  fmt::print("memory     {} expected, {} allowed\n",
             format_bytes(static_cast<double>(band.total_bytes)),
             format_bytes(static_cast<double>(band.limit_bytes)));
  if (settings.verbose) {
    for (const Patch& patch : plan.surface.patches) {
      fmt::print("patch      {}: {}\n", patch.name,
                 patch.is_grid() ? fmt::format("{} x {}", patch.ni, patch.nj)
                                 : fmt::format("{} polygons", patch.faces.size()));
    }
  }
}

std::string in_words(const Vec3& place_world, bool flat) {
  const Vec3& p = place_world;
  return flat ? fmt::format("({:.6g}, {:.6g})", p.x(), p.y())
              : fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string overlaps_in_words(const Surface& surface) {
  constexpr std::size_t kShown = 3;
  const std::vector<Overlap> overlaps = find_overlaps(surface);
  std::vector<std::string> words;
  for (const Overlap& overlap : std::span(overlaps).first(std::min(overlaps.size(), kShown))) {
    words.push_back(fmt::format("one of '{}' within one of '{}' ({} face{}, the first at {})",
                                surface.patches[static_cast<std::size_t>(overlap.patch)].name,
                                surface.patches[static_cast<std::size_t>(overlap.other)].name,
                                overlap.faces, overlap.faces == 1 ? "" : "s",
                                in_words(overlap.place_world, surface.flat)));
  }
  if (words.empty()) return {};
  if (overlaps.size() > kShown) words.push_back(fmt::format("{} more", overlaps.size() - kShown));
  return fmt::format("closed parts overlap: {}", fmt::join(words, ", "));
}

void print_field_stage(const Console& console, std::string_view stage, const FieldResult& result) {
  if (stage == "surface") {
    console.stage("surface", surface_figures(result.surface), result.time.surface);
    print_flipped(console, result.surface);
    print_fans(console, result.surface);
    print_boundaries(console, result.surface);
  } else if (stage == "rasterize") {
    console.stage(
        "rasterize",
        fmt::format("voxel {:.6g} ({}), at most {} leaf tiles and {}", result.plan.voxel_world,
                    rule_in_words(result.plan.rule), result.plan.tiles,
                    format_bytes(static_cast<double>(result.plan.bytes))),
        result.time.rasterize);
    print_thin(console, result.surface, result.plan.voxel_world);
  } else if (stage == "sweep") {
    print_sweep(console, result.field.report, result.time.sweep);
  }
}

int check_converged(const DistanceField& field, const Settings& settings) {
  if (field.report.converged) return kDone;
  const SweepReport& sweep = field.report;
  const std::string why =
      reached_new_voxels(sweep)
          ? "the last round still reached voxels for the first time; raise --max-sweeps"
          : fmt::format(
                "the last round moved a voxel by {:.3g} voxels (tolerance {:.3g}); raise "
                "--max-sweeps or --sweep-tolerance",
                sweep.last_change_voxels, settings.pipeline.sweep.tolerance_voxels);
  Console::error(fmt::format("the sweep had not settled after {} sweep{}: {}", sweep.sweeps,
                             sweep.sweeps == 1 ? "" : "s", why));
  return kLimit;
}

void put_report(const ReportParts& parts, const RunInfo& run, const Settings& settings) {
  if (settings.report.empty()) return;
  const std::string text = report_json(parts, run);
  if (settings.report == "-") return fmt::print("{}", text);
  write_report(settings.report, text);
}

}  // namespace vdb_offset::command
