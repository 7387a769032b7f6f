#include "polygon_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/quad_layout.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

/// Of one face alone, as an outline is drawn.
bool is_outline(const PolygonMesh& mesh) {
  constexpr double kFlat = 1e-9;  // of the extent, as read_obj_curves has it
  Box box;
  for (const int corner : mesh.corners)
    box.add(mesh.points_world[static_cast<std::size_t>(corner)]);
  return mesh.faces() == 1 && box.hi.z() - box.lo.z() <= kFlat * box.size();
}

struct CornerCounts {
  std::size_t triangles = 0;
  std::size_t quads = 0;
  std::size_t others = 0;
};

CornerCounts counts_of(const PolygonMesh& mesh) {
  CornerCounts counts;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const std::size_t corners = mesh.face(f).size();
    ++(corners == 3 ? counts.triangles : corners == 4 ? counts.quads : counts.others);
  }
  return counts;
}

/// What cleaning did, by name in JSON and in words; all that is not 0 is worth a word.
struct Repair {
  const char* key;
  const char* words;
  std::size_t count;
  const PolygonFlaw* first = nullptr;  ///< where one is
};

std::vector<Repair> repairs_of(const CleanReport& report) {
  return {
      {"welded_equal", "equal points made one", report.welded_equal},
      {"welded_near", "points welded to near ones", report.welded_near},
      {"unused_points", "points of no face dropped", report.unused_points},
      {"degenerate_faces", "faces of fewer than three points dropped", report.degenerate_faces},
      {"duplicate_faces", "faces that repeat others dropped", report.duplicate_faces},
      {"turned_faces", "faces turned round", report.turned_faces},
      {"turned_parts", "closed parts turned, normals outward", report.turned_parts},
      {"split_polygons", "polygons and concave quads split", report.split_polygons},
      {"crossed_polygons", "of these cross themselves or have no area", report.crossed_polygons},
      {"flipped_triangles", "triangles of no area flipped with the face across",
       report.flipped_triangles},
      {"flat_triangles", "triangles of no area left", report.flat_triangles, &report.first_flat}};
}

std::string words_of(const std::vector<Repair>& repairs) {
  std::vector<std::string> words;
  for (const Repair& repair : repairs) {
    if (repair.count == 0) continue;
    words.push_back(fmt::format("{} {}", repair.count, repair.words));
    if (repair.first == nullptr) continue;
    const Vec3& from = repair.first->from_world;
    const Vec3& to = repair.first->to_world;
    words.back() +=
        fmt::format(" (the first from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}))",
                    from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

struct Flaws {
  const char* key;
  const char* words;
  const std::vector<PolygonFlaw>* list;
};

std::array<Flaws, 4> flaws_of(const CleanReport& report) {
  return {{{"crossed_faces", "faces that cross themselves", &report.crossed_faces},
           {"many_faced_edges", "edges of more than two faces", &report.many_faced_edges},
           {"many_fan_points", "points where parts touch", &report.many_fan_points},
           {"twisted_edges", "parts of one side only", &report.twisted_edges}}};
}

Json to_json(const Vec3& p) { return Json::array({p.x(), p.y(), p.z()}); }

Json to_json(const std::vector<PolygonFlaw>& flaws) {
  constexpr std::size_t kShown = 20;
  Json out = {{"count", flaws.size()}, {"first", Json::array()}};
  for (std::size_t n = 0; n < std::min(flaws.size(), kShown); ++n) {
    out["first"].push_back({{"from", to_json(flaws[n].from_world)},
                            {"to", to_json(flaws[n].to_world)},
                            {"count", flaws[n].count}});
    if (flaws[n].face > 0) out["first"].back()["face"] = flaws[n].face;
  }
  return out;
}

Json to_json(const CornerCounts& counts) {
  return {{"triangles", counts.triangles}, {"quads", counts.quads}, {"others", counts.others}};
}

Box box_of(const PolygonMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.points_world) box.add(p);
  return box;
}

Json to_json(const PolygonMesh& mesh, const CleanedPolygons& cleaned) {
  const CleanReport& report = cleaned.report;
  const Box box = box_of(cleaned.mesh);
  Json surface = {{"points", cleaned.mesh.points_world.size()},
                  {"faces", cleaned.mesh.faces()},
                  {"corners", to_json(counts_of(cleaned.mesh))},
                  {"components", report.parts},
                  {"closed_components", report.closed_parts},
                  {"closed", report.boundary_edges == 0},
                  {"boundary_edges", report.boundary_edges},
                  {"manifold", report.is_manifold()},
                  {"bounds", {{"min", to_json(box.lo)}, {"max", to_json(box.hi)}}},
                  {"area", report.area_world},
                  {"repairs", Json::object()}};
  for (const Repair& repair : repairs_of(report)) surface["repairs"][repair.key] = repair.count;
  surface["repairs"]["moved_max"] = report.moved_max_world;
  if (report.flat_triangles > 0) {
    surface["repairs"]["first_flat"] = {{"from", to_json(report.first_flat.from_world)},
                                        {"to", to_json(report.first_flat.to_world)}};
  }
  for (const Flaws& flaws : flaws_of(report)) surface[flaws.key] = to_json(*flaws.list);
  return {{"polygons",
           {{"points", mesh.points_world.size()},
            {"faces", mesh.faces()},
            {"corners", to_json(counts_of(mesh))},
            {"counted_from_one", mesh.counted_from_one},
            {"families", mesh.families}}},
          {"surface", std::move(surface)}};
}

std::string families_line(const PolygonMesh& mesh) {
  constexpr std::size_t kShown = 12;
  if (mesh.families.empty()) return {};
  const std::size_t count = mesh.families.size();
  const auto end = mesh.families.begin() + static_cast<std::ptrdiff_t>(std::min(count, kShown));
  return fmt::format("families   {}{}\n",
                     fmt::join(std::vector<std::string>(mesh.families.begin(), end), ", "),
                     count > kShown ? fmt::format(" and {} more", count - kShown) : "");
}

std::string faces_in_words(const PolygonMesh& mesh) {
  const CornerCounts counts = counts_of(mesh);
  return fmt::format("{} points, {} faces: {} triangles, {} quads, {} others",
                     mesh.points_world.size(), mesh.faces(), counts.triangles, counts.quads,
                     counts.others);
}

std::string to_lines(const PolygonMesh& mesh, const CleanedPolygons& cleaned) {
  const CleanReport& report = cleaned.report;
  const Box box = box_of(cleaned.mesh);
  const std::string repairs = words_of(repairs_of(report));
  std::string out = fmt::format("polygons   {}\n{}", faces_in_words(mesh), families_line(mesh));
  out += fmt::format("repairs    {}\n", repairs.empty() ? "none are needed" : repairs);
  out += fmt::format("surface    {}\n", faces_in_words(cleaned.mesh));
  out += fmt::format("           {}, {} boundary edges, {} component{}, {} of them closed\n",
                     report.boundary_edges == 0 ? "closed" : "open", report.boundary_edges,
                     report.parts, report.parts == 1 ? "" : "s", report.closed_parts);
  for (const Flaws& flaws : flaws_of(report)) {
    if (flaws.list->empty()) continue;
    const Vec3& at = flaws.list->front().from_world;
    out += fmt::format("flaw       {} {}, the first at ({:.6g}, {:.6g}, {:.6g}): no layers\n",
                       flaws.list->size(), flaws.words, at.x(), at.y(), at.z());
  }
  out += fmt::format("bounds     ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n",
                     box.lo.x(), box.lo.y(), box.lo.z(), box.hi.x(), box.hi.y(), box.hi.z());
  return out + fmt::format("area       {:.6g}\n", report.area_world);
}

bool is_all_quads(const PolygonMesh& mesh) {
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    if (mesh.face(f).size() != 4) return false;
  }
  return mesh.faces() > 0;
}

/// The numbers of faces, family by family as `face_patches` has them.
void add_numbers(const PolygonMesh& read, const CleanedPolygons& cleaned, PolygonUse& use) {
  std::vector<std::vector<int>> of_family(std::max<std::size_t>(cleaned.mesh.families.size(), 1));
  for (std::size_t f = 0; f < cleaned.mesh.faces(); ++f) {
    of_family[static_cast<std::size_t>(cleaned.mesh.family_of(f))].push_back(use.next_number +
                                                                             cleaned.numbers[f]);
  }
  for (std::vector<int>& numbers : of_family) {
    if (!numbers.empty()) use.face_numbers.push_back(std::move(numbers));
  }
  use.next_number += static_cast<int>(read.faces());
}

}  // namespace

std::optional<PolygonMesh> read_obj_surface(const std::string& file,
                                            std::vector<std::string>& notes,
                                            std::vector<std::string>& warnings) {
  const ObjContents contents = inspect_obj(file);
  if (contents.free_forms > 0) {
    const std::string where =
        fmt::format("{}, line {}: a free form ('surf' or 'curv')", file, contents.free_form_line);
    if (contents.faces == 0 && contents.lines == 0) {
      throw IoError(where + ", and nothing else; write polygons, or a STEP file");
    }
    warnings.push_back(
        fmt::format("{}, of {} in the file: they are left out, polygons and lines alone are read",
                    where, contents.free_forms));
  }
  if (contents.faces == 0) return {};
  PolygonMesh mesh = read_polygons(file, PolygonFormat::Obj);
  if (contents.lines == 0 && is_outline(mesh)) return {};
  if (contents.lines > 0) {
    notes.push_back(fmt::format("{}: holds {} faces and {} lines; the faces are taken", file,
                                contents.faces, contents.lines));
  }
  return mesh;
}

Patches patches_of(const PolygonMesh& mesh, PolygonUse& use, std::vector<std::string>& notes) {
  const bool as_blocks = use.use == SurfaceUse::Layers && use.rule != PolygonRule::Columns &&
                         (use.rule == PolygonRule::Blocks || is_all_quads(mesh));
  const CleanOptions options{.weld = use.weld,
                             .weld_free_alone = use.use == SurfaceUse::Distance,
                             .split_concave_quads = !as_blocks};
  const CleanedPolygons cleaned = clean_polygons(mesh, options);
  if (cleaned.report.moved_max_world > use.moved_max_world) {
    use.moved_max_world = cleaned.report.moved_max_world;
    use.moved_farthest_world = cleaned.report.moved_farthest_world;
  }
  if (use.use == SurfaceUse::Layers && !cleaned.report.is_meshable()) {
    refuse_unmeshable(cleaned.mesh, cleaned.report, weld_advice(mesh, options));
  }
  use.is_soup = use.is_soup || !cleaned.report.is_manifold();
  use.faces += cleaned.mesh.faces();
  use.open_edges += cleaned.report.boundary_edges;
  const std::string repairs = words_of(repairs_of(cleaned.report));
  if (!repairs.empty()) notes.push_back(fmt::format("{}: {}", mesh.file, repairs));
  const bool is_left = use.rule == PolygonRule::Blocks || is_all_quads(cleaned.mesh);
  if (!as_blocks || !is_left) {
    add_numbers(mesh, cleaned, use);
    return face_patches(cleaned.mesh);
  }
  QuadLayout layout = quad_layout(cleaned.mesh);
  notes.push_back(fmt::format("{}: {} quads in {} structured patches, {} irregular points",
                              mesh.file, cleaned.mesh.faces(), layout.patches.size(),
                              layout.report.irregular_vertices));
  return std::move(layout.patches);
}

SideRule side_rule(SignRule sign, const PolygonUse& read, std::vector<std::string>& notes) {
  switch (sign) {
    case SignRule::Winding:
      return SideRule::Winding;
    case SignRule::Unsigned:
      return SideRule::Unsigned;
    case SignRule::Closed:
      if (!read.is_soup) return SideRule::Manifold;
      throw InputError(
          "--sign closed: faces meet as those of no closed surface do ('info' shows where); mend "
          "them, or take winding or unsigned");
    case SignRule::Auto:
      break;
  }
  if (!read.is_soup) return SideRule::Manifold;
  // With gaps as wide as that winding numbers tell little.
  constexpr std::size_t kMostOpen = 20;
  const bool is_nearly_closed = read.open_edges * kMostOpen <= read.faces;
  notes.push_back(fmt::format(
      "sign: {}, for faces meet as those of no surface with two sides do, and {} edges are open "
      "beside {} faces; --sign chooses otherwise",
      is_nearly_closed ? "by winding numbers" : "none", read.open_edges, read.faces));
  return is_nearly_closed ? SideRule::Winding : SideRule::Unsigned;
}

std::string describe_polygons(const PolygonMesh& mesh, PolygonFormat format, bool json) {
  const CleanedPolygons cleaned = clean_polygons(mesh);
  if (!json) {
    return fmt::format("file       {}\nformat     {}: polygons\n", mesh.file, describe(format)) +
           to_lines(mesh, cleaned);
  }
  std::string name = describe(format);
  for (char& c : name) c = static_cast<char>(c - 'A' + 'a');
  Json out = {{"file", mesh.file}, {"format", name}};
  out.update(to_json(mesh, cleaned));
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vdb_offset::command
