#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/surface/winding.h"

namespace vdb_offset {

/// Sides of a cube of 8^3 points, all at once: Winding::inside_of_cube.
class WindingCube {
 public:
  WindingCube(const Winding& winding, const std::array<int, 3>& first, double spacing_world)
      : winding_(winding), first_(first[0], first[1], first[2]), spacing_(spacing_world) {}

  Winding::CubeMask run();

 private:
  /// Points x, ..., x + edge - 1, and so on.
  struct Part {
    int x, y, z, edge;
  };
  /// Solid angles of what is far from a part, about its centre.
  struct Far {
    double value = 0;
    Vec3 gradient = Vec3::Zero();
    double slack = 0;  // the most by which they are off anywhere in the part
  };
  /// What is near to a part: a group, or a triangle.
  struct Near {
    std::uint32_t index;
    bool is_group;
  };
  using List = std::vector<Near>;

  struct Ball {
    Vec3 centre;
    double radius;
  };

  Ball ball(const Part& part) const;
  void sort(const Ball& ball, const List& from, List& near, Far& far);
  void sort_group(const Ball& ball, std::uint32_t group, List& near, Far& far);
  void sort_triangle(const Ball& ball, std::uint32_t triangle, List& near, Far& far) const;
  void judge(const Part& part, std::size_t level, Far far);
  void judge_points(const Part& part, const Ball& ball, const List& near, const Far& far);
  void set_inside(const Part& part);

  const Winding& winding_;
  Vec3 first_;  // in spacings
  double spacing_;
  std::array<List, 4> lists_;  // a level each
  std::vector<std::uint32_t> stack_;
  Winding::CubeMask inside_{};
};

}  // namespace vdb_offset
