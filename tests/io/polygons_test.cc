#include "vdb_offset/io/polygons.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <fstream>
#include <vector>

#include "io/gzip.h"
#include "io/plot3d_grid.h"
#include "io/polygon_bytes.h"
#include "support/temp_folder.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using plot3d_test::contains;

namespace {

using Faces = std::vector<std::vector<int>>;

Faces faces_of(const PolygonMesh& mesh) {
  Faces faces;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    faces.emplace_back(face.begin(), face.end());
  }
  return faces;
}

std::string packed(const std::string& bytes) {
  std::string out(bytes.size() + 100, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

const std::string kTriangleObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

}  // namespace

TEST_CASE("polygons: binary STL is read to the bit, whatever its header says") {
  for (const std::string header : {"made by hand", "solid made by hand", "", "ply\n", "OFF"}) {
    const PolygonMesh mesh = read(binary_stl(header, kTwoTriangles), "a.stl");
    CHECK(mesh.points_world == kTwoTriangles);
    CHECK(faces_of(mesh) == Faces{{0, 1, 2}, {3, 4, 5}});
    CHECK(mesh.families.empty());
    CHECK(mesh.file == "a.stl");
  }
  const std::string whole = binary_stl("x", kTwoTriangles);
  CHECK(read(whole + std::string(49, 'x'), "a.stl").faces() == 2);
  CHECK(contains(said_of(whole + std::string(50, 'x'), "a.stl"),
                 "a.stl, byte 80: counts 2 triangles, which take 184 bytes, and the file has 234"));
  CHECK(contains(said_of(whole.substr(0, 183), "a.stl"), "and the file has 183"));
  CHECK(contains(said_of(binary_stl("solid x", kTwoTriangles).substr(0, 183), "a.stl"), "byte 80"));
  CHECK(contains(said_of(whole.substr(0, 83), "a.stl"), "byte 83: the file ends in the header"));
  CHECK(contains(said_of(binary_stl("x", {}), "a.stl"), "holds no face"));
}

TEST_CASE("polygons: text STL is read in any case and layout, its solids as families") {
  const PolygonMesh one = read(kTextStl, "a.stl");
  CHECK(one.points_world == Vec3List{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(one.families == std::vector<std::string>{"left wing"});
  const std::string odd =
      "  SOLID\r\nFacet Normal nan -nan(ind) x OUTER LOOP VERTEX 0 0 0 vertex +1.5 0 0 "
      "vertex 1 .5 0 vertex 0 1D-1 0 endloop endfacet\rendsolid";
  const PolygonMesh two = read(
      odd + "\n" + kTextStl + kTextStl + "solid\n" + kTextStl.substr(kTextStl.find('\n')), "a.stl");
  CHECK(two.faces() == 4);
  CHECK(two.face(0).size() == 4);
  CHECK(two.points_world[3] == Vec3(0, 0.1, 0));
  CHECK(two.families == std::vector<std::string>{"", "left wing", "solid 4"});
  CHECK(two.family == std::vector<int>{0, 1, 1, 2});
  CHECK(read("\xEF\xBB\xBF" + kTextStl, "a.stl").faces() == 1);
}

TEST_CASE("polygons: text STL that breaks its grammar is refused with its line") {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kTextStl;
    text.replace(text.find(from), from.size(), to);
    return said_of(text, "a.stl");
  };
  CHECK(contains(with("   vertex 0 1 0\n", ""), "a.stl, line 6: a facet of 2 vertices"));
  CHECK(contains(with("vertex 1 0 0", "vertex 1 zero 0"), "line 5: y = \"zero\" is not a number"));
  CHECK(contains(with("vertex 1 0 0", "vertex 1 0 inf"), "line 5: the point (1, 0, inf), which"));
  CHECK(contains(with("outer loop", "inner loop"), "a facet without its 'outer loop'"));
  CHECK(contains(with("endsolid left wing\n", ""), "without 'endsolid'"));
  CHECK(contains(with(" endfacet\n", ""), "line 8: \"endsolid\" where 'endfacet' belongs"));
  CHECK(contains(with("solid left wing\n", "solid left wing\nsolid\n"), "line 2: \"solid\" where"));
}

TEST_CASE("polygons: OBJ faces are read with every form of index and of vertex") {
  const PolygonMesh mesh = read(
      "\xEF\xBB\xBF# a comment\r\nmtllib x.mtl\r\nv 0 0 0 0.5\r\nv 1 0 0 .1 .2 .3\r\nvt 0 0\r\n"
      "v 1 1 0\r\nv 1.#IND nan -1.#QNAN\r\nf 1/1/1 2//1 -2/1\r\nf 1 \\\r\n 3/7 \\\r\n 5\r\n"
      "f 1 2 3 5 6 # pentagon\r\nv 0 1 0\r\nv +0 -.5 0\r\nvn 0 0 1\r\nl 1 2",
      "a.obj");
  CHECK(faces_of(mesh) == Faces{{0, 1, 2}, {0, 2, 4}, {0, 1, 2, 4, 5}});
  CHECK(mesh.points_world[1] == Vec3(1, 0, 0));
  CHECK(mesh.points_world[5] == Vec3(0, -0.5, 0));
  CHECK(mesh.families.empty());
  CHECK(read(kTriangleObj.substr(0, kTriangleObj.size() - 1), "a.obj").faces() == 1);
}

TEST_CASE(
    "polygons: OBJ families are groups, else objects, else materials, that tell faces apart") {
  const auto families = [](const std::string& text) {
    const PolygonMesh mesh = read("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + text, "a.obj");
    std::vector<std::string> names;
    for (std::size_t f = 0; f < mesh.faces() && !mesh.families.empty(); ++f) {
      names.push_back(mesh.families[static_cast<std::size_t>(mesh.family_of(f))]);
    }
    return names;
  };
  using Names = std::vector<std::string>;
  const std::string f = "f 1 2 3\n";
  CHECK(families(f).empty());
  CHECK(families("o a\ng x\n" + f + "o b\n" + f + "o a\n" + f) == Names{"a", "b", "a"});
  CHECK(families("o a\ng x y\n" + f + "g z\n" + f) == Names{"x y", "z"});
  CHECK(families("o a\ng g\nusemtl x\n" + f + "usemtl z\n" + f) == Names{"x", "z"});
  CHECK(families("o a\nusemtl m\n" + f + f) == Names{"a", "a"});
  CHECK(families(f + "g b\n" + f) == Names{"default", "b"});
  // The whole is one object, or two, and its sides are groups.
  CHECK(families("o body\ng x\n" + f + "g y\n" + f) == Names{"x", "y"});
  CHECK(families("o a\n" + f + "o b\ng x\n" + f + "g y\n" + f + "g\n" + f) ==
        Names{"a", "x", "y", "b"});
  CHECK(families("g sides x\n" + f + "g sides\n" + f) == Names{"sides x", "sides"});
  CHECK(families("g\nusemtl steel\n" + f) == Names{"steel"});
}

TEST_CASE("polygons: OBJ indices of no vertex are refused with their line") {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto said = [&](const std::string& text) { return said_of(v + text, "a.obj"); };
  CHECK(contains(said("f 0 1 2\n"), "a.obj, line 4: \"0\" is no vertex, of the 3 so far"));
  CHECK(contains(said("f 1 2 -4\n"), "line 4: \"-4\" is no vertex"));
  CHECK(contains(said("\nf 1 2 4\nf 1 2 9\nf 1 2 3"), "line 6: 9 is no vertex, of the 3 of the"));
  CHECK(contains(said("f 1 2 99999999999999999999\n"), "line 4: \"99999999999999999999\""));
  CHECK(contains(said("f 1 2 -9223372036854775808\n"), "is no vertex"));
  CHECK(contains(said("f 1 2 9223372036854775807\n"), "is no vertex"));
  CHECK(contains(said("f 1 2\n"), "line 4: 'f' names 2 vertices; it takes 3 at least"));
  CHECK(contains(said("f 1 2 x\n"), "line 4: \"x\" is no vertex"));
  CHECK(contains(said("v 1 2\n"), "line 4: a vertex of 2 numbers"));
  CHECK(contains(said("v 1e999 2 3\nf 1 2 4\n"), "line 4: the point (inf, 2, 3), which face 1"));
  CHECK(contains(said("v x 2 3\nf 1 2 4\n"), "line 4: the point (nan, 2, 3)"));
  CHECK(contains(said("l 1 2\n"), "holds no face"));
}

TEST_CASE("polygons: PLY says the same as text and as bytes of either order") {
  const PolygonMesh text = read(ascii_ply(), "a.ply");
  CHECK(text.points_world == Vec3List{{0, 0, 0}, {1, 0, 0}, {1, 1, -3}, {0, 1, 0}});
  CHECK(faces_of(text) == Faces{{0, 1, 2}, {0, 2, 3}});
  for (const bool big : {false, true}) {
    const PolygonMesh mesh = read(binary_ply(big), "a.ply");
    CHECK(mesh.points_world == text.points_world);
    CHECK(faces_of(mesh) == faces_of(text));
  }
}

TEST_CASE("polygons: PLY reads every type, faces before vertices and every line end") {
  const std::vector<std::vector<std::string>> names{
      {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
      {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
  const std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  for (std::size_t n = 0; n < names.size(); ++n) {
    for (const std::string& name : names[n]) {
      for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string file;
        for (const std::string line :
             {"ply", "format binary_big_endian 1.0", "element face 1",
              "property list uchar char vertex_index", "element vertex 3", "property float x"}) {
          file += line + end;
        }
        file += "property " + name + " y" + end + "property float z" + end + "end_header" + end;
        file += std::string("\x03\x00\x01\x02", 4);
        for (int v = 0; v < 3; ++v) {
          file += float_bytes(10, true);  // begins with "A", and " " in other orders
          if (n == 6) file += float_bytes(static_cast<float>(v), true);
          if (n == 7) file += double_bytes(v, true);
          if (n < 6) file += std::string(sizes[n] - 1, '\0') + static_cast<char>(v);
          file += float_bytes(0, true);
        }
        CAPTURE(name);
        REQUIRE(said_of(file, "a.ply") == "");
        CHECK(read(file, "a.ply").points_world == Vec3List{{10, 0, 0}, {10, 1, 0}, {10, 2, 0}});
      }
    }
  }
}

TEST_CASE("polygons: a body of PLY that begins like an end of line is no end of line") {
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
      "property uchar x\nproperty uchar y\nproperty uchar z\n"
      "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  const std::string rows = std::string("\n\0\0\r\1\0\0\0\0\3\0\1\2", 13);
  CHECK(read(head + rows, "a.ply").points_world[0] == Vec3(10, 0, 0));
  const std::string mixed = head.substr(0, head.size() - 1) + "\r\n";
  CHECK(read(mixed + rows, "a.ply").points_world[0] == Vec3(10, 0, 0));
  std::string carriage = head;
  for (char& c : carriage) c = c == '\n' ? '\r' : c;
  CHECK(read(carriage + rows, "a.ply").points_world[0] == Vec3(10, 0, 0));
}

TEST_CASE("polygons: PLY that contradicts itself is refused with line or byte") {
  const auto with = [](std::string file, const std::string& from, const std::string& to) {
    file.replace(file.find(from), from.size(), to);
    return said_of(file, "a.ply");
  };
  const std::string text = ascii_ply();
  const std::string binary = binary_ply(false);
  CHECK(contains(with(text, "vertex 4", "vertex 4000000"),
                 "a.ply, line 4: counts 4000000 rows of element \"vertex\", of 10 bytes"));
  CHECK(contains(with(binary, "face 2", "face 90000000000000000"), "line 13: counts 9000000000"));
  CHECK(contains(with(binary, "edge 2", "edge 99999"), "line 10: counts 99999 rows of element"));
  CHECK(contains(with(text, "vertex 4", "vertex 4000000000000"), "2^31 - 1 are the most"));
  CHECK(contains(with(text, "vertex 4", "vertex -4"), "line 4: an element without its name and"));
  CHECK(contains(with(text, "float x", "half x"), "line 6: the type \"half\""));
  CHECK(contains(with(text, "property float x", "property float q"), "without a number 'x'"));
  CHECK(contains(with(text, "vertex_indices", "corners"), "faces without a list of whole numbers"));
  CHECK(contains(with(text, "uint int vertex", "uint float vertex"), "faces without a list of"));
  CHECK(contains(with(text, "uint int vertex", "float int vertex"), "a list counted by fractions"));
  CHECK(contains(with(text, "ascii", "binary"), "line 2: the format \"binary\""));
  CHECK(contains(with(text, "element face", "element faces"), "no element 'vertex' or no element"));
  CHECK(contains(with(text, "end_header", "end"), "line 16: \"end\" in a header"));
  CHECK(
      contains(with(text, "3 0 1 2 -1", "3 0 1 4 -1"), "line 23: 4 is no vertex, of 4, in row 1"));
  CHECK(
      contains(with(text, "3 0 1 2 -1", "3 0 1 2 -1 7"), "line 23: \"7\" after the last property"));
  CHECK(contains(with(text, "9 1 0 0 2", "9 1 0 0 -2"), "line 18: a list of -2 values"));
  CHECK(contains(with(text, "9 1 0 0 2", "9 1 o 0 2"), "line 18: \"o\" is not a number"));
  CHECK(contains(said_of(text + "3 1 2 3 0\n", "a.ply"), "line 25: rows go on after those that"));
  CHECK(contains(said_of(binary + "xxxx", "a.ply"), "4 bytes more than the header counts"));
  CHECK(said_of(binary + "\n", "a.ply") == "");
  CHECK(contains(said_of(binary.substr(0, binary.size() - 1), "a.ply"),
                 "the file ends in row 2 of 2 of element \"face\""));
}

TEST_CASE("polygons: OFF is read with all its headers, comments and colours") {
  const std::string body = "0 0 0\n1 0 0 # c\n1 1 0\n\n# c\n0 1 0\n3 0 1 2\n4 0 1 2 3 255 0 0\n";
  const std::string more = "0 0 0 1 0 0 1\n1 0 0 1 0 0\n1 1 0 9\n0 1 0\n3 0 1 2 0.5\n4 0 1 2 3";
  for (const std::string header :
       {"OFF\n4 2 0\n", "OFF 4 2 5\n", "OFF # c\n# c\n\n4 2\n", "COFF\n4 2 0\n", "NOFF 4 2 0\n",
        "CNOFF\n4 2 0\n", "STOFF\n4 2 0\n", "STCNOFF\n4 2 0\n", "4 2 0\n",
        "# c\nOFF\r\n4 2 0\r\n"}) {
    for (const std::string& rest : {body, more}) {
      CAPTURE(header + rest);
      REQUIRE(said_of(header + rest, "a.off") == "");
      const PolygonMesh mesh = read(header + rest, "a.off");
      CHECK(mesh.points_world == Vec3List{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
      CHECK(faces_of(mesh) == Faces{{0, 1, 2}, {0, 1, 2, 3}});
    }
  }
}

TEST_CASE("polygons: indices of OFF count from 1 where they can mean nothing else") {
  const std::string points = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const PolygonMesh mesh = read(points + "3 1 2 3\n3 3 4 1\n", "a.off");
  CHECK(mesh.counted_from_one);
  CHECK(faces_of(mesh) == Faces{{0, 1, 2}, {2, 3, 0}});
  CHECK_FALSE(read(points + "3 1 2 3\n3 3 2 1\n", "a.off").counted_from_one);
  // One of 0, none of 1, one of two past the last.
  for (const std::string faces : {"3 1 2 3\n3 0 4 1\n", "3 2 3 4\n3 4 3 2\n"}) {
    CHECK(contains(said_of(points + faces, "a.off"), "4 is no point, of 4; indices count from 0"));
  }
  CHECK(contains(said_of(points + "3 1 2 3\n3 3 4 5\n", "a.off"), "line 8: 5 is no point, of 4"));
}

TEST_CASE("polygons: OFF of other kinds and with wrong counts is refused by name") {
  const auto said = [](const std::string& text) { return said_of(text, "a.off"); };
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  CHECK(contains(said("OFF BINARY\n"), "a.off, line 1: binary OFF"));
  CHECK(contains(said("4OFF\n3 1 0\n" + body), "line 1: \"4OFF\" has points of other than three"));
  CHECK(contains(said("nOFF\n3\n3 1 0\n" + body), "\"nOFF\" has points of other than three"));
  CHECK(contains(said("OFF\n353535235358 1 0\n" + body), "line 2: counts 353535235358 points"));
  CHECK(contains(said("OFF\n3 -1 0\n" + body), "line 2: \"-1\" is no whole number"));
  CHECK(contains(said("OFF\n4 1 0\n" + body), "line 6: 3 is no whole number") == false);
  CHECK(contains(said("OFF\n4 1 0\n" + body), "the file ends before the count of corners"));
  CHECK(contains(said("OFF\n3 2 0\n" + body), "the file ends before the count of corners"));
  CHECK(contains(said("OFF\n2 1 0\n" + body), "line 5: 1 is no point, of 2") == false);
  CHECK(contains(said("OFF\n3 1 0\n" + body + "3 0 1 2\n"), "line 7: \"3\" after the 1 faces"));
  CHECK(contains(said("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
                 "line 6: 3 is no point, of 3; indices count from 0"));
  CHECK(
      contains(said("OFF\n3 1 0\n0 0 0\n1 0 a\n0 1 0\n3 0 1 2\n"), "line 4: z = \"a\" of point 1"));
  CHECK(contains(said("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "holds no face"));
}

TEST_CASE("polygons: contents tell the format where the extension lies, and gzip is unpacked") {
  const std::string stl = binary_stl("solid", kTwoTriangles);
  CHECK(read(stl, "a.ply").faces() == 2);
  CHECK(read(ascii_ply(), "a.stl").faces() == 2);
  CHECK(read(kTextStl, "a").faces() == 1);
  CHECK(read("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.OBJ").faces() == 1);
  CHECK(read(kTriangleObj, "dir.gz/a.OBJ").faces() == 1);
  CHECK(contains(said_of(kTriangleObj, "a.txt"), "a.txt: is none of STL, OBJ, PLY and OFF"));
  for (const std::string& file : {stl, ascii_ply(), kTextStl}) {
    CHECK(read(packed(file), "a.gz").points_world == read(file, "a").points_world);
  }
  CHECK(read(packed(kTriangleObj), "a.obj.gz").faces() == 1);
  CHECK(read(packed("v 0 0 0\nv 1 0 0\n") + packed("v 0 1 0\nf 1 2 3\n"), "a.obj").faces() == 1);
  const TempFolder folder;
  std::ofstream(folder / "a.stl.gz") << packed(stl);
  CHECK(read_polygons((folder / "a.stl.gz").string()).faces() == 2);
  CHECK(detect_polygons((folder / "a.stl.gz").string()) == PolygonFormat::Stl);
  CHECK_THROWS_AS(read_polygons((folder / "none.stl").string()), IoError);
}

TEST_CASE("polygons: UTF-16, damaged and overlarge packed files are refused by name") {
  std::string wide;
  for (const char c : kTriangleObj) (wide += '\0') += c;
  CHECK(contains(said_of("\xFE\xFF" + wide, "a.obj"), "a.obj: is text in UTF-16"));
  CHECK(contains(said_of(wide, "a.obj"), "is text in UTF-16"));
  CHECK(contains(said_of(wide.substr(1), "a.obj"), "is text in UTF-16"));
  CHECK(contains(said_of("", "a.obj"), "is empty"));
  const std::string good = packed(kTriangleObj);
  CHECK(contains(said_of(good.substr(0, good.size() - 1), "a.obj"), "ends too early"));
  std::string bad = good;
  bad[good.size() - 6] = static_cast<char>(bad[good.size() - 6] ^ 1);
  CHECK(contains(said_of(bad, "a.obj"), "what gzip packed is damaged"));
  CHECK(contains(said_of(packed(good), "a.obj"), "is packed twice"));
  const std::string bomb = packed(std::string(1'000'000, ' '));
  CHECK(unpacked(bomb, "a.gz", 1'000'000).size() == 1'000'000);
  CHECK_THROWS_AS(unpacked(bomb, "a.gz", 999'999), LimitError);
}
