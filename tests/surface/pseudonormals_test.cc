#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "vdb_offset/surface/wall.h"

namespace vdb_offset::test {
namespace {

/// Triangles that all have the edge from (0, 0, 0) to (1, 0, 0), at these angles about it, moved.
struct Book {
  std::vector<double> angles;
  Vec3 place;
};

Vec3 page_normal(double angle) { return {0, -std::sin(angle), std::cos(angle)}; }

Wall wall_of(const std::vector<Book>& books) {
  Vec3List vertices;
  std::vector<Wall::Triangle> triangles;
  for (const Book& book : books) {
    const int first = static_cast<int>(vertices.size());
    vertices.push_back(book.place);
    vertices.push_back(book.place + Vec3::UnitX());
    for (const double angle : book.angles) {
      triangles.push_back({first, first + 1, static_cast<int>(vertices.size())});
      vertices.emplace_back(book.place + Vec3(0.5, std::cos(angle), std::sin(angle)));
    }
  }
  return {vertices, triangles};
}

}  // namespace

TEST_CASE("pseudonormals: an edge has the sum of the normals of all its triangles") {
  // All pages below the edge, so that what is above it has the edge as its nearest place.
  const std::vector<Book> books{{{-0.3}, {0, 0, 0}},
                                {{-0.3, -2.5}, {5, 0, 0}},
                                {{-0.3, -1.2, -2.9}, {10, 0, 0}},
                                {{-1.0, -1.5, -2.0, -2.2}, {15, 0, 0}}};
  const Wall wall = wall_of(books);
  for (const Book& book : books) {
    CAPTURE(book.angles.size());
    Vec3 sum = Vec3::Zero();
    for (const double angle : book.angles) sum += page_normal(angle);
    const bool is_free = book.angles.size() == 1;
    // Straight above for the ones of several pages; off the single page's open edge.
    const Vec3 above = is_free ? Vec3(0.4, -0.2, 0.1) : Vec3(0.4, 0, 0.2);
    const WallPoint nearest = wall.closest(book.place + above);
    REQUIRE((nearest.point_world - book.place - Vec3(0.4, 0, 0)).norm() < 1e-12);
    CHECK((nearest.normal - sum.normalized()).norm() < 1e-12);
    CHECK(nearest.on_free_edge == is_free);
  }
}

}  // namespace vdb_offset::test
