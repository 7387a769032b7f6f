// Documents written and read, what bounds what, and files that are no such document.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/hand_made.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/topology.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

namespace fs = std::filesystem;

struct Case {
  GivenSurface given;
  Surface surface;
  MultiBlock mesh;
  TopologyDocument document;
};

Case make_case(const char* name, SurfaceOptions options = {}, int points = 4) {
  ExampleOptions shape;
  shape.points = points;
  Case out;
  out.given = {make_example(name, shape), std::move(options)};
  out.surface = build_surface(out.given.patches, out.given.options);
  const auto nodes = static_cast<int>(out.surface.nodes_world.size());
  out.mesh =
      build_blocks(out.surface, make_layers(nodes, 2, [&](int n, int k) -> Vec3 {
                     return (1 + 0.125 * k) * out.surface.nodes_world[static_cast<std::size_t>(n)];
                   }));
  out.document = topology_document(out.given, out.surface, out.mesh);
  return out;
}

bool same_bits(const Vec3List& a, const Vec3List& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

/// V - E + F of the closed surface that a block is bounded by; 2 for a ball.
int euler(const TopologyDocument& document, const TopologyDocument::Block& block) {
  std::vector<char> edges(document.edges.size(), 0);
  std::vector<char> vertices(document.vertices.size(), 0);
  int faces = 0;
  for (const std::vector<int>& side : block.faces) {
    for (const int f : side) {
      ++faces;
      for (const auto& use : document.faces[static_cast<std::size_t>(f)].edges) {
        edges[static_cast<std::size_t>(use.edge)] = 1;
        for (const int v : document.edges[static_cast<std::size_t>(use.edge)].vertices) {
          vertices[static_cast<std::size_t>(v)] = 1;
        }
      }
    }
  }
  const auto count = [](const std::vector<char>& of) {
    return static_cast<int>(std::count(of.begin(), of.end(), 1));
  };
  return count(vertices) - count(edges) + faces;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("topology: what is written is read back equal, every double to the bit") {
  const TempFolder folder;
  for (const char* name : {"cube", "sphere", "quarter-cylinder", "channel", "circle", "airfoil"}) {
    CAPTURE(name);
    SurfaceOptions options;
    options.scale = name[0] == 'c' ? 1.0 / 3 : 1.0;
    Case one = make_case(name, options);
    one.document.points_world[0] = {-0.0, 5e-324, 1.7976931348623157e308};
    one.document.surfaces[0].family = "of \"quotes\", \\ and \xC3\xA9";
    write_topology(folder / "t.json", one.document);
    const TopologyDocument back = read_topology(folder / "t.json");
    CHECK(back == one.document);
    CHECK(same_bits(back.points_world, one.document.points_world));
  }
}

TEST_CASE("topology: fans, both sides and named boundaries are written and read too") {
  const TempFolder folder;
  SurfaceOptions fans;
  fans.fans = 2;
  SurfaceOptions both;
  both.side = MarchSide::Both;
  SurfaceOptions named;
  named.planes = {{"inlet", {Vec3(0, 0, 0), Vec3(2, 0, 0)}}};
  const std::array<Case, 3> cases{make_case("star", fans, 5), make_case("sphere", both),
                                  make_case("channel", named)};
  for (const Case& one : cases) {
    write_topology(folder / "t.json", one.document);
    CHECK(read_topology(folder / "t.json") == one.document);
  }
  CHECK(cases[0].document.surfaces.size() == 20);
  CHECK(cases[0].document.blocks.size() > 20);
  CHECK(cases[1].document.blocks[6].name.ends_with(" (against)"));
  CHECK(cases[1].document.faces[6].surface == 0);
  CHECK(cases[2].document.planes[0].name == "inlet");
  CHECK(cases[2].document.planes[0].given);
}

TEST_CASE("topology: every block is bounded by a closed surface of its own faces") {
  for (const char* name : {"cube", "quarter-cylinder", "channel", "draft-tube"}) {
    CAPTURE(name);
    const TopologyDocument document = make_case(name, {}, 5).document;
    for (const TopologyDocument::Block& block : document.blocks) {
      CAPTURE(block.name);
      CHECK(euler(document, block) == 2);
    }
  }
}

TEST_CASE("topology: a cube has the vertices, edges and faces that it has") {
  const TopologyDocument document = make_case("cube").document;
  CHECK(document.blocks.size() == 6);
  CHECK(document.vertices.size() == 2 * 8);
  CHECK(document.edges.size() == 2 * 12 + 8);
  CHECK(document.faces.size() == 2 * 6 + 12);
  CHECK(document.interfaces.size() == 12);
  std::vector<int> blocks_of(document.faces.size(), 0);
  for (const TopologyDocument::Block& block : document.blocks) {
    for (const std::vector<int>& side : block.faces) {
      CHECK(side.size() == 1);
      for (const int f : side) ++blocks_of[static_cast<std::size_t>(f)];
    }
  }
  for (std::size_t f = 0; f < document.faces.size(); ++f) {
    CHECK(blocks_of[f] == (document.faces[f].interface >= 0 ? 2 : 1));
    CHECK(document.faces[f].edges.size() == 4);
  }
}

TEST_CASE("topology: side faces lie where their interface or boundary face says") {
  const Case one = make_case("channel");
  const TopologyDocument& document = one.document;
  for (std::size_t b = 0; b < document.blocks.size(); ++b) {
    for (std::size_t side = 0; side < 6; ++side) {
      for (const int f : document.blocks[b].faces[side]) {
        const TopologyDocument::Face& face = document.faces[static_cast<std::size_t>(f)];
        std::vector<BlockRange> ranges;
        if (face.interface >= 0) {
          const Interface& i = document.interfaces[static_cast<std::size_t>(face.interface)];
          ranges = {i.first, i.second};
        } else {
          ranges = {document.boundary_faces[static_cast<std::size_t>(face.boundary_face)].range};
        }
        int found = 0;
        for (const BlockRange& r : ranges) {
          found += r.block == static_cast<int>(b) && r.face == static_cast<BlockFace>(side) ? 1 : 0;
        }
        CHECK(found == 1);
      }
    }
  }
}

TEST_CASE("topology: a document's surface is the one that was given, its boundaries too") {
  const TempFolder folder;
  SurfaceOptions options;
  options.planes = {{"inlet", {Vec3(0, 0, 0), Vec3(1, 0, 0)}}};
  options.scale = 1.0 / 3;
  const Case one = make_case("channel", options);
  write_topology(folder / "t.json", one.document);
  SurfaceOptions restored;
  const Patches patches = patches_of(read_topology(folder / "t.json"), restored);
  REQUIRE(restored.planes.size() == 1);
  CHECK(restored.planes[0].name == "inlet");
  const Surface again = build_surface(patches, restored);
  CHECK(same_bits(again.nodes_world, one.surface.nodes_world));
  CHECK(again.patch_nodes == one.surface.patch_nodes);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    CHECK(patches[p].name == one.given.patches[p].name);
    CHECK(patches[p].family == one.given.patches[p].family);
  }
  SurfaceOptions own;
  own.planes = {{"inlet", {Vec3(0, 0, 0), Vec3(0, 1, 0)}}};
  patches_of(one.document, own);
  REQUIRE(own.planes.size() == 1);
  CHECK(own.planes[0].plane.normal.y() == 1);
}

TEST_CASE("topology: a document that lies is refused with file, place, value and rule") {
  const TempFolder folder;
  const fs::path file = folder / "t.json";
  write_topology(file, make_case("cube").document);
  const std::string good = file_bytes(file);
  struct Lie {
    const char *from, *to, *place, *rule;
  };
  const std::array<Lie, 16> lies{
      {{"vdb-offset topology", "else", "t.json", "no topology document"},
       {"\"version\": 1", "\"version\": 2", "/version", "[1, 1]"},
       {"\"flat\": false", "\"flat\": 0", "/flat", "true or false"},
       {"\"points\": [\n[", "\"points\": [\n[1e999, 0, 0],\n[", "t.json", "no JSON"},
       {"\"points\": [\n[", "\"points\": [\n[1, 2],\n[", "/points/0", "list of 3"},
       {"\"points\": [\n[", "\"points\": [\n[true, 2, 3],\n[", "/points/0/0", "a number"},
       {"\"curves\": [\n[", "\"curves\": [\n[99999, ", "/curves/0/0", "there are"},
       {"\"curves\": [\n[", "\"curves\": [\n[-1, ", "/curves/0/0", "there are"},
       {"\"curves\": [\n[", "\"curves\": [\n[1.5, ", "/curves/0/0", "whole number"},
       {"\"ni\": 4", "\"ni\": 2147483647", "/surfaces/0/points", "points are"},
       {"\"ni\": 4", "\"ni\": 99999999999999999999", "/surfaces/0/ni", "whole number"},
       {"\"role\": \"wall\"", "\"role\": \"roof\"", "/surfaces/0/role", "one of wall"},
       {"\"vertices\": [0", "\"vertices\": [1", "/edges/0/vertices/0", "does not stand on"},
       {"\"edges\": [[0, 1]", "\"edges\": [[0, -1]", "/edges/0", "does not begin"},
       {"\"transform\": [", "\"transform\": [9, ", "/interfaces/0/transform", "list of 3"},
       {"\"condition\": \"wall\"", "\"condition\": [[[[[[[[[]]]]]]]]]", "t.json", "deeper"}}};
  for (const Lie& lie : lies) {
    CAPTURE(lie.to);
    put(file, replaced(good, lie.from, lie.to));
    std::string said = "nothing";
    try {
      read_topology(file);
    } catch (const IoError& error) {
      said = error.what();
    }
    CAPTURE(said);
    CHECK(said.find("t.json") != std::string::npos);
    CHECK(said.find(lie.place) != std::string::npos);
    CHECK(said.find(lie.rule) != std::string::npos);
  }
}

TEST_CASE("topology: files cut, damaged or nested without end are read or refused, never worse") {
  const TempFolder folder;
  const fs::path file = folder / "t.json";
  write_topology(file, make_case("cube").document);
  const std::string good = file_bytes(file);
  const auto is_read = [&](const std::string& bytes) -> std::optional<bool> {
    put(file, bytes);
    try {
      read_topology(file);
      return true;
    } catch (const IoError&) {
      return false;
    }
  };
  CHECK(is_read(good) == true);
  for (const std::size_t end : {std::size_t{0}, good.size() / 3, good.size() - 2}) {
    CHECK(is_read(good.substr(0, end)) == false);
  }
  CHECK(is_read(std::string(1'000'000, '[')) == false);
  CHECK(is_read("{\"format\": " + std::string(1'000'000, '{')) == false);
  CHECK(is_read("null") == false);
  std::mt19937 random(7);
  const std::string letters = "0123456789-.,:[]{}\"e \\ntf\xFF";
  int refused = 0;
  for (int n = 0; n < 400; ++n) {
    std::string bytes = good;
    bytes[random() % bytes.size()] = letters[random() % letters.size()];
    refused += is_read(bytes) == false ? 1 : 0;
  }
  CHECK(refused > 100);
}

TEST_CASE("topology: blocks of another surface are refused") {
  const Case one = make_case("cube");
  const Case other = make_case("sphere-pair");
  CHECK_THROWS_AS(topology_document(one.given, one.surface, other.mesh), InputError);
}

}  // namespace vdb_offset::test
