// Ours against OpenVDB's tools for distance fields, in one process, by turns:
// tools::meshToVolume, and tools::FastSweeping as dilateSdf and as sdfToSdf.
//
//   field_bench [--repeats N] [--threads N]... [--only NAME] [--bwb FILE] [--json FILE]
//   field_bench --scaling [--repeats N] [--threads N]... [--json FILE]
//
// Prints medians and ratios; `--json` writes them as an array of objects. NAME is a part of a row's
// name. The peer takes two minutes a repeat of the largest row on one thread.

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/field_run.h"
#include "bench/inputs.h"
#include "bench/measure.h"
#include "bench/raster_duel.h"
#include "bench/sweep_duel.h"
#include "large_heap.h"

using namespace vdb_offset::bench;

namespace {

struct Arguments {
  int repeats = 5;
  std::vector<std::size_t> threads;
  std::string only;
  std::string json;
  std::string bwb = VDB_OFFSET_SOURCE_DIR "/../shared/data/plot3d/bwb.fmt";
  bool scaling = false;
};

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t n = 0; n < words.size(); ++n) {
    const std::string& name = words[n];
    if (name == "--scaling") {
      arguments.scaling = true;
      continue;
    }
    if (n + 1 == words.size()) throw std::invalid_argument(name + ": no value");
    const std::string& value = words[++n];
    if (name == "--repeats")
      arguments.repeats = std::stoi(value);
    else if (name == "--threads")
      arguments.threads.push_back(std::stoul(value));
    else if (name == "--only")
      arguments.only = value;
    else if (name == "--json")
      arguments.json = value;
    else if (name == "--bwb")
      arguments.bwb = value;
    else
      throw std::invalid_argument(name + ": no such option");
  }
  if (arguments.repeats < 1) throw std::invalid_argument("--repeats: must be at least 1");
  if (arguments.threads.empty()) arguments.threads = {1, 2};
  return arguments;
}

struct Row {
  std::string name;
  std::size_t threads = 1;
  std::uint64_t active_voxels = 0;
  double sweep_ns = 0, plain_ns = 0, peer_sweep_ns = 0, peer_whole_ns = 0;
  double rasterize_s = 0, wall_s = 0, peer_rasterize_s = 0;
  std::uint64_t peak_bytes = 0;
  double visits_per_tile = 0;
  int sweeps = 0;
  double sweep_worst = 0;                                // largest difference, voxels
  double rasterize_worst = 0, peer_rasterize_worst = 0;  // largest errors, voxels
};

void print_head() {
  fmt::print(
      "sweep: ns a voxel, ours with the chosen kernels and the plain ones; peer: sweep alone, and "
      "with the making of its voxels; the fields' largest difference, voxels\n"
      "rasterize: s, ours with the wall; largest errors, voxels\n"
      "{:30} {:>2} {:>10} {:>7} {:>7} {:>8} {:>8} {:>6} {:>6} {:>6} {:>3} {:>8} {:>8} {:>8} {:>8} "
      "{:>6} {:>8} {:>8} {:>8}\n",
      "", "th", "voxels", "sweep", "plain", "peer", "+init", "ratio", "plain", "visits", "swp",
      "differ", "raster", "wall", "peer", "ratio", "error", "peer's", "peak MB");
}

void print(const Row& row) {
  fmt::print(
      "{:30} {:2} {:>10} {:7.2f} {:7.2f} {:8.1f} {:8.1f} {:6.2f} {:6.2f} {:6.2f} {:3} {:8.1e} "
      "{:8.4f} {:8.4f} {:8.4f} {:6.2f} {:8.1e} {:8.1e} {:8.1f}\n",
      row.name, row.threads, row.active_voxels, row.sweep_ns, row.plain_ns, row.peer_sweep_ns,
      row.peer_whole_ns, row.peer_sweep_ns / row.sweep_ns, row.peer_sweep_ns / row.plain_ns,
      row.visits_per_tile, row.sweeps, row.sweep_worst, row.rasterize_s, row.wall_s,
      row.peer_rasterize_s, row.peer_rasterize_s / row.rasterize_s, row.rasterize_worst,
      row.peer_rasterize_worst, static_cast<double>(row.peak_bytes) / (1 << 20));
  std::fflush(stdout);
}

std::string json(const Row& row) {
  return fmt::format(
      R"({{"name": "{}", "threads": {}, "active_voxels": {}, "sweep_ns": {:.3f}, )"
      R"("peer_sweep_ns": {:.3f}, "sweep_ratio": {:.3f}, "rasterize_s": {:.6f}, )"
      R"("peer_rasterize_s": {:.6f}, "rasterize_ratio": {:.3f}, "peak_bytes": {}, )"
      R"("plain_sweep_ns": {:.3f}, "plain_sweep_ratio": {:.3f}, "peer_whole_ns": {:.3f}}})",
      row.name, row.threads, row.active_voxels, row.sweep_ns, row.peer_sweep_ns,
      row.peer_sweep_ns / row.sweep_ns, row.rasterize_s, row.peer_rasterize_s,
      row.peer_rasterize_s / row.rasterize_s, row.peak_bytes, row.plain_ns,
      row.peer_sweep_ns / row.plain_ns, row.peer_whole_ns);
}

constexpr Start kStarts[] = {Start::DilateSdf, Start::SdfToSdf};

std::string row_name(const std::string& input, int band, Start start) {
  return fmt::format("{}-band-{}-{}", input, band,
                     start == Start::DilateSdf ? "dilateSdf" : "sdfToSdf");
}

Row row_of(const RasterDuel& raster, const SweepDuel& sweep, std::size_t threads) {
  const SweepDuel::Cost cost = sweep.cost_ns(threads);
  Row row;
  row.threads = threads;
  row.active_voxels = sweep.active_voxels();
  row.sweep_ns = cost.ours;
  row.plain_ns = cost.plain;
  row.peer_sweep_ns = cost.peer;
  row.peer_whole_ns = cost.whole;
  row.rasterize_s = raster.ours_s();
  row.wall_s = raster.wall_s();
  row.peer_rasterize_s = raster.peer_s();
  row.visits_per_tile = sweep.visits_per_tile();
  row.sweeps = sweep.sweeps();
  row.sweep_worst = sweep.worst_voxels();
  row.rasterize_worst = raster.worst_voxels();
  row.peer_rasterize_worst = raster.peer_worst_voxels();
  return row;
}

/// All rows of one input.
class Contest {
 public:
  Contest(const InputCase& which, const Arguments& arguments)
      : which_(which), arguments_(arguments), input_(which.make()) {
    for (const std::size_t threads : arguments.threads) rasters_.try_emplace(threads, input_);
    for (int n = 0; n < arguments.repeats; ++n) {
      for (auto& [threads, duel] : rasters_) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        duel.repeat();
      }
    }
  }

  void add_band(int band, std::vector<Row>& rows) const {
    const openvdb::FloatGrid& narrow = *rasters_.begin()->second.narrow();
    const openvdb::FloatGrid::Ptr field = peer_field(narrow, band);
    std::map<std::size_t, std::uint64_t> peak_bytes;
    for (const std::size_t threads : arguments_.threads) {
      peak_bytes[threads] =
          run_apart({which_.name, static_cast<double>(band), threads, 1, arguments_.bwb})
              .peak_bytes;
    }
    for (const Start start : kStarts) {
      const std::string name = row_name(which_.name, band, start);
      if (name.find(arguments_.only) == std::string::npos) continue;
      SweepDuel duel({narrow, *field, input_.closed, band, arguments_.threads}, start);
      for (int n = 0; n < arguments_.repeats; ++n) duel.repeat();
      for (const std::size_t threads : arguments_.threads) {
        Row row = row_of(rasters_.at(threads), duel, threads);
        row.name = name;
        row.peak_bytes = peak_bytes.at(threads);
        print(row);
        rows.push_back(row);
      }
    }
  }

 private:
  const InputCase& which_;
  const Arguments& arguments_;
  Input input_;
  std::map<std::size_t, RasterDuel> rasters_;
};

std::vector<int> bands_asked(const InputCase& which, const std::string& only) {
  std::vector<int> bands;
  for (const int band : which.bands) {
    bool asked = false;
    for (const Start start : kStarts) {
      asked = asked || row_name(which.name, band, start).find(only) != std::string::npos;
    }
    if (asked) bands.push_back(band);
  }
  return bands;
}

std::vector<Row> compare(const Arguments& arguments) {
  print_head();
  std::vector<Row> rows;
  for (const InputCase& which : input_cases(arguments.bwb)) {
    const std::vector<int> bands = bands_asked(which, arguments.only);
    if (bands.empty()) continue;
    if (which.name == "bwb" && !std::filesystem::is_regular_file(arguments.bwb)) {
      fmt::print("{:30} skipped: there is no {}; give --bwb FILE\n", which.name, arguments.bwb);
      continue;
    }
    const Contest contest(which, arguments);
    for (const int band : bands) contest.add_band(band, rows);
  }
  return rows;
}

void print_threads(const std::vector<Row>& rows) {
  std::map<std::string, Row> single;
  for (const Row& row : rows) {
    if (row.threads == 1) single[row.name] = row;
  }
  for (const Row& row : rows) {
    const auto one = single.find(row.name);
    if (row.threads == 1 || one == single.end()) continue;
    fmt::print("{:30} {} threads are {:.2f} times one: sweep; {:.2f}: rasterize\n", row.name,
               row.threads, one->second.sweep_ns / row.sweep_ns,
               one->second.rasterize_s / row.rasterize_s);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  vdb_offset::restart_with_large_heap(argv);
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "--apart") {
    words.erase(words.begin());
    return answer_run_apart(words);
  }
  const Arguments arguments = parse(words);
  openvdb::initialize();
  const Ticks before = ticks();
  std::vector<std::string> objects;
  if (arguments.scaling) {
    objects = scaling(arguments.threads, arguments.repeats);
  } else {
    const std::vector<Row> rows = compare(arguments);
    print_threads(rows);
    for (const Row& row : rows) objects.push_back(json(row));
  }
  print_stolen(before);
  if (write_json(arguments.json, objects)) return 0;
  fmt::print(stderr, "field_bench: {} cannot be written\n", arguments.json);
  return 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "field_bench: {}\n", error.what());
  return 2;
}
