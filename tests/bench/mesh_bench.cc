// The whole of `vdb-offset mesh` through the library: a surface file in, blocks and their quality,
// a PLOT3D file out, on the surfaces that other meshers were timed on.
//
//   mesh_bench [--repeats N] [--threads N]... [--only NAME] [--folder DIR] [--json FILE]
//
// Prints medians: seconds by stage, cells a second, peak memory of a process that does nothing
// else. Processor seconds, of all threads, are what a run costs on a machine that others use too.
// NAME is a part of a row's name. Files go to DIR, the system's temporary folder unless told.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>

#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/measure.h"
#include "large_heap.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::bench;

namespace {

struct Case {
  std::string name;
  std::string surface;  // of the built-in ones
  int points;           // along a patch's side
  double distance;
};

const std::vector<Case>& cases() {
  constexpr double kDistance = 0.5;
  static const std::vector<Case> all{{"sphere-129", "sphere", 129, kDistance},
                                     {"sphere-65", "sphere", 65, kDistance},
                                     {"cube-65", "cube", 65, kDistance},
                                     {"l-bar-33", "l-bar", 33, kDistance}};
  return all;
}

constexpr std::array kStages{"read",  "surface", "rasterize", "sweep",
                             "march", "blocks",  "write",     "total"};
constexpr std::size_t kTotal = kStages.size() - 1;

/// Seconds by stage.
struct Times {
  std::array<double, kStages.size()> wall{}, processor{};
};

struct Row {
  std::string name;
  std::size_t threads = 1;
  std::uint64_t cells = 0, bad_cells = 0;
  int nodes = 0, reached = 0;
  double min_jacobian = 0;
  std::uint64_t peak_bytes = 0;
  Times time;

  double cells_a_second() const { return static_cast<double>(cells) / time.wall[kTotal]; }
};

/// Times one stage after the other.
class Laps {
 public:
  void lap() {
    const double wall = wall_seconds();
    const double processor = processor_seconds();
    times_.wall[stage_] = wall - wall_;
    times_.processor[stage_] = processor - processor_;
    times_.wall[kTotal] += wall - wall_;
    times_.processor[kTotal] += processor - processor_;
    ++stage_;
    wall_ = wall;
    processor_ = processor;
  }
  const Times& times() const { return times_; }

 private:
  std::size_t stage_ = 0;
  double wall_ = wall_seconds();
  double processor_ = processor_seconds();
  Times times_;
};

Times run(const Case& which, const std::string& folder, Row& row) {
  PipelineOptions options;
  options.distance_world = which.distance;
  options.spacing.layers = 64;
  options.spacing.first_cell_world = 1e-4;
  Laps laps;
  Patches patches = read_plot3d(folder + "/" + which.name + ".xyz");
  laps.lap();
  const MeshResult result = make_mesh(std::move(patches), options, {},
                                      [&](std::string_view, const MeshResult&) { laps.lap(); });
  write_plot3d(folder + "/" + which.name + "-mesh.xyz", result.mesh);
  laps.lap();
  row.cells = result.mesh.cells();
  row.bad_cells = result.quality.report.nonpositive_cells;
  row.min_jacobian = result.quality.report.min_scaled_jacobian;
  row.nodes = result.mesh.layers.report.nodes;
  row.reached = result.mesh.layers.report.reached;
  return laps.times();
}

/// The row of one case, here; the surface's file is there.
Row run_here(const Case& which, const std::string& folder, int repeats) {
  Row row;
  std::vector<Times> all;
  for (int n = 0; n < repeats; ++n) {
    all.push_back(run(which, folder, row));
    if (n == 0) row.peak_bytes = peak_memory_bytes();
  }
  for (std::size_t s = 0; s < kStages.size(); ++s) {
    std::vector<double> wall;
    std::vector<double> processor;
    for (const Times& times : all) {
      wall.push_back(times.wall[s]);
      processor.push_back(times.processor[s]);
    }
    row.time.wall[s] = median(wall);
    row.time.processor[s] = median(processor);
  }
  return row;
}

struct Arguments {
  int repeats = 3;
  std::vector<std::size_t> threads;
  std::string only;
  std::string folder = std::filesystem::temp_directory_path().string();
  std::string json;
};

/// `--apart INDEX THREADS REPEATS FOLDER`: what the process of one row does.
int answer_apart(const std::vector<std::string>& words) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::stoul(words.at(2)));
  openvdb::initialize();
  const Row row =
      run_here(cases().at(std::stoul(words.at(1))), words.at(4), std::stoi(words.at(3)));
  fmt::print("{} {} {} {} {} {} {} {}\n", row.cells, row.bad_cells, row.nodes, row.reached,
             row.min_jacobian, row.peak_bytes, fmt::join(row.time.wall, " "),
             fmt::join(row.time.processor, " "));
  return 0;
}

/// In a process of its own, so that the peak is of this row: the program calls itself.
Row run_apart(std::size_t index, std::size_t threads, const Arguments& arguments) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = fmt::format("'{}' --apart {} {} {} '{}'", self, index, threads,
                                          arguments.repeats, arguments.folder);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"),
                                                             ::pclose);
  if (!pipe) throw std::runtime_error("cannot start " + command);
  std::string said;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) {
    said += static_cast<char>(c);
  }
  std::istringstream answer(said);
  Row row;
  answer >> row.cells >> row.bad_cells >> row.nodes >> row.reached >> row.min_jacobian >>
      row.peak_bytes;
  for (double& value : row.time.wall) answer >> value;
  for (double& value : row.time.processor) answer >> value;
  if (!answer) throw std::runtime_error("no answer from " + command);
  row.name = cases()[index].name;
  row.threads = threads;
  return row;
}

void print_head() {
  fmt::print("seconds by stage; below them, processor seconds\n{:12} {:>2} {:>9}", "", "th",
             "cells");
  for (const char* stage : kStages) fmt::print(" {:>9}", stage);
  fmt::print(" {:>10} {:>7} {:>13} {:>5} {:>6}\n", "cells/s", "peak MB", "reached", "bad",
             "min SJ");
}

void print(const Row& row) {
  fmt::print("{:12} {:2} {:>9}", row.name, row.threads, row.cells);
  for (const double value : row.time.wall) fmt::print(" {:9.3f}", value);
  fmt::print(" {:10.0f} {:7.1f} {:>13} {:>5} {:6.3f}\n{:25}", row.cells_a_second(),
             static_cast<double>(row.peak_bytes) / 1e6,
             fmt::format("{}/{}", row.reached, row.nodes), row.bad_cells, row.min_jacobian, "");
  for (const double value : row.time.processor) fmt::print(" {:9.3f}", value);
  fmt::print("\n");
  std::fflush(stdout);
}

std::string json(const Row& row) {
  std::string stages;
  for (std::size_t s = 0; s < kStages.size(); ++s) {
    stages += fmt::format(R"(, "{0}_s": {1:.6f}, "{0}_processor_s": {2:.6f})", kStages[s],
                          row.time.wall[s], row.time.processor[s]);
  }
  return fmt::format(
      R"({{"name": "{}", "threads": {}, "cells": {}, "nonpositive_cells": {}, "nodes": {}, )"
      R"("reached": {}, "min_scaled_jacobian": {:.6f}, "peak_bytes": {}, "cells_a_second": {:.0f})"
      R"({}}})",
      row.name, row.threads, row.cells, row.bad_cells, row.nodes, row.reached, row.min_jacobian,
      row.peak_bytes, row.cells_a_second(), stages);
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t n = 0; n < words.size(); n += 2) {
    const std::string& name = words[n];
    if (n + 1 == words.size()) throw std::invalid_argument(name + ": no value");
    const std::string& value = words[n + 1];
    if (name == "--repeats")
      arguments.repeats = std::stoi(value);
    else if (name == "--threads")
      arguments.threads.push_back(std::stoul(value));
    else if (name == "--only")
      arguments.only = value;
    else if (name == "--folder")
      arguments.folder = value;
    else if (name == "--json")
      arguments.json = value;
    else
      throw std::invalid_argument(name + ": no such option");
  }
  if (arguments.repeats < 1) throw std::invalid_argument("--repeats: must be at least 1");
  if (arguments.threads.empty()) arguments.threads = {1, 2};
  return arguments;
}

void run_all(const Arguments& arguments, std::vector<std::string>& objects) {
  print_head();
  for (std::size_t n = 0; n < cases().size(); ++n) {
    const Case& which = cases()[n];
    if (which.name.find(arguments.only) == std::string::npos) continue;
    const std::filesystem::path surface = arguments.folder + "/" + which.name + ".xyz";
    write_plot3d(surface, make_example(which.surface, {.points = which.points}));
    for (const std::size_t threads : arguments.threads) {
      const Row row = run_apart(n, threads, arguments);
      print(row);
      objects.push_back(json(row));
    }
    std::filesystem::remove(surface);
    std::filesystem::remove(arguments.folder + "/" + which.name + "-mesh.xyz");
  }
}

}  // namespace

int main(int argc, char** argv) try {
  vdb_offset::restart_with_large_heap(argv);
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "--apart") return answer_apart(words);
  const Arguments arguments = parse(words);
  const Ticks before = ticks();
  std::vector<std::string> objects;
  run_all(arguments, objects);
  print_stolen(before);
  if (write_json(arguments.json, objects)) return 0;
  fmt::print(stderr, "mesh_bench: {} cannot be written\n", arguments.json);
  return 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "mesh_bench: {}\n", error.what());
  return 1;
}
