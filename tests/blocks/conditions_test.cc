#include "vdb_offset/blocks/conditions.h"

#include <doctest/doctest.h>

#include <map>
#include <string>

#include "support/face_ranges.h"
#include "support/hand_made.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

Surface channel() {
  SurfaceOptions options;
  options.planes = {{"Inlet 1", {{0, 0, 0}, {1, 0, 0}}}, {"outlet", {{4, 0, 0}, {1, 0, 0}}}};
  Patches patches = make_example("channel");
  for (std::size_t p = 0; p < patches.size(); ++p) patches[p].family = p < 2 ? "floor" : "";
  return build_surface(std::move(patches), options);
}

/// Conditions by name; all faces of a name have the same.
std::map<std::string, std::string> by_name(const Surface& surface,
                                           const ConditionOptions& options) {
  MultiBlock mesh =
      build_blocks(surface, any_layers(static_cast<int>(surface.nodes_world.size()), 2));
  set_conditions(surface, options, mesh);
  std::map<std::string, std::string> out;
  for (const BoundaryFace& face : mesh.boundary_faces) {
    const auto [found, is_new] = out.try_emplace(face.name, describe(face.condition));
    CHECK(found->second == describe(face.condition));
  }
  return out;
}

TEST_CASE("conditions: walls are walls, planes are what their names say, the rest unspecified") {
  using Names = std::map<std::string, std::string>;
  const Names names = by_name(channel(), {});
  CHECK(names == Names{{"floor", "wall"},
                       {"wall", "wall"},
                       {"outer", "farfield"},
                       {"Inlet 1", "inflow"},
                       {"outlet", "outflow"},
                       {"symmetry", "symmetry"},
                       {"symmetry 2", "symmetry"}});
  SurfaceOptions splay;
  splay.open_edges = OpenEdges::Splay;
  CHECK(by_name(build_surface(make_example("channel"), splay), {}).at("free") == "unspecified");
  const Names flat = by_name(build_surface(make_example("circle")), {});
  CHECK(flat.at("front") == "symmetry");
  CHECK(flat.at("back") == "symmetry");
}

TEST_CASE("conditions: a wall without layers is a wall, unless it is said otherwise") {
  Patches patches = make_example("channel", {.points = 5});
  SurfaceOptions options;
  options.shapes = {{"step", {patches[1]}, true}};
  patches.erase(patches.begin() + 1);
  const Surface surface = build_surface(patches, options);
  CHECK(by_name(surface, {}).at("step") == "wall");
  ConditionOptions inviscid;
  inviscid.named = {{"step", parse_condition("inviscid-wall")}};
  CHECK(by_name(surface, inviscid).at("step") == "inviscid-wall");
}

TEST_CASE("conditions: a patch goes before its family, and is called by its own name then") {
  const Surface surface = channel();
  const std::string patch = surface.patches[0].name;
  ConditionOptions options;
  options.outer = ConditionKind::Overset;
  options.named = {{patch, parse_condition("inflow")},
                   {"floor", parse_condition("inviscid-wall")},
                   {"symmetry", parse_condition("farfield")}};
  const auto names = by_name(surface, options);
  CHECK(names.at(patch) == "inflow");
  CHECK(names.at("floor") == "inviscid-wall");
  CHECK(names.at("wall") == "wall");
  CHECK(names.at("symmetry") == "farfield");
  CHECK(names.at("symmetry 2") == "symmetry");
  CHECK(names.at("outer") == "overset");
  options.named.push_back({"outer", parse_condition("outflow")});
  CHECK(by_name(surface, options).at("outer") == "outflow");
}

TEST_CASE("conditions: a name that nothing has is refused with those that there are") {
  const Surface surface = channel();
  ConditionOptions options;
  options.named = {{"roof", parse_condition("wall")}};
  CHECK_THROWS_WITH_AS(check_names(options, surface), doctest::Contains("'roof'"), InputError);
  CHECK_THROWS_WITH_AS(check_names(options, surface), doctest::Contains("Inlet 1, "), InputError);
  CHECK_THROWS_WITH_AS(check_names(options, surface), doctest::Contains("floor"), InputError);
  options.named = {{"floor", {}}, {"floor", {}}};
  CHECK_THROWS_WITH_AS(options.validate(), doctest::Contains("twice"), InputError);
  options = {ConditionKind::Wall};
  CHECK_THROWS_WITH_AS(options.validate(), doctest::Contains("outer"), InputError);
}

TEST_CASE("conditions: words and BCTypes are read, and what is neither is refused") {
  for (const char* word : {"wall", "inviscid-wall", "symmetry", "inflow", "outflow", "farfield",
                           "overset", "BCInflowSupersonic", "BCExtrapolate"}) {
    CHECK(describe(parse_condition(word)) == word);
  }
  CHECK(parse_condition("BCWallViscous") == parse_condition("wall"));
  CHECK(parse_condition("WallViscousHeatFlux").kind == ConditionKind::Wall);
  CHECK(cgns_type(parse_condition("WallViscousHeatFlux")) == "BCWallViscousHeatFlux");
  CHECK(parse_condition("FamilySpecified") == Condition{});
  for (const char* word : {"", "walls", "BC", "BCDegenerateLine", "Wall "}) {
    CAPTURE(word);
    CHECK_THROWS_WITH_AS(parse_condition(word), doctest::Contains("inviscid-wall"), InputError);
  }
}

TEST_CASE("connectivity: seen from the other side, an interface joins the same points") {
  Interface one{{0, BlockFace::IMax, {4, 1, 0}, {4, 3, 2}},
                {1, BlockFace::JMin, {5, 0, 0}, {3, 0, 2}},
                {2, -1, 3}};
  const Interface other = reversed(one);
  CHECK(reversed(other).transform == one.transform);
  for (const Interface& side : {other, ascending(other)}) {
    for_points(one.first, [&](const Index3& p) { CHECK(to_donor(side, to_donor(one, p)) == p); });
  }
  CHECK(ascending(other).first.begin == Index3{3, 0, 0});
  CHECK(ascending(other).second.begin == Index3{4, 3, 0});
}

}  // namespace
}  // namespace vdb_offset::test
