// Options of the surface stage, and what their texts mean.

#include "surface_options.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string_view>

#include "command.h"
#include "option_binding.h"

namespace vdb_offset::command {
namespace {

void parse_side(Settings& settings, const std::string& text) {
  if (text == "along") {
    settings.pipeline.surface.side = MarchSide::Along;
  } else if (text == "against") {
    settings.pipeline.surface.side = MarchSide::Against;
  } else if (text == "both") {
    settings.pipeline.surface.side = MarchSide::Both;
  } else {
    throw InputError(fmt::format("'{}' is not along, against or both", text));
  }
}

OptionValue echo_side(const Settings& settings) {
  switch (settings.pipeline.surface.side) {
    case MarchSide::Along:
      return std::string("along");
    case MarchSide::Against:
      return std::string("against");
    case MarchSide::Both:
      break;
  }
  return std::string("both");
}

constexpr std::array<std::pair<const char*, OpenEdges>, 3> kOpenEdges{
    {{"auto", OpenEdges::Auto}, {"splay", OpenEdges::Splay}, {"refuse", OpenEdges::Refuse}}};

void parse_open_edges(Settings& settings, const std::string& text) {
  for (const auto& [name, value] : kOpenEdges) {
    if (text != name) continue;
    settings.pipeline.surface.open_edges = value;
    return;
  }
  throw InputError(fmt::format("'{}' is not auto, splay or refuse", text));
}

constexpr std::array<std::pair<const char*, PolygonRule>, 3> kPolygons{
    {{"auto", PolygonRule::Auto},
     {"blocks", PolygonRule::Blocks},
     {"columns", PolygonRule::Columns}}};
constexpr std::array<std::pair<const char*, SignRule>, 4> kSigns{
    {{"auto", SignRule::Auto},
     {"closed", SignRule::Closed},
     {"winding", SignRule::Winding},
     {"unsigned", SignRule::Unsigned}}};

/// An option that is one of some words.
template <typename Words, typename Member>
OptionField worded(OptionField field, const Words& words, Member member) {
  std::string names;
  for (const auto& [name, value] : words) names += (names.empty() ? "" : ", ") + std::string(name);
  field.range = names;
  return parsed(
      std::move(field),
      [&words, member, names](Settings& settings, const std::string& text) {
        for (const auto& [name, value] : words) {
          if (text != name) continue;
          member(settings) = value;
          return;
        }
        throw InputError(fmt::format("'{}' is none of {}", text, names));
      },
      [&words, member](const Settings& settings) -> OptionValue {
        for (const auto& [name, value] : words) {
          if (member(settings) == value) return std::string(name);
        }
        return {};
      });
}

OptionValue echo_open_edges(const Settings& settings) {
  for (const auto& [name, value] : kOpenEdges) {
    if (settings.pipeline.surface.open_edges == value) return std::string(name);
  }
  return {};
}

[[noreturn]] void refuse_plane(const std::string& text, const std::string& why) {
  throw InputError(fmt::format(
      "--plane {}: {}; the forms are x=C, y=C, z=C, or a point and a normal as "
      "px,py,pz/nx,ny,nz (px,py/nx,ny for curves), with :NAME behind it if it is to have one",
      text, why));
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

double plane_number(std::string_view word, const std::string& text) {
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [next, error] = std::from_chars(word.data(), end, value);
  if (word.empty() || error != std::errc() || next != end || !std::isfinite(value)) {
    refuse_plane(text, fmt::format("'{}' is not a number", word));
  }
  return value;
}

/// "px, py, pz"; `what` says of what. In two dimensions without pz.
Vec3 plane_vector(std::string_view words, const char* what, bool is_flat, const std::string& text) {
  Vec3 vector = Vec3::Zero();
  const int count = is_flat ? 2 : 3;
  for (int n = 0; n < count; ++n) {
    const std::size_t comma = words.find(',');
    if ((comma == std::string_view::npos) != (n == count - 1)) {
      refuse_plane(text, fmt::format("the {} has not three numbers with commas, nor two as the "
                                     "other has",
                                     what));
    }
    vector[n] = plane_number(trimmed(words.substr(0, comma)), text);
    words.remove_prefix(comma == std::string_view::npos ? words.size() : comma + 1);
  }
  return vector;
}

/// Numbers with commas; nothing unless there are just as many.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(std::string_view text) {
  std::array<double, N> values{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t n = 0; n < N; ++n) {
    if (n > 0 && (at == end || *at++ != ',')) return {};
    const auto [next, error] = std::from_chars(at, end, values[n]);
    if (error != std::errc() || !std::isfinite(values[n])) return {};
    at = next;
  }
  return at == end ? std::optional(values) : std::nullopt;
}

}  // namespace

NamedPlane parse_plane(const std::string& text) {
  const std::string_view whole = text;
  const std::size_t colon = whole.find(':');
  const std::string_view spec = whole.substr(0, colon);
  NamedPlane named;
  if (colon != std::string_view::npos) {
    named.name = trimmed(whole.substr(colon + 1));
    if (named.name.empty()) refuse_plane(text, "nothing stands behind the colon");
  }
  const std::size_t slash = spec.find('/');
  if (slash != std::string_view::npos) {
    named.is_flat = std::ranges::count(spec, ',') == 2;
    named.plane = {plane_vector(spec.substr(0, slash), "point", named.is_flat, text),
                   plane_vector(spec.substr(slash + 1), "normal", named.is_flat, text)};
    if (!(named.plane.normal.norm() > 0)) refuse_plane(text, "the normal has no length");
    return named;
  }
  const std::size_t equals = spec.find('=');
  if (equals == std::string_view::npos) {
    refuse_plane(text, fmt::format("'{}' has neither '=' nor '/'", trimmed(spec)));
  }
  const std::string_view name = trimmed(spec.substr(0, equals));
  const std::size_t axis = name.size() == 1 ? std::string_view("xyzXYZ").find(name) : name.npos;
  if (axis == name.npos) refuse_plane(text, fmt::format("'{}' is not x, y or z", name));
  named.rest = true;
  named.plane.normal = Vec3::Unit(static_cast<Eigen::Index>(axis % 3));
  named.plane.point_world =
      plane_number(trimmed(spec.substr(equals + 1)), text) * named.plane.normal;
  return named;
}

FamilyLayers parse_family(const std::string& text) {
  const auto refuse = [&](const std::string& part) {
    throw InputError(
        fmt::format("--family {}: '{}' is not distance=D, first-cell=S or layers=off, as in "
                    "hub:distance=0.1,first-cell=1e-4",
                    text, part));
  };
  const std::size_t colon = text.rfind(':');
  FamilyLayers family;
  family.name = text.substr(0, colon);
  if (colon == std::string::npos || family.name.empty()) refuse(text);
  std::istringstream parts(text.substr(colon + 1));
  std::string part;
  while (std::getline(parts, part, ',')) {
    const std::string key = part.substr(0, part.find('='));
    const std::string value = part.size() > key.size() ? part.substr(key.size() + 1) : "";
    const auto number = numbers<1>(value);
    if (key == "layers" && value == "off") {
      family.off = true;
    } else if (key == "distance" && number) {
      family.distance_world = (*number)[0];
    } else if (key == "first-cell" && number) {
      family.first_cell_world = (*number)[0];
    } else {
      refuse(part);
    }
  }
  if (!family.off && !family.distance_world && !family.first_cell_world) refuse("");
  family.validate();
  return family;
}

NamedCondition parse_named_condition(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    throw InputError(fmt::format("--bc {}: is not NAME:KIND, as in hub:inviscid-wall", text));
  }
  try {
    return {text.substr(0, colon), parse_condition(text.substr(colon + 1))};
  } catch (const InputError& error) {
    throw InputError(fmt::format("--bc {}: {}", text, error.what()));
  }
}

ShapeText parse_shape(const std::string& option, const std::string& text) {
  const auto refuse = [&](const char* why) {
    throw InputError(fmt::format("{} {}: {}; the forms are FILE and FILE:NAME", option, text, why));
  };
  ShapeText shape{text, ""};
  const std::size_t colon = text.rfind(':');
  std::error_code ignored;
  if (!std::filesystem::exists(text, ignored) && colon != std::string::npos) {
    shape = {text.substr(0, colon), std::string(trimmed(std::string_view(text).substr(colon + 1)))};
    if (shape.name.empty()) refuse("nothing stands behind the colon");
  }
  if (trimmed(shape.file).empty()) refuse("no file is named");
  if (shape.name.empty()) shape.name = std::filesystem::path(shape.file).stem().string();
  return shape;
}

NamedShape read_shape(const ShapeText& text, const InputFormat& format, std::string& length_unit) {
  std::vector<std::string> notes;  // on repairs: of a boundary they are no matter
  PolygonUse use{.use = SurfaceUse::Distance, .length_unit = length_unit};
  NamedShape shape{text.name, format.read(text.file, use, notes)};
  length_unit = use.length_unit;
  return shape;
}

std::vector<OptionField> surface_fields() {
  const unsigned both = kMesh | kField;
  return {
      direct(
          {.stage = "surface",
           .flag = "SURFACE",
           .value = "FILE...",
           .help =
               "Surfaces as PLOT3D or CGNS (or walls of a volume mesh), as polygons: .stl, .obj, "
               ".ply, .off, each .gz too, as CAD: .step, .iges, .brep, or curves: PLOT3D, airfoil "
               ".dat, .obj; their patches are "
               "put together.",
           .commands = both},
          [](auto& s) -> auto& { return s.surfaces; }),
      direct(
          {.stage = "surface",
           .flag = "--input-format",
           .value = "WORDS",
           .preset = "by extension, and detected",
           .help = "airfoil, cgns, obj, stl, ply, off, step, iges, brep, or a PLOT3D dialect, "
                   "words with commas: "
                   "formatted, "
                   "unformatted, "
                   "c-stream, "
                   "single, double, big-endian, little-endian, iblank, no-iblank, "
                   "single-block, multi-block, 2d, 3d.",
           .commands = both},
          [](auto& s) -> auto& { return s.input_format; }),
      parsed(
          {.stage = "surface",
           .flag = "--side",
           .value = "SIDE",
           .range = "along, against, both",
           .help = "Marching side, relative to the normals of each component's first patch. A "
                   "field has phi positive on it: against turns a closed body's inside positive.",
           .member = "SurfaceOptions::side",
           .commands = both},
          parse_side, echo_side),
      direct(
          {.stage = "surface",
           .flag = "--scale",
           .value = "S",
           .range = "> 0",
           .help =
               "Factor applied to every coordinate on reading. All lengths of options are those "
               "after it.",
           .member = "SurfaceOptions::scale",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.surface.scale; }),
      direct(
          {.stage = "surface",
           .flag = "--weld",
           .value = "T",
           .unit = "local spacings",
           .range = "[0, 0.5)",
           .help =
               "Points nearer to each other than this become one, but for two sides of something "
               "thin.",
           .member = "SurfaceOptions::weld",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.surface.weld; }),
      direct(
          {.stage = "surface",
           .flag = "--plane",
           .value = "SPEC[:NAME]",
           .range = "x=0, or px,py,pz/nx,ny,nz; of curves px,py/nx,ny",
           .preset = "found from free edges",
           .help =
               "Boundary plane that the wall ends on, and its name; may be repeated. All of the "
               "surface lies on one side of it, or it holds an opening of the flow. One given "
               "several "
               "times is shared: each name takes the opening nearest to its point, x=0 the rest.",
           .commands = both},
          [](auto& s) -> auto& { return s.planes; }),
      direct(
          {.stage = "surface",
           .flag = "--boundary",
           .value = "FILE[:NAME]",
           .preset = "none",
           .help =
               "Boundary surface of any shape (PLOT3D, CGNS) that free edges lie on, and its name; "
               "may be repeated.",
           .commands = both},
          [](auto& s) -> auto& { return s.shapes; }),
      direct(
          {.stage = "surface",
           .flag = "--internal",
           .value = "FILE[:NAME]",
           .preset = "none",
           .help =
               "Internal, permeable surface (PLOT3D, CGNS) inside the flow, and its name, which "
               "none "
               "of the wall has; may be repeated. Columns of nodes on it march within it, others "
               "end on it; it must not lie on the wall."},
          [](auto& s) -> auto& { return s.internals; }),
      parsed({.stage = "surface",
              .flag = "--open-edges",
              .value = "WHAT",
              .range = "auto, splay, refuse",
              .help = "Free edges on no boundary that is named: auto looks for planes that they "
                      "lie on, splay lets columns lean outward there (as on those that auto "
                      "leaves), refuse makes what auto leaves an error."},
             parse_open_edges, echo_open_edges),
      direct(
          {.stage = "surface",
           .flag = "--fans",
           .value = "N",
           .unit = "cells",
           .range = "[0, 64]",
           .help = "Extra columns of cells that open each convex edge sharper than 40 degrees; 0 "
                   "for none. Even numbers open corners of three such edges too.",
           .member = "SurfaceOptions::fans"},
          [](auto& s) -> auto& { return s.pipeline.surface.fans; }),
      automatic(
          {.stage = "surface",
           .flag = "--surface-size",
           .value = "L",
           .unit = "length",
           .range = "> 0",
           .preset = "a fiftieth of the model's longest side",
           .help = "Longest edge on the faces of a CAD model; curved edges of faces are divided so "
                   "that they turn by 15 degrees at most.",
           .member = "CadOptions::size_world",
           .commands = kMesh | kField},
          [](auto& s) -> auto& { return s.cad.size_world; }),
      worded(
          {.stage = "surface",
           .flag = "--polygons",
           .value = "WHAT",
           .help = "What polygons become: structured blocks (quads alone), or a column of prisms "
                   "or hexahedra each; auto makes blocks of files that hold quads alone."},
          kPolygons, [](auto& s) -> auto& { return s.polygons; }),
      worded(
          {.stage = "surface",
           .flag = "--sign",
           .value = "HOW",
           .help =
               "How sides are told: closed by the normals of a closed surface, winding by "
               "winding numbers of any faces, unsigned not at all; auto takes the normals of "
               "closed surfaces, no sign for open ones (whose band lies on one side of them "
               "but for --side both), and of faces that meet as no surface's do winding numbers "
               "if few edges are open.",
           .commands = kField},
          kSigns, [](auto& s) -> auto& { return s.sign; }),
  };
}

}  // namespace vdb_offset::command
