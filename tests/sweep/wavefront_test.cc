#include "sweep/wavefront.h"

#include <doctest/doctest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

namespace vdb_offset::test {
namespace {

/// Leaves in a ball with holes, across the edges of the tree's nodes, and a few far away.
openvdb::FloatTree tree_of_leaves(std::mt19937& random) {
  openvdb::FloatTree tree(0.0F);
  std::uniform_int_distribution<int> dice(0, 9);
  for (int x = -7; x <= 7; ++x) {
    for (int y = -7; y <= 7; ++y) {
      for (int z = -7; z <= 7; ++z) {
        if (x * x + y * y + z * z > 50 || dice(random) == 0) continue;
        tree.touchLeaf(openvdb::Coord(8 * x, 8 * y, 8 * z));
      }
    }
  }
  for (int z = 0; z < 3; ++z) tree.touchLeaf(openvdb::Coord(4000, -3000, 8 * z));
  return tree;
}

enum class State { Asleep, Awake, Out, Done };

/// Goes through an octant with members that take and give back in any order.
class Walk {
 public:
  Walk(TileSchedule& schedule, unsigned octant, std::vector<State> states)
      : schedule_(schedule), octant_(octant), states_(std::move(states)) {}

  void take(Wavefront& wavefront, std::size_t member, std::vector<int>& own) {
    for (const int tile : own) finish(tile);
    std::array<int, TileBatch::kMost> tiles{};
    const std::size_t count = wavefront.take(member, tiles);
    own.assign(tiles.begin(), tiles.begin() + static_cast<std::ptrdiff_t>(count));
    for (const int tile : own) {
      REQUIRE(state(tile) == State::Awake);
      state(tile) = State::Out;
      for (std::size_t face = 0; face < kFaces; ++face) {
        const int other = schedule_.tile(static_cast<std::size_t>(tile)).neighbour[face];
        if (other < 0) continue;
        REQUIRE(state(other) != State::Out);
        const int step = face % 2 == 0 ? -1 : 1;
        const bool upwind = step != octant_step(octant_, static_cast<unsigned>(face / 2));
        if (upwind) {
          REQUIRE(state(other) != State::Awake);
        } else {
          REQUIRE(state(other) != State::Done);
        }
      }
    }
  }
  bool all_done() const {
    return std::none_of(states_.begin(), states_.end(),
                        [](State s) { return s == State::Awake || s == State::Out; });
  }

 private:
  State& state(int tile) { return states_[static_cast<std::size_t>(tile)]; }
  /// Wakes some of the tiles downwind, as a visit does.
  void finish(int tile) {
    const auto t = static_cast<std::size_t>(tile);
    states_[t] = State::Done;
    schedule_.calm(t);
    for (unsigned axis = 0; axis < 3; ++axis) {
      const std::size_t ahead = 2 * axis + (octant_step(octant_, axis) > 0 ? 1 : 0);
      const int other = schedule_.tile(t).neighbour[ahead];
      if (other < 0 || (t + axis) % 3 == 0) continue;
      schedule_.wake(static_cast<std::size_t>(other), 1U << octant_);
      state(other) = State::Awake;
    }
  }

  TileSchedule& schedule_;
  unsigned octant_;
  std::vector<State> states_;
};

}  // namespace

TEST_CASE("wavefront: tiles go out once, after those upwind, and never beside one that is out") {
  std::mt19937 random(7);
  openvdb::FloatTree tree = tree_of_leaves(random);
  TileSchedule schedule(tree);
  for (std::size_t f = 0; f < TileSchedule::kFamilies; ++f) schedule.order(f);
  for (const std::size_t members : {1, 2, 3, 8}) {
    Wavefront wavefront(schedule, members);
    std::size_t visits = 0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      std::vector<State> states(schedule.size(), State::Asleep);
      for (std::size_t t = 0; t < schedule.size(); ++t) {
        if (random() % 4 == 0) continue;
        schedule.wake(t, 1U << octant);
        states[t] = State::Awake;
      }
      Walk walk(schedule, octant, std::move(states));
      std::vector<std::vector<int>> out(members);
      wavefront.begin(octant);
      while (!wavefront.is_over()) {
        const bool any_out =
            std::any_of(out.begin(), out.end(), [](auto& o) { return !o.empty(); });
        const std::size_t member = random() % members;
        walk.take(wavefront, member, out[member]);
        visits += out[member].size();
        // With nothing out there is always something to take.
        REQUIRE((any_out || !out[member].empty() || wavefront.is_over()));
      }
      CHECK(walk.all_done());
    }
    CHECK(wavefront.visits() == visits);
  }
}

TEST_CASE("wavefront: no tiles, and none awake") {
  openvdb::FloatTree tree(0.0F);
  for (int leaves = 0; leaves < 2; ++leaves) {
    TileSchedule schedule(tree);
    for (std::size_t f = 0; f < TileSchedule::kFamilies; ++f) schedule.order(f);
    Wavefront wavefront(schedule, 2);
    wavefront.begin(3);
    std::array<int, TileBatch::kMost> tiles{};
    CHECK(wavefront.take(1, tiles) == 0);
    CHECK(wavefront.is_over());
    tree.touchLeaf(openvdb::Coord(8, 8, 8));
  }
}

}  // namespace vdb_offset::test
