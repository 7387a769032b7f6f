#include "bench/field_run.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "bench/measure.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset::bench {

namespace {

// Of a sphere's radius: the shape of the scaling run's bands.
constexpr double kBandPart = 0.2;

Input input_named(const FieldRunSetting& setting) {
  for (const InputCase& known : input_cases(setting.bwb)) {
    if (known.name == setting.input) return known.make();
  }
  return sphere(std::stod(setting.input.substr(setting.input.find('-') + 1)));
}

RasterizeOptions band_options(double band) {
  RasterizeOptions options;
  options.voxel_world = 1;
  options.distance_world = band - kBandMarginVoxels;
  options.both_sides = true;
  return options;
}

FieldRun run_here(const FieldRunSetting& setting) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, setting.threads);
  openvdb::initialize();
  const Surface surface = input_named(setting).surface();
  FieldRun run;
  std::vector<double> rasterize_s;
  std::vector<double> sweep_s;
  for (int n = 0; n < setting.repeats; ++n) {
    Band band;
    rasterize_s.push_back(seconds([&] { band = rasterize(surface, band_options(setting.band)); }));
    DistanceField field;
    sweep_s.push_back(seconds([&] { field = sweep(std::move(band)); }));
    run.active_voxels = field.report.active_voxels;
    run.tree_bytes = field.report.bytes;
    if (n == 0) run.peak_bytes = peak_memory_bytes();
  }
  run.rasterize_s = median(rasterize_s);
  run.sweep_s = median(sweep_s);
  return run;
}

std::string quoted(const std::string& text) {
  if (text.find('\'') != std::string::npos) throw std::invalid_argument(text + ": has a quote");
  return "'" + text + "'";
}

struct ScalingRow {
  std::size_t threads;
  FieldRun run;
  double rasterize_ns, sweep_ns;
  double to_1e7 = 1;  // both together, in parts of the cost at 1e7 voxels
};

ScalingRow scaling_row(double voxels, std::size_t threads, int repeats) {
  constexpr double kPi = 3.14159265358979;
  const double outer = std::pow(1 + kBandPart, 3);
  const double inner = std::pow(1 - kBandPart, 3);
  const double radius = std::round(std::cbrt(voxels * 3 / (4 * kPi * (outer - inner))));
  const FieldRun run =
      run_apart({fmt::format("sphere-{:.0f}", radius), kBandPart * radius, threads, repeats, ""});
  const auto active = static_cast<double>(run.active_voxels);
  return {threads, run, run.rasterize_s * 1e9 / active, run.sweep_s * 1e9 / active};
}

void print(const ScalingRow& row) {
  const auto peak = static_cast<double>(row.run.peak_bytes);
  fmt::print("{:2} {:>10} {:9.2f} {:9.2f} {:9.2f} {:8.3f} {:>12} {:6.2f}\n", row.threads,
             row.run.active_voxels, row.rasterize_ns, row.sweep_ns, row.rasterize_ns + row.sweep_ns,
             row.to_1e7, row.run.peak_bytes, peak / static_cast<double>(row.run.tree_bytes));
  std::fflush(stdout);
}

std::string json(const ScalingRow& row) {
  return fmt::format(
      R"({{"name": "scaling", "threads": {}, "active_voxels": {}, "rasterize_ns": {:.3f}, )"
      R"("sweep_ns": {:.3f}, "cost_to_1e7": {:.4f}, "tree_bytes": {}, "peak_bytes": {}}})",
      row.threads, row.run.active_voxels, row.rasterize_ns, row.sweep_ns, row.to_1e7,
      row.run.tree_bytes, row.run.peak_bytes);
}

}  // namespace

FieldRun run_apart(const FieldRunSetting& setting) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command =
      fmt::format("{} --apart {} {} {} {} {}", quoted(self), quoted(setting.input), setting.band,
                  setting.threads, setting.repeats, quoted(setting.bwb));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"),
                                                             ::pclose);
  if (!pipe) throw std::runtime_error("cannot start " + command);
  std::string said;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) {
    said += static_cast<char>(c);
  }
  FieldRun run;
  std::istringstream words(said);
  words >> run.active_voxels >> run.tree_bytes >> run.peak_bytes >> run.rasterize_s >> run.sweep_s;
  if (!words) throw std::runtime_error("no answer from " + command);
  return run;
}

int answer_run_apart(const std::vector<std::string>& arguments) {
  const FieldRun run =
      run_here({arguments.at(0), std::stod(arguments.at(1)), std::stoul(arguments.at(2)),
                std::stoi(arguments.at(3)), arguments.at(4)});
  fmt::print("{} {} {} {:.9f} {:.9f}\n", run.active_voxels, run.tree_bytes, run.peak_bytes,
             run.rasterize_s, run.sweep_s);
  return 0;
}

std::vector<std::string> scaling(const std::vector<std::size_t>& threads, int repeats) {
  fmt::print("ns a voxel\n{:>2} {:>10} {:>9} {:>9} {:>9} {:>8} {:>12} {:>6}\n", "th", "voxels",
             "rasterize", "sweep", "both", "to 1e7", "peak, bytes", "/tree");
  std::vector<std::string> objects;
  for (const std::size_t count : threads) {
    // 1e7 first: the others are told in its parts.
    ScalingRow unit = scaling_row(1e7, count, repeats);
    for (const double voxels : {1e6, 3e6, 1e7, 3e7, 1e8, 2e8}) {
      ScalingRow row = voxels == 1e7 ? unit : scaling_row(voxels, count, repeats);
      row.to_1e7 = (row.rasterize_ns + row.sweep_ns) / (unit.rasterize_ns + unit.sweep_ns);
      print(row);
      objects.push_back(json(row));
    }
  }
  return objects;
}

}  // namespace vdb_offset::bench
