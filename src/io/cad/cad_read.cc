#include <fmt/format.h>

#include <Standard_Failure.hxx>
#include <algorithm>
#include <iterator>
#include <set>

#include "io/cad/cad_file.h"
#include "io/cad/face_grid.h"
#include "io/cad/face_triangles.h"
#include "io/cad/model_flaws.h"
#include "io/cad_bytes.h"
#include "io/cad_module.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset::cad {
namespace {

void count_points(const std::vector<Plan>& plans, const SharedEdges& edges,
                  const std::string& file) {
  constexpr double kMost = 1e8;
  double points = 0;
  for (const Plan& plan : plans) {
    double cells = 1;
    for (const Side& side : plan.sides) cells = std::max(cells, double(cells_of(side, edges)));
    points += cells * (plan.sides.size() > 1 ? cells_of(plan.sides[1], edges) : cells);
  }
  if (points <= kMost) return;
  throw InputError(fmt::format(
      "{}: its faces would have some {:.2g} points, more than {:.0e}; take a larger --surface-size",
      file, points, kMost));
}

/// The face's patches, counted in the report.
std::vector<Patch> patches_of(const Face& face, Plan& plan, const SharedEdges& edges,
                              const CadOptions& options, CadReport& report) {
  std::vector<Patch> patches = grids_of(face, plan, edges);
  if (patches.empty()) {
    patches.push_back(triangles_of(face, edges, options));
    ++report.triangulated;
  } else {
    ++(patches.size() == 1 ? report.four_sided : report.split);
  }
  return patches;
}

/// The face's own name, or its number, or that with what a face is the next part of.
std::string unique_name(const NamedFace& face, std::set<std::string>& taken) {
  if (!face.name.empty() && taken.insert(face.name).second) return face.name;
  std::string name = fmt::format("face {}", face.number);
  for (int n = 2; !taken.insert(name).second; ++n) name = fmt::format("face {}-{}", face.number, n);
  return name;
}

/// Lengths of the file to those of the unit, where both are known.
void convert(Model& model, const std::string& unit, CadReport& report) {
  report.unit = report.file_unit;
  if (unit.empty() || report.file_unit.empty() || unit == report.file_unit) return;
  model.world_per_cad *= length_of(report.file_unit).mm / length_of(unit).mm;
  report.unit = unit;
}

CadSurface read(const std::string& file, CadOptions options) {
  CadSurface out;
  Model model = read_model(file, out.report);
  convert(model, options.unit, out.report);
  std::ranges::move(flaws_of(model), std::back_inserter(out.report.flaws));
  constexpr double kEdges = 50;
  if (options.size_world == 0) options.size_world = model.size_cad * model.world_per_cad / kEdges;
  options.size_world = std::min(options.size_world, model.size_cad * model.world_per_cad);
  out.report.size_world = options.size_world;
  SharedEdges edges(model, options);
  std::vector<Face> faces;
  std::vector<Plan> plans;
  for (const NamedFace& named : model.faces) {
    faces.emplace_back(named, edges, model.world_per_cad);
    plans.push_back(plan_face(faces.back(), edges));
  }
  settle_cells(faces, plans, edges, options);
  count_points(plans, edges, file);
  edges.place_nodes(model);
  std::set<std::string> names;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::string name = unique_name(*faces[f].named, names);
    std::vector<Patch> patches = patches_of(faces[f], plans[f], edges, options, out.report);
    for (std::size_t p = 0; p < patches.size(); ++p) {
      Patch& patch = patches[p];
      patch.name = patches.size() == 1 ? name : fmt::format("{}.{}", name, p + 1);
      patch.family = faces[f].named->family;
      patch.file = file;
      patch.body = faces[f].named->body;
      if (patch.cells() == 0 || patch.points_world.empty()) {
        throw InputError(fmt::format(
            "{}: {} has no area, or loops that cross as they are divided; take a smaller "
            "--surface-size, or mend it in a CAD program",
            file, name));
      }
      out.patches.push_back(std::move(patch));
    }
  }
  return out;
}

}  // namespace

void vdb_offset_cad_read(const std::string& file, const CadOptions& options, std::string& bytes) {
  try {
    bytes = to_bytes(read(file, options));
  } catch (const Standard_Failure& failure) {
    throw IoError(
        fmt::format("{}: OpenCASCADE fails on its shapes: {}", file, failure.GetMessageString()));
  }
}

}  // namespace vdb_offset::cad
