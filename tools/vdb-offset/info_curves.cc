#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "inputs.h"
#include "vdb_offset/io/airfoil.h"
#include "vdb_offset/io/obj_curves.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

bool is_closed(const Patch& patch) {
  return patch.points_world.front() == patch.points_world.back();
}

double length_of(const Patch& patch) {
  double length = 0.0;
  for (std::size_t n = 1; n < patch.points_world.size(); ++n) {
    length += (patch.points_world[n] - patch.points_world[n - 1]).norm();
  }
  return length;
}

struct CurveFigures {
  std::size_t points = 0;
  int free_ends = 0;
  Box box;
  double length = 0.0;
};

CurveFigures figures_of(const Patches& patches) {
  CurveFigures figures;
  std::map<std::array<double, 3>, int> ends;
  for (const Patch& patch : patches) {
    figures.points += patch.points_world.size();
    figures.length += length_of(patch);
    for (const Vec3& p : patch.points_world) figures.box.add(p);
    for (const Vec3& p : {patch.points_world.front(), patch.points_world.back()}) {
      ++ends[{p.x(), p.y(), p.z()}];
    }
  }
  for (const auto& [place, uses] : ends) figures.free_ends += uses == 1 ? 1 : 0;
  return figures;
}

Json to_json(const Vec3& p) { return Json::array({p.x(), p.y(), p.z()}); }

Json to_json(const Patches& patches) {
  const CurveFigures figures = figures_of(patches);
  Json out = {{"patches", patches.size()},
              {"points", figures.points},
              {"closed", figures.free_ends == 0},
              {"free_ends", figures.free_ends},
              {"bounds", {{"min", to_json(figures.box.lo)}, {"max", to_json(figures.box.hi)}}},
              {"length", figures.length},
              {"curves", Json::array()}};
  for (const Patch& patch : patches) {
    out["curves"].push_back({{"name", patch.name},
                             {"family", patch.family},
                             {"points", patch.ni},
                             {"closed", is_closed(patch)},
                             {"length", length_of(patch)}});
  }
  return out;
}

std::string airfoil_lines(const AirfoilInfo& info) {
  std::string out;
  if (!info.title.empty()) out += fmt::format("title      {}\n", info.title);
  out += fmt::format("points     {} in the file, {} repeated and dropped{}\n", info.points,
                     info.repeated, info.turned ? "; clockwise, turned round" : "");
  const char* edge = info.blunt       ? "blunt, its base"
                     : info.end_added ? "sharp, its closing point added across"
                                      : "sharp, its ends apart by";
  out +=
      fmt::format("trailing   {} {:.6g}; chord {:.6g}\n", edge, info.gap_world, info.chord_world);
  return out;
}

Json airfoil_json(const AirfoilInfo& info) {
  return {{"form", describe(info.form)}, {"title", info.title},   {"points", info.points},
          {"repeated", info.repeated},   {"turned", info.turned}, {"blunt", info.blunt},
          {"end_added", info.end_added}, {"gap", info.gap_world}, {"chord", info.chord_world}};
}

std::string dump(const Json& out) {
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string describe_curves(const Patches& patches) {
  constexpr std::size_t kShown = 20;
  std::string out;
  for (std::size_t n = 0; n < std::min(patches.size(), kShown); ++n) {
    const Patch& patch = patches[n];
    out += fmt::format("curve {:<4} {}: {} points, {}, length {:.6g}\n", n + 1, patch.name,
                       patch.ni, is_closed(patch) ? "closed" : "open", length_of(patch));
  }
  if (patches.size() > kShown)
    out += fmt::format("           and {} more\n", patches.size() - kShown);
  const CurveFigures figures = figures_of(patches);
  const Box& box = figures.box;
  out += fmt::format("curves     {} patch{}, {} points, {}, {} free ends\n", patches.size(),
                     patches.size() == 1 ? "" : "es", figures.points,
                     figures.free_ends == 0 ? "closed" : "open", figures.free_ends);
  out += fmt::format("bounds     ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n",
                     box.lo.x(), box.lo.y(), box.lo.z(), box.hi.x(), box.hi.y(), box.hi.z());
  return out;
}

std::string curves_json(const Patches& patches) { return to_json(patches).dump(); }

std::string describe_curves_file(const std::string& file, InputKind kind, bool json) {
  const bool airfoil = kind == InputKind::Airfoil;
  const Patches patches = airfoil ? read_airfoil(file) : read_obj_curves(file);
  const AirfoilInfo info = airfoil ? inspect_airfoil(file) : AirfoilInfo{};
  if (json) {
    Json out = {{"file", file}, {"format", airfoil ? "airfoil" : "obj"}};
    if (airfoil) out["airfoil"] = airfoil_json(info);
    out["curves"] = to_json(patches);
    return dump(out);
  }
  const std::string format =
      airfoil ? "airfoil: " + describe(info.form) : "Wavefront .obj: plane curves";
  return fmt::format("file       {}\nformat     {}\n", file, format) +
         (airfoil ? airfoil_lines(info) : "") + describe_curves(patches);
}

}  // namespace vdb_offset::command
