#pragma once

// Just enough of OFF and OBJ for the quad meshes of the tests: faces of any size, no groups.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "vdb_offset/surface/polygons.h"

namespace vdb_offset::test {

inline void read_off(std::istream& in, PolygonMesh& mesh) {
  std::string word;
  std::size_t points = 0;
  std::size_t faces = 0;
  std::size_t edges = 0;
  in >> word >> points >> faces >> edges;
  mesh.points_world.resize(points);
  for (Vec3& x : mesh.points_world) in >> x.x() >> x.y() >> x.z();
  for (std::size_t f = 0; f < faces; ++f) {
    std::size_t corners = 0;
    in >> corners;
    std::vector<int> face(corners);
    for (int& corner : face) in >> corner;
    mesh.add(face);
  }
}

inline void read_obj(std::istream& in, PolygonMesh& mesh) {
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3& x = mesh.points_world.emplace_back();
      words >> x.x() >> x.y() >> x.z();
    }
    if (word != "f") continue;
    std::vector<int> face;
    while (words >> word) face.push_back(std::stoi(word) - 1);
    mesh.add(face);
  }
}

inline PolygonMesh read_quads(const std::string& file) {
  PolygonMesh mesh;
  mesh.file = file;
  std::ifstream in(file);
  file.ends_with(".off") ? read_off(in, mesh) : read_obj(in, mesh);
  return mesh;
}

}  // namespace vdb_offset::test
