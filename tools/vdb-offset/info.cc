#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"
#include "exit_codes.h"
#include "gap_words.h"
#include "inputs.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/surface/surface.h"
#include "volume_input.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

/// OpenVDB files begin with this number, little-endian, in eight bytes.
bool is_vdb(const std::string& file) {
  constexpr std::array<char, 4> kMagic{' ', 'B', 'D', 'V'};
  std::array<char, 4> start{};
  std::ifstream(file, std::ios::binary).read(start.data(), start.size());
  return start == kMagic;
}

bool is_surface(const Plot3dInfo& info) {
  return std::ranges::all_of(
      info.blocks, [](const Plot3dBlockSize& b) { return b.ni == 1 || b.nj == 1 || b.nk == 1; });
}

Json to_json(const Vec3& p) { return Json::array({p.x(), p.y(), p.z()}); }

Json to_json(const Surface& surface) {
  const Box& box = surface.wall->bounds();
  return {{"patches", surface.patches.size()},
          {"points", surface.points()},
          {"nodes", surface.nodes_world.size()},
          {"faces", surface.faces()},
          {"components", surface.topology.components},
          {"closed", surface.closed},
          {"free_edges", surface.free_edges()},
          {"flipped", surface.report.flipped.size()},
          {"bounds", {{"min", to_json(box.lo)}, {"max", to_json(box.hi)}}},
          {"area", surface.wall->area()},
          {"shortest_edge", surface.report.shortest_edge_world},
          {"median_edge", surface.report.median_edge_world}};
}

void print_surface(const Surface& surface) {
  const Box& box = surface.wall->bounds();
  fmt::print("surface    {} patches, {} points, {} nodes, {} faces, {} component{}\n",
             surface.patches.size(), surface.points(), surface.nodes_world.size(), surface.faces(),
             surface.topology.components, surface.topology.components == 1 ? "" : "s");
  fmt::print("           {}, {} free edges, {} patches turned round\n",
             surface.closed ? "closed" : "open", surface.free_edges(),
             surface.report.flipped.size());
  if (const std::string gaps = gaps_in_words(surface, SurfaceOptions().weld); !gaps.empty()) {
    fmt::print("           {}\n", gaps);
  }
  fmt::print("bounds     ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", box.lo.x(),
             box.lo.y(), box.lo.z(), box.hi.x(), box.hi.y(), box.hi.z());
  fmt::print("edges      shortest {:.6g}, median {:.6g}; area {:.6g}\n",
             surface.report.shortest_edge_world, surface.report.median_edge_world,
             surface.wall->area());
}

void print_plot3d(const std::string& file, const Plot3dHint& hint) {
  const Plot3dInfo info = inspect_plot3d(file, hint);
  fmt::print("file       {}\nformat     PLOT3D: {}\n", file, info.dialect.describe());
  for (std::size_t b = 0; b < info.blocks.size(); ++b) {
    const Plot3dBlockSize& size = info.blocks[b];
    fmt::print("block {:<4} {} x {} x {}\n", b + 1, size.ni, size.nj, size.nk);
  }
  if (!is_surface(info)) return;
  const Patches patches = read_plot3d(file, hint);
  if (are_curves(patches)) {
    fmt::print("{}", describe_curves(patches));
  } else {
    print_surface(build_surface(patches));
  }
}

void print_plot3d_json(const std::string& file, const Plot3dHint& hint) {
  const Plot3dInfo info = inspect_plot3d(file, hint);
  Json out = {{"file", file},
              {"format", "plot3d"},
              {"dialect", info.dialect.describe()},
              {"blocks", Json::array()}};
  for (const Plot3dBlockSize& size : info.blocks) {
    out["blocks"].push_back({{"ni", size.ni}, {"nj", size.nj}, {"nk", size.nk}});
  }
  if (is_surface(info)) {
    const Patches patches = read_plot3d(file, hint);
    if (are_curves(patches)) {
      out["curves"] = Json::parse(curves_json(patches));
    } else {
      out["surface"] = to_json(build_surface(patches));
    }
  }
  fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
}

void print_polygons_or_curves(const std::string& file, const InputFormat& format, bool json) {
  std::vector<std::string> notes;
  const std::optional<PolygonMesh> mesh = format.polygons(file, notes, notes);
  if (!mesh) {
    fmt::print("{}", describe_curves_file(file, InputKind::Obj, json));
    return;
  }
  fmt::print("{}", describe_polygons(*mesh, format.polygon_format(file), json));
  for (const std::string& note : notes) fmt::print("{}", json ? "" : "note       " + note + "\n");
}

void print_cgns(const std::string& file) {
  const CgnsInfo info = inspect_cgns(file);
  fmt::print("{}", cgns_lines(file, info));
  if (info.is_unstructured()) return fmt::print("{}", cell_lines(read_cgns_cells(file)));
  if (info.is_surface()) return print_surface(build_surface(read_cgns(file)));
  std::size_t cells = 0;
  for (const CgnsZoneInfo& zone : info.zones) cells += cells_of(zone);
  fmt::print("volume     {} zones, {} cells\n", info.zones.size(), cells);
}

void print_cad(const std::string& file, const InputFormat& format, bool json) {
  PolygonUse use;
  std::vector<std::string> notes;
  const Patches patches = format.read(file, use, notes);
  const Surface surface = build_surface(patches);
  if (json) {
    const Json out = {{"file", file},
                      {"format", "cad"},
                      {"length_unit", use.length_unit},
                      {"notes", notes},
                      {"warnings", use.warnings},
                      {"families", cad_families(patches)},
                      {"surface", to_json(surface)}};
    return fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
  }
  fmt::print("file       {}\nformat     CAD (STEP, IGES or BREP)\n", file);
  for (const std::string& note : notes) fmt::print("note       {}\n", note);
  for (const std::string& warning : use.warnings) fmt::print("warning    {}\n", warning);
  const std::vector<std::string> families = cad_families(patches);
  if (!families.empty()) fmt::print("families   {}\n", fmt::join(families, ", "));
  print_surface(surface);
}

void print_topology(const std::string& file, bool json) {
  const TopologyDocument document = read_topology(file);
  SurfaceOptions options;
  const Patches patches = patches_of(document, options);
  if (!json) {
    fmt::print("{}", topology_lines(file, document));
    if (patches.empty()) return;
    if (are_curves(patches)) return fmt::print("{}", describe_curves(patches));
    return print_surface(build_surface(patches, options));
  }
  Json out = Json::parse(topology_json(file, document));
  if (are_curves(patches)) {
    out["curves"] = Json::parse(curves_json(patches));
  } else {
    out["surface"] = to_json(build_surface(patches, options));
  }
  fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
}

void print_cgns_json(const std::string& file) {
  const CgnsInfo info = inspect_cgns(file);
  Json out = Json::parse(cgns_json(file, info));
  if (info.is_unstructured()) out.update(cells_json(read_cgns_cells(file)));
  if (info.is_surface()) out["surface"] = to_json(build_surface(read_cgns(file)));
  fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

int run_info(const Arguments& arguments) {
  CLI::App app(
      "What is in a file: PLOT3D, CGNS, polygons (.stl, .obj, .ply, .off), CAD (.step, .iges, "
      ".brep), a neutral map (.nmf), "
      "an airfoil (.dat), curves (.obj), a topology document (.json), VTK (.vtm, .vts, .vtu), SU2, "
      "an "
      "OpenFOAM case or OpenVDB.",
      "vdb-offset info");
  std::string file;
  std::string input_format;
  bool json = false;
  app.add_option("FILE", file, "The file.")->required()->type_name("");
  app.add_option("--input-format", input_format, "As for mesh.")->type_name("WORDS");
  CadOptions cad;
  CLI::Option* const size =
      app.add_option("--surface-size", cad.size_world, "As for mesh: longest edge on CAD models.")
          ->type_name("L");
  app.add_flag("--json", json, "The same as JSON.");
  parse(app, arguments);
  if (is_vdb(file)) {
    fmt::print("{}", describe_vdb(file, json));
    return kDone;
  }
  const InputFormat format(input_format, cad);
  const InputKind kind = format.kind_of(file);
  if (size->count() > 0 && !(cad.size_world > 0)) {
    throw InputError(fmt::format("--surface-size = {}, but must be > 0", cad.size_world));
  }
  if (size->count() > 0 && kind != InputKind::Cad) {
    throw InputError(file + ": --surface-size is for CAD models");
  }
  if (kind != InputKind::Topology && !is_vtk(kind)) {
    refuse_strangers(
        file,
        "info reads PLOT3D grids, CGNS (.cgns), polygons (.stl, .obj, .ply, .off), "
        "neutral maps (.nmf), airfoils (.dat), curves (.obj), topology documents "
        "(.json), VTK (.vtm, .vts, .vtu), SU2 (.su2), cases of OpenFOAM and OpenVDB files "
        "(.vdb) only");
  }
  if (kind == InputKind::Cgns) {
    json ? print_cgns_json(file) : print_cgns(file);
  } else if (kind == InputKind::Cad) {
    print_cad(file, format, json);
  } else if (kind == InputKind::Topology) {
    print_topology(file, json);
  } else if (kind == InputKind::Vtk || is_unstructured(kind)) {
    fmt::print("{}", describe_volume(file, kind, json));
  } else if (kind == InputKind::NeutralMap) {
    fmt::print("{}", describe_neutral_map(file, json));
  } else if (kind == InputKind::Obj || kind == InputKind::Polygons) {
    print_polygons_or_curves(file, format, json);
  } else if (kind != InputKind::Plot3d) {
    fmt::print("{}", describe_curves_file(file, kind, json));
  } else {
    json ? print_plot3d_json(file, format.hint()) : print_plot3d(file, format.hint());
  }
  return kDone;
}

}  // namespace vdb_offset::command
