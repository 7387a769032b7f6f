// Options of the surface stage, and what their texts mean.

#include "surface_options.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

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

OptionValue echo_open_edges(const Settings& settings) {
  for (const auto& [name, value] : kOpenEdges) {
    if (settings.pipeline.surface.open_edges == value) return std::string(name);
  }
  return {};
}

[[noreturn]] void refuse_plane(const std::string& text) {
  throw InputError(fmt::format(
      "--plane {}: not x=C, y=C or z=C, nor a point and a normal as px,py,pz/nx,ny,nz, with :NAME "
      "behind it if it is to have one",
      text));
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
  const std::size_t colon = text.find(':');
  const std::string spec = text.substr(0, colon);
  NamedPlane named;
  if (colon != std::string::npos) {
    named.name = text.substr(colon + 1);
    if (named.name.empty()) refuse_plane(text);
  }
  const std::size_t slash = spec.find('/');
  if (slash == std::string::npos) {
    if (spec.size() < 3 || spec[1] != '=' || spec[0] < 'x' || spec[0] > 'z') refuse_plane(text);
    const auto at = numbers<1>(std::string_view(spec).substr(2));
    if (!at) refuse_plane(text);
    named.plane.normal = Vec3::Unit(spec[0] - 'x');
    named.plane.point_world = (*at)[0] * named.plane.normal;
    return named;
  }
  const auto point = numbers<3>(std::string_view(spec).substr(0, slash));
  const auto normal = numbers<3>(std::string_view(spec).substr(slash + 1));
  if (!point || !normal) refuse_plane(text);
  named.plane = {Vec3(point->data()), Vec3(normal->data())};
  if (!(named.plane.normal.norm() > 0)) refuse_plane(text);
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

NamedShape read_shape(const std::string& text, const InputFormat& format) {
  NamedShape shape;
  std::filesystem::path file = text;
  const std::size_t colon = text.rfind(':');
  if (!std::filesystem::exists(file) && colon != std::string::npos) {
    file = text.substr(0, colon);
    shape.name = text.substr(colon + 1);
  }
  if (shape.name.empty()) shape.name = file.stem().string();
  shape.patches = format.read(file.string());
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
               "Surfaces as PLOT3D, or curves: PLOT3D, airfoil .dat, .obj; their patches are put "
               "together.",
           .commands = both},
          [](auto& s) -> auto& { return s.surfaces; }),
      direct(
          {.stage = "surface",
           .flag = "--input-format",
           .value = "WORDS",
           .preset = "by extension, and detected",
           .help = "airfoil, obj, or a PLOT3D dialect, words with commas: formatted, unformatted, "
                   "c-stream, "
                   "single, double, big-endian, little-endian, iblank, no-iblank, "
                   "single-block, multi-block, 2d, 3d.",
           .commands = both},
          [](auto& s) -> auto& { return s.input_format; }),
      parsed({.stage = "surface",
              .flag = "--side",
              .value = "SIDE",
              .range = "along, against, both",
              .help = "Marching side, relative to the normals of each component's first patch.",
              .member = "SurfaceOptions::side",
              .commands = both},
             parse_side, echo_side),
      direct(
          {.stage = "surface",
           .flag = "--scale",
           .value = "S",
           .range = "> 0",
           .help = "Factor applied to every coordinate on reading.",
           .member = "SurfaceOptions::scale",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.surface.scale; }),
      direct(
          {.stage = "surface",
           .flag = "--weld",
           .value = "T",
           .unit = "local spacings",
           .range = "[0, 0.5)",
           .help = "Points nearer to each other than this become one.",
           .member = "SurfaceOptions::weld",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.surface.weld; }),
      direct(
          {.stage = "surface",
           .flag = "--plane",
           .value = "SPEC[:NAME]",
           .range = "x=0, or px,py,pz/nx,ny,nz",
           .preset = "found from free edges",
           .help =
               "Boundary plane that the wall ends on, and its name; may be repeated. All of the "
               "surface lies on one side of it.",
           .commands = both},
          [](auto& s) -> auto& { return s.planes; }),
      direct(
          {.stage = "surface",
           .flag = "--boundary",
           .value = "FILE[:NAME]",
           .preset = "none",
           .help = "Boundary surface of any shape (PLOT3D) that free edges lie on, and its name; "
                   "may be repeated.",
           .commands = both},
          [](auto& s) -> auto& { return s.shapes; }),
      direct(
          {.stage = "surface",
           .flag = "--internal",
           .value = "FILE[:NAME]",
           .preset = "none",
           .help = "Internal, permeable surface (PLOT3D) inside the flow, and its name; may be "
                   "repeated. Columns of nodes on it march within it, others end on it."},
          [](auto& s) -> auto& { return s.internals; }),
      parsed({.stage = "surface",
              .flag = "--open-edges",
              .value = "WHAT",
              .range = "auto, splay, refuse",
              .help = "Free edges on no boundary that is named: auto looks for planes that they "
                      "lie on, splay lets them march freely, refuse makes what auto leaves an "
                      "error."},
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
  };
}

}  // namespace vdb_offset::command
