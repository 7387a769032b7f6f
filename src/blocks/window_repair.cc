#include "blocks/window_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "blocks/face_state.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr int kRounds = 6;
constexpr double kLower = 0.8;  // of a height, where there is no valid place at it
constexpr double kCare = 4;     // how much more a face that failed counts in the next round
constexpr double kMostCare = 64;
constexpr double kLeastGrading = 1.2;  // ratio of neighbouring heights that is never refused
constexpr double kGentle = 0.25;       // difference of neighbouring heights over their edge that
                                       // is never refused: near zero a ratio hardly climbs
constexpr double kSteepest = 1;        // and that is never allowed
/// Rise of the distance along a column below which it follows the bisector of a corner too sharp
/// (2 asin 0.45 = 53 degrees) for the columns beside it to be turned along.
constexpr double kLeastRise = 0.45;
constexpr double kOfRoom = 0.9;     // of the height where they meet the bisector there
constexpr std::size_t kGrain = 64;  // faces

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// As long as on the wall; where columns spread far, as behind a thin trailing edge, as they have.
/// Lesser fans are to share what they spread with their neighbours.
std::vector<double> edge_lengths(const ColumnVector& x, int a, int b) {
  constexpr double kFar = 40;  // times the wall's edge
  constexpr double kShare = 0.25;
  std::vector<double> lengths(x.levels());
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const double length = (x.get(at(a), k) - x.get(at(b), k)).norm();
    lengths[k] = length;
    if (k == 0 || !(lengths[0] > 0)) continue;
    lengths[k] =
        std::max(lengths[0], length * std::clamp(length / (kFar * lengths[0]), kShare, 1.0));
  }
  return lengths;
}

/// Heights that do not step between neighbours: lowers the free ones until none does.
void grade(const Window& window, const ColumnVector& x, double ratio, std::vector<double>& height) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const ColumnFace& face : window.faces) {
      for (std::size_t c = 0; c < face.count; ++c) {
        const std::size_t a = at(face.column[c]);
        const std::size_t b = at(face.next(c));
        const double length = (x.get(a, 0) - x.get(b, 0)).norm();
        const std::size_t low = height[a] < height[b] ? a : b;
        const std::size_t high = low == a ? b : a;
        const double most = std::min(std::max(ratio * height[low], height[low] + kGentle * length),
                                     height[low] + kSteepest * length);
        if (!(length > 0) || high >= window.free || height[high] <= most * (1 + 1e-9)) continue;
        height[high] = most;
        changed = true;
      }
    }
  }
}

}  // namespace

WindowRepair::WindowRepair(const Surface& surface, const MultiBlock& mesh, const Window& window,
                           double quality)
    : surface_(surface), layers_(mesh.layers), window_(window) {
  const auto levels = at(layers_.levels());
  shape_.points_world = ColumnVector(window.nodes.size(), levels);
  for (std::size_t s = 0; s < window.nodes.size(); ++s) {
    for (std::size_t k = 0; k < levels; ++k) {
      shape_.points_world.set(s, k, layers_.at(window.nodes[s], static_cast<int>(k)));
    }
    shape_.heights_world.push_back(layers_.heights(at(window.nodes[s])));
    asked_.push_back(shape_.heights_world.back().back());
  }
  const auto point = [&](int slot, std::size_t level) {
    return shape_.points_world.get(at(slot), level);
  };
  for (const ColumnFace& face : window.faces) {
    wanted_.push_back(std::min(quality, kOfWall * wall_quality(face, point)));
    shape_.care.emplace_back();
    auto& edges = shape_.edges_world.emplace_back();
    for (std::size_t c = 0; c < face.count; ++c) {
      edges[c] = edge_lengths(shape_.points_world, face.column[c], face.next(c));
    }
  }
  cap_sharp_corners();
}

/// Columns that run into the bisector of a sharp corner end before it.
void WindowRepair::cap_sharp_corners() {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const std::size_t levels = shape_.points_world.levels();
  std::vector<double> height = asked_;
  std::vector<bool> in_corner(window_.free, false);  // from the wall on
  bool any = false;
  for (std::size_t s = 0; s < window_.free; ++s) {
    const std::vector<double>& heights = shape_.heights_world[s];
    for (std::size_t k = 0; k + 1 < levels; ++k) {
      const double length =
          (shape_.points_world.get(s, k + 1) - shape_.points_world.get(s, k)).norm();
      if (heights[k + 1] - heights[k] >= kLeastRise * length) continue;
      any = true;
      in_corner[s] = k == 0;
      height[s] = k == 0 ? kNone : kOfRoom * heights[k];
      break;
    }
  }
  if (!any) return;
  // In the corner itself there is as much as its lowest neighbour has.
  const std::vector<double> beside = height;
  for (const ColumnFace& face : window_.faces) {
    for (std::size_t c = 0; c < face.count; ++c) {
      const std::size_t s = at(face.column[c]);
      if (s >= window_.free || !in_corner[s]) continue;
      height[s] = std::min({height[s], beside[at(face.next(c))], beside[at(face.previous(c))]});
    }
  }
  for (std::size_t s = 0; s < window_.free; ++s) height[s] = std::min(height[s], asked_[s]);
  sink_to(height);
}

/// Looks at all faces, and raises the care for those that fail; where care did not help their
/// heights sink. Whether none fails.
bool WindowRepair::take_care(bool may_sink) {
  std::vector<FaceState> states(window_.faces.size());
  parallel::for_ranges(states.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      states[f] = judge_face(
          window_.faces[f], shape_.points_world.levels() - 1,
          [&](int slot, std::size_t level) { return shape_.points_world.get(at(slot), level); });
    }
  });
  std::vector<double> height;
  for (const std::vector<double>& heights : shape_.heights_world) height.push_back(heights.back());
  std::vector<bool> sinks(height.size(), false);
  bool fails = false;
  positive_ = true;
  for (std::size_t f = 0; f < states.size(); ++f) {
    WindowShape::Care& care = shape_.care[f];
    if (states[f].positive && states[f].scaled_jacobian >= wanted_[f]) continue;
    fails = true;
    positive_ = positive_ && states[f].positive;
    const bool had_care = care.tetrahedra;
    care.tetrahedra = true;
    care.weight = std::min(care.weight * kCare, kMostCare);
    for (std::size_t c = 0; !states[f].positive && had_care && c < window_.faces[f].count; ++c) {
      sinks[at(window_.faces[f].column[c])] = true;
    }
  }
  for (std::size_t s = 0; s < sinks.size(); ++s) {
    if (sinks[s] && s < window_.free) height[s] *= kLower;
  }
  if (may_sink && std::find(sinks.begin(), sinks.end(), true) != sinks.end()) sink_to(height);
  return !fails;
}

/// Lowers heights, and neighbours' with them, so that they do not step.
void WindowRepair::sink_to(std::vector<double> heights_world) {
  const double ratio = std::max(kLeastGrading, layers_.spacing.growth);
  grade(window_, shape_.points_world, ratio, heights_world);
  for (std::size_t s = 0; s < window_.free; ++s) set_height(s, heights_world[s]);
}

/// Puts a column's levels to a lesser height, along the column as it is.
void WindowRepair::set_height(std::size_t slot, double height_world) {
  std::vector<double>& heights = shape_.heights_world[slot];
  if (!(height_world < heights.back())) return;
  const double first = layers_.first_asked_world[at(window_.nodes[slot])];
  const std::vector<double> lower = rescale(layers_.spacing, height_world, first);
  Vec3List points;
  std::size_t k = 0;
  for (const double h : lower) {
    while (k + 2 < heights.size() && heights[k + 1] < h) ++k;
    const double part = std::clamp((h - heights[k]) / (heights[k + 1] - heights[k]), 0.0, 1.0);
    points.emplace_back((1 - part) * shape_.points_world.get(slot, k) +
                        part * shape_.points_world.get(slot, k + 1));
  }
  for (std::size_t n = 1; n < points.size(); ++n) shape_.points_world.set(slot, n, points[n]);
  heights = lower;
}

void WindowRepair::run(const Progress& progress) {
  for (int round = 0; round <= kRounds; ++round) {
    steps_ += untangle(surface_, window_, shape_, progress);
    if (take_care(/*may_sink=*/round < kRounds)) return;
  }
}

int WindowRepair::write(MultiBlock& mesh) const {
  Layers& layers = mesh.layers;
  const auto levels = at(layers.levels());
  int lowered = 0;
  for (std::size_t s = 0; s < window_.free; ++s) {
    const std::size_t node = at(window_.nodes[s]);
    Vec3* const points = layers.points_world.data() + node * levels;
    for (std::size_t k = 1; k < levels; ++k) points[k] = shape_.points_world.get(s, k);
    layers.first_cell_world[node] = surface_.wall->closest_place(points[1]).distance_world;
    layers.height_world[node] = surface_.wall->closest_place(points[levels - 1]).distance_world;
    const double off = std::abs(layers.height_world[node] / asked_[s] - 1);
    if (off > 1e-6) layers.stop[node] = Stop::Repaired;
    if (shape_.heights_world[s].back() < asked_[s]) ++lowered;
  }
  return lowered;
}

}  // namespace vdb_offset
