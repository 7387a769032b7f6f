// The options of the built-in surfaces.

#include "option_binding.h"

namespace vdb_offset::command {

std::vector<OptionField> example_fields() {
  return {
      direct(
          {.stage = "shape",
           .flag = "--points",
           .value = "N",
           .range = "[3, 2000]",
           .help = "Points along the side of a typical patch.",
           .member = "ExampleOptions::points",
           .commands = kExample},
          [](auto& s) -> auto& { return s.shape.points; }),
      direct(
          {.stage = "shape",
           .flag = "--gap",
           .value = "G",
           .unit = "radii",
           .range = "> 0",
           .help = "Gap between the bodies of sphere-pair.",
           .member = "ExampleOptions::gap",
           .commands = kExample},
          [](auto& s) -> auto& { return s.shape.gap; }),
      direct(
          {.stage = "shape",
           .flag = "--closed",
           .help = "draft-tube: with its inlet and outlet faces; airfoil: its trailing edge sharp.",
           .member = "ExampleOptions::closed",
           .commands = kExample},
          [](auto& s) -> auto& { return s.shape.closed; }),
      direct(
          {.stage = "shape",
           .flag = "--fillet",
           .value = "R",
           .unit = "bar sides",
           .range = "[0, 0.09]",
           .help = "l-bar and u-slot: radius of the corners; 0 is sharp.",
           .member = "ExampleOptions::fillet",
           .commands = kExample},
          [](auto& s) -> auto& { return s.shape.fillet; }),
      direct(
          {.stage = "shape",
           .flag = "--angle",
           .value = "A",
           .unit = "degrees",
           .range = "[10, 170]",
           .help = "wedge: angle of its notch, on the side of the flow.",
           .member = "ExampleOptions::angle",
           .commands = kExample},
          [](auto& s) -> auto& { return s.angle_degrees; }),
      direct(
          {.stage = "shape",
           .flag = "--tips",
           .value = "N",
           .range = "[3, 12]",
           .help = "star: its number of tips.",
           .member = "ExampleOptions::tips",
           .commands = kExample},
          [](auto& s) -> auto& { return s.shape.tips; }),
      direct(
          {.stage = "shape",
           .flag = "--naca",
           .value = "DIGITS",
           .range = "four digits",
           .help = "airfoil: its NACA section.",
           .member = "ExampleOptions::naca",
           .commands = kExample},
          [](auto& s) -> auto& { return s.shape.naca; }),
  };
}

}  // namespace vdb_offset::command
