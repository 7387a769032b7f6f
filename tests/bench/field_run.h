#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/inputs.h"

namespace vdb_offset::bench {

/// Triangles to field by ours alone, both sides; medians over the repeats.
struct FieldRun {
  std::uint64_t active_voxels = 0;
  std::uint64_t tree_bytes = 0;
  std::uint64_t peak_bytes = 0;  ///< of the process, program and triangles included
  double rasterize_s = 0;        ///< the wall is there already
  double sweep_s = 0;
};

struct FieldRunSetting {
  std::string input;  ///< of input_cases(), or sphere-R for any radius R
  double band = 0;    ///< voxels
  std::size_t threads = 1;
  int repeats = 1;
  std::string bwb;
  int processor = -1;  ///< the only one to run on; -1: any
};

/// In a process of its own, so that the peak is of this run: the program calls itself.
FieldRun run_apart(const FieldRunSetting& setting);
/// What that process does with the arguments that it gets; prints the result.
int answer_run_apart(const std::vector<std::string>& arguments);

/// Spheres whose band has from 1e6 to 2e8 active voxels: figures a voxel, printed, and as JSON
/// objects.
std::vector<std::string> scaling(const std::vector<std::size_t>& threads, int repeats);

}  // namespace vdb_offset::bench
