// The distance to a part changes by no more than the way gone. So what is nearest to some place of
// a ball (centre c, radius r, wall at the distance d) is no farther from c than d + 2 r. And the
// side of one part alone changes at that part's wall only.

#include "rasterize/side_parts.h"

#include <Eigen/Geometry>

#include "core/sets.h"

namespace vdb_offset {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// A body: what holds together by its vertices.
struct Body {
  std::vector<Wall::Triangle> triangles;
  Box box;
  int turn = 0;  // sign of its volume: 1 if the normals point out
};

void measure(const Vec3List& v, Body& body) {
  const Vec3 origin = v[at(body.triangles.front()[0])];
  double volume = 0;
  for (const Wall::Triangle& t : body.triangles) {
    const Vec3 a = v[at(t[0])] - origin;
    volume += a.dot((v[at(t[1])] - origin).cross(v[at(t[2])] - origin));
    for (const int corner : t) body.box.add(v[at(corner)]);
  }
  body.turn = volume > 0 ? 1 : (volume < 0 ? -1 : 0);
}

std::vector<Body> bodies_of(const Wall& wall) {
  Sets sets(wall.vertices().size());
  for (const Wall::Triangle& t : wall.triangles()) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  std::vector<int> number(wall.vertices().size(), -1);
  std::vector<Body> bodies;
  for (const Wall::Triangle& t : wall.triangles()) {
    int& n = number[at(sets.root(t[0]))];
    if (n < 0) {
      n = static_cast<int>(bodies.size());
      bodies.emplace_back();
    }
    bodies[at(n)].triangles.push_back(t);
  }
  for (Body& body : bodies) measure(wall.vertices(), body);
  return bodies;
}

bool apart(const Box& a, const Box& b) {
  return (a.lo.array() > b.hi.array()).any() || (b.lo.array() > a.hi.array()).any();
}

/// Bodies turned alike and apart agree; others may not, and asking each is right in any case.
bool agrees(const std::vector<const Body*>& part, const Body& body) {
  for (const Body* other : part) {
    if (other->turn != body.turn || !apart(other->box, body.box)) return false;
  }
  return true;
}

/// The triangles of a part, with the vertices that they use.
std::unique_ptr<const Wall> wall_of(const std::vector<const Body*>& part, const Vec3List& all) {
  std::vector<int> number(all.size(), -1);
  Vec3List vertices;
  std::vector<Wall::Triangle> triangles;
  for (const Body* body : part) {
    for (Wall::Triangle t : body->triangles) {
      for (int& corner : t) {
        int& n = number[at(corner)];
        if (n < 0) {
          n = static_cast<int>(vertices.size());
          vertices.push_back(all[at(corner)]);
        }
        corner = n;
      }
      triangles.push_back(t);
    }
  }
  return std::make_unique<const Wall>(std::move(vertices), std::move(triangles));
}

double reach_of(const SideBall& ball) {
  return (ball.distance_world + 2 * ball.radius_world) * (1 + 1e-9);
}

}  // namespace

SideParts::SideParts(const Surface& surface) {
  if (!surface.closed || surface.topology.components == 1) return;
  const std::vector<Body> bodies = bodies_of(*surface.wall);
  std::vector<std::vector<const Body*>> parts;
  for (const Body& body : bodies) {
    std::size_t p = 0;
    while (p < parts.size() && !agrees(parts[p], body)) ++p;
    if (p == parts.size()) parts.emplace_back();
    parts[p].push_back(&body);
  }
  if (parts.size() == 1) return;
  for (const auto& part : parts) parts_.push_back(wall_of(part, surface.wall->vertices()));
}

bool SideParts::has_one_side(const SideBall& ball) const {
  double side = 0;
  for (const auto& part : parts_) {
    const WallPoint nearest = part->closest(ball.centre, reach_of(ball));
    if (nearest.triangle < 0) continue;
    const double here = nearest.side(ball.centre);
    if (side * here < 0) return false;
    side = here;
  }
  return true;
}

bool SideParts::has_one_part(const SideBall& ball) const {
  int count = 0;
  for (const auto& part : parts_) {
    if (part->closest_place(ball.centre, reach_of(ball)).triangle >= 0) ++count;
  }
  return count <= 1;
}

}  // namespace vdb_offset
