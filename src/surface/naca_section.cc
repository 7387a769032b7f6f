// After Jacobs, Ward and Pinkerton, The characteristics of 78 related airfoil sections from tests
// in the variable-density wind tunnel (NACA Report 460, 1933).

#include "surface/naca_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vdb_offset/core/error.h"

namespace vdb_offset::example {

double NacaSection::half_thickness(double x) const {
  if (sharp && x == 1) return 0;  // the five coefficients add up to nothing, but for rounding
  const double last = sharp ? 0.1036 : 0.1015;
  return 5 * thickness *
         (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x -
          last * x * x * x * x);
}

Vec3 NacaSection::point(double x, double side) const {
  const double across = side * half_thickness(x);
  if (camber == 0) return {x, across, 0};
  const double p = camber_place;
  const double part = x < p ? camber / (p * p) : camber / ((1 - p) * (1 - p));
  const double y = part * (x < p ? x * (2 * p - x) : (1 - x) * (1 + x - 2 * p));
  const double slope = 2 * part * (p - x);
  const double length = std::hypot(1.0, slope);
  return {x - across * slope / length, y + across / length, 0};
}

NacaSection parse_naca(const std::string& digits) {
  const bool four = digits.size() == 4 &&
                    std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
  const auto digit = [&](std::size_t n) { return digits[n] - '0'; };
  const char* rule = nullptr;
  if (!four) {
    rule = "must be four digits";
  } else if (digits.substr(2) == "00") {
    rule = "its last two digits, the thickness, must not be 00";
  } else if (digits[0] != '0' && digits[1] == '0') {
    rule = "its second digit, the place of the camber, must not be 0";
  }
  if (rule != nullptr) {
    throw InputError(
        fmt::format("ExampleOptions::naca = \"{}\", but {}; try 0012 or 2412", digits, rule));
  }
  NacaSection section;
  section.thickness = (10 * digit(2) + digit(3)) / 100.0;
  section.camber = digit(0) / 100.0;
  section.camber_place = digit(1) / 10.0;
  return section;
}

}  // namespace vdb_offset::example
