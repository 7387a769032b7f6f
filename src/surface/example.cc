#include "vdb_offset/surface/example.h"

#include <fmt/format.h>

#include <cmath>

#include "surface/example_grid.h"
#include "surface/naca_section.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"

namespace vdb_offset {

namespace {

struct Entry {
  ExampleInfo info;
  Patches (*make)(const ExampleOptions&);
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> list{
      {{"sphere", "radius 1 about the origin, 6 patches"}, example::sphere},
      {{"cube", "edge 1 about the origin, 6 patches"}, example::cube},
      {{"torus", "radii 1 and 0.4, 8 patches"}, example::torus},
      {{"bumpy-torus",
        "radii 1 and 0.4, bumps 0.05 high, 9 around and 4 about the tube, 8 patches"},
       example::bumpy_torus},
      {{"l-bar", "unit bar of L section, arms 0.5, 12 patches (24 with --fillet)"}, example::l_bar},
      {{"u-slot", "unit bar with a slot 0.2 wide and 0.5 deep, 18 patches (34 with --fillet)"},
       example::u_slot},
      {{"wedge", "unit bar with one sharp notch of --angle degrees, 12 patches"}, example::wedge},
      {{"star", "unit bar, section a star of --tips tips, radii 0.5 and 0.25, 20 patches"},
       example::star},
      {{"sphere-pair", "two spheres of radius 1, --gap radii apart, 12 patches"},
       example::sphere_pair},
      {{"naca0012-wing",
        "chord 1, half span 2, blunt trailing edge, flat tip, open root, 8 patches"},
       example::naca0012_wing},
      {{"draft-tube",
        "4 m tube: cone, elbow, diffuser with two piers, 36 patches (44 with --closed)"},
       example::draft_tube},
      {{"quarter-cylinder", "radius 0.5, height 1, cut at x = 0 and y = 0, open there, 7 patches"},
       example::quarter_cylinder},
      {{"wing-on-cylinder",
        "NACA 0012, chord 1, tip at y = 2, open root on the cylinder fuselage, 8 patches"},
       example::wing_on_cylinder},
      {{"fuselage",
        "radius 0.5 about the x axis, x from -4 to 5: boundary of wing-on-cylinder, 4 patches"},
       example::fuselage},
      {{"channel",
        "length 4, width 0.5, height 1, step of 0.2 down at x = 1, open round it, 4 patches"},
       example::channel},
      {{"airfoil",
        "a curve: NACA section, --naca, chord 1, blunt tail, 2 patches (1 with --closed)"},
       example::airfoil},
      {{"circle", "a curve: radius 0.5 about the origin, 1 patch"}, example::circle},
  };
  return list;
}

}  // namespace

void ExampleOptions::validate() const {
  if (points < 3 || points > 2000) {
    throw InputError(fmt::format("ExampleOptions::points = {}, but must be in [3, 2000]", points));
  }
  if (!(gap > 0) || !std::isfinite(gap)) {
    throw InputError(fmt::format("ExampleOptions::gap = {}, but must be > 0 and finite", gap));
  }
  // 170 * (pi / 180) and 170 * pi / 180 are not the same number
  if (!(degrees(angle) > 10 - 1e-9 && degrees(angle) < 170 + 1e-9)) {
    throw InputError(fmt::format(
        "ExampleOptions::angle = {:g} degrees, but must be in [10, 170] degrees", degrees(angle)));
  }
  if (tips < 3 || tips > 12) {
    throw InputError(fmt::format("ExampleOptions::tips = {}, but must be in [3, 12]", tips));
  }
  example::parse_naca(naca);
  if (!(fillet == 0 || (fillet >= 0.02 && fillet <= 0.09))) {
    throw InputError(
        fmt::format("ExampleOptions::fillet = {}, but must be 0 or in [0.02, 0.09]", fillet));
  }
}

const std::vector<ExampleInfo>& examples() {
  static const std::vector<ExampleInfo> list = [] {
    std::vector<ExampleInfo> infos;
    for (const Entry& entry : entries()) infos.push_back(entry.info);
    return infos;
  }();
  return list;
}

Patches make_example(std::string_view name, const ExampleOptions& options) {
  options.validate();
  std::string known;
  for (const Entry& entry : entries()) {
    if (entry.info.name == name) return entry.make(options);
    known += (known.empty() ? "" : ", ") + entry.info.name;
  }
  throw InputError(fmt::format("no example is called \"{}\"; there are: {}", name, known));
}

}  // namespace vdb_offset
