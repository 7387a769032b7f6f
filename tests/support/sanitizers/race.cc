// A data race on purpose: the sanitizer run must be able to see one between our parallel tasks, and
// must not see one where the tasks are in order.

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <vector>

#include "core/parallel.h"

int main(int argc, char** argv) {
  const bool race = argc > 1 && std::string_view(argv[1]) == "race";
  constexpr std::size_t kCount = 64;
  std::vector<int> cells(kCount, 1);  // written by this thread, read by tasks
  int shared = 0;
  for (int round = 0; round < 20; ++round) {
    vdb_offset::parallel::for_ranges(kCount, 1, [&](std::size_t begin, std::size_t end) {
      std::this_thread::sleep_for(std::chrono::microseconds(50));  // so that both threads get some
      for (std::size_t n = begin; n < end; ++n) cells[n] += 1;
      if (race) shared += 1;
    });
    for (const int cell : cells) shared += cell;  // written by tasks, read by this thread
  }
  return shared > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
