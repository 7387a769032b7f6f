// Ours against OpenVDB's tools for distance fields.
//
//   bench_field_bench [--repeats N] [--threads N]... [--only TEXT] [--no-peer] [--json FILE]
//
// Prints medians and ratios; `--json` writes them as an array of objects.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "bench/sweep_cases.h"

using namespace vdb_offset;
using namespace vdb_offset::bench;

namespace {

struct Arguments {
  int repeats = 3;
  std::vector<std::size_t> threads;
  std::string only;
  std::string json;
  bool peer = true;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int n = 1; n < argc; ++n) {
    const std::string_view name = argv[n];
    if (name == "--no-peer") {
      arguments.peer = false;
      continue;
    }
    if (n + 1 == argc) throw std::invalid_argument(fmt::format("{}: no value", name));
    const char* value = argv[++n];
    if (name == "--repeats")
      arguments.repeats = std::atoi(value);
    else if (name == "--threads")
      arguments.threads.push_back(std::strtoul(value, nullptr, 10));
    else if (name == "--only")
      arguments.only = value;
    else if (name == "--json")
      arguments.json = value;
    else
      throw std::invalid_argument(fmt::format("{}: no such option", name));
  }
  if (arguments.threads.empty()) arguments.threads = {1, 2};
  return arguments;
}

void print(const SweepRow& row) {
  fmt::print("{:30} {:2} {:>10} {:8.1f} {:8.1f} {:8.1f} {:8.1f} {:7.1f} {:7.1f} {:7.2f} {:4}\n",
             row.name, row.threads, row.active_voxels, row.sweep_ns, row.plain_ns,
             row.peer_sweep_ns, row.peer_whole_ns, row.peer_sweep_ns / row.sweep_ns,
             row.peer_sweep_ns / row.plain_ns, row.visits_per_tile, row.sweeps);
  std::fflush(stdout);
}

std::string json(const SweepRow& row) {
  return fmt::format(
      R"({{"name": "{}", "threads": {}, "active_voxels": {}, "sweep_ns": {:.3f}, )"
      R"("peer_sweep_ns": {:.3f}, "sweep_ratio": {:.3f}, "plain_sweep_ns": {:.3f}, )"
      R"("plain_sweep_ratio": {:.3f}, "peer_whole_ns": {:.3f}, "visits_per_tile": {:.3f}}})",
      row.name, row.threads, row.active_voxels, row.sweep_ns, row.peer_sweep_ns,
      row.peer_sweep_ns / row.sweep_ns, row.plain_ns, row.peer_sweep_ns / row.plain_ns,
      row.peer_whole_ns, row.visits_per_tile);
}

std::vector<SweepRow> sweeps(const Arguments& arguments) {
  fmt::print("{:30} {:>2} {:>10} {:>8} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>4}\n",
             "sweep, ns a voxel", "th", "voxels", "ours", "plain", "peer", "+init", "ratio",
             "plain", "visits", "swp");
  std::vector<SweepRow> rows;
  for (const bool scratch : {false, true}) {
    for (const float radius : {100.0F, 300.0F}) {
      for (const int band : {20, 60}) {
        const SphereCase sphere{radius, band, scratch};
        if (sphere.name().find(arguments.only) == std::string::npos) continue;
        for (const std::size_t threads : arguments.threads) {
          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
          SweepDuel duel(sphere);
          for (int n = 0; n < arguments.repeats; ++n) duel.repeat(arguments.peer);
          rows.push_back(duel.row(threads));
          print(rows.back());
        }
      }
    }
  }
  return rows;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments = parse(argc, argv);
  openvdb::initialize();
  const std::vector<SweepRow> rows = sweeps(arguments);
  if (arguments.json.empty()) return 0;
  std::ofstream file(arguments.json);
  file << "[\n";
  for (std::size_t n = 0; n < rows.size(); ++n) {
    file << "  " << json(rows[n]) << (n + 1 < rows.size() ? ",\n" : "\n");
  }
  file << "]\n";
  return file.good() ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "field_bench: {}\n", error.what());
  return 2;
}
