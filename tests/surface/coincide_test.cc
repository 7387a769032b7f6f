// Boundaries that lie on each other would share their nodes, but not their name.

#include <doctest/doctest.h>

#include <string>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {
namespace {

const Patch kPlate = rectangle("plate", {5, 5}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()});

std::string refusal(const SurfaceOptions& options) {
  try {
    build_surface({kPlate}, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool names_both(const std::string& message) {
  return message.find("'first'") != std::string::npos &&
         message.find("'second'") != std::string::npos;
}

}  // namespace

TEST_CASE("boundaries: a plane that is given twice is refused, whichever way it is written") {
  SurfaceOptions options;
  options.planes = {{"first", {Vec3::Zero(), Vec3::UnitX()}},
                    {"second", {Vec3(0, 7, 1e-9), Vec3(-2, 0, 0)}}};
  CHECK(names_both(refusal(options)));
  options.planes[1].plane = {Vec3::UnitX(), Vec3::UnitX()};
  CHECK(refusal(options).empty());
}

TEST_CASE("boundaries: internal surfaces that coincide are refused, others that touch are not") {
  const auto sheet = [](const std::string& name, int points, double z) {
    return NamedShape{
        name,
        {rectangle(name, {points, points}, Vec3(0.2, 0.2, z), {Vec3(0.5, 0, 0), Vec3(0, 0.5, 0)})}};
  };
  SurfaceOptions options;
  options.internals = {sheet("first", 3, 0.5), sheet("second", 5, 0.5)};
  CHECK(names_both(refusal(options)));
  options.internals[1] = sheet("second", 5, 0.6);
  CHECK(refusal(options).empty());
  options.internals[1].patches = {
      rectangle("second", {3, 3}, Vec3(0.2, 0.2, 0.5), {Vec3(0.5, 0, 0), Vec3(0, 0, 0.5)})};
  CHECK(refusal(options).empty());
}

}  // namespace vdb_offset::test
