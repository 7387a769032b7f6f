#include "bench/field_run.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <sched.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

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

/// Those that this process may run on.
std::vector<int> own_processors() {
  cpu_set_t set;
  std::vector<int> numbers;
  if (::sched_getaffinity(0, sizeof set, &set) != 0) {
    throw std::runtime_error("the system does not tell which processors there are");
  }
  for (int n = 0; n < CPU_SETSIZE; ++n) {
    if (CPU_ISSET(n, &set)) numbers.push_back(n);
  }
  return numbers;
}

void stay_on(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(processor, &set);
  if (::sched_setaffinity(0, sizeof set, &set) != 0) {
    throw std::runtime_error(fmt::format("processor {} cannot be had", processor));
  }
}

FieldRun run_here(const FieldRunSetting& setting) {
  if (setting.processor >= 0) stay_on(setting.processor);
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
  std::size_t threads = 1;
  FieldRun run;
  double rasterize_ns = 0, sweep_ns = 0;
  double to_1e7 = 1;    // both together, in parts of the cost at 1e7 voxels
  double speed_up = 1;  // of the sweep, against the run of the first number of threads before it
  double copies = 1;    // what as many runs of one thread at once do in the time of one
};

std::vector<double> ratios(const std::vector<double>& over, const std::vector<double>& under) {
  std::vector<double> ratios(over.size());
  std::transform(over.begin(), over.end(), under.begin(), ratios.begin(), std::divides<>());
  return ratios;
}

/// The times of one, at the mean of the speeds.
FieldRun at_mean_speed(const std::vector<FieldRun>& runs) {
  FieldRun mean = runs.front();
  double rasterize_speed = 0;
  double sweep_speed = 0;
  for (const FieldRun& run : runs) {
    mean.peak_bytes = std::max(mean.peak_bytes, run.peak_bytes);
    rasterize_speed += 1 / run.rasterize_s;
    sweep_speed += 1 / run.sweep_s;
  }
  mean.rasterize_s = static_cast<double>(runs.size()) / rasterize_speed;
  mean.sweep_s = static_cast<double>(runs.size()) / sweep_speed;
  return mean;
}

/// One thread, on one processor after the other: two of a machine's processors can differ by a
/// quarter in speed for hours, and two threads have both.
std::vector<FieldRun> one_by_one(FieldRunSetting setting, const std::vector<int>& processors) {
  std::vector<FieldRun> runs;
  for (const int processor : processors) {
    setting.processor = processor;
    runs.push_back(run_apart(setting));
  }
  return runs;
}

/// What the machine itself allows: as many runs of one thread as there are threads, at once, share
/// nothing but its memory. Sweeps in the time of one.
double gain_of_copies(FieldRunSetting setting, const std::vector<int>& processors,
                      const std::vector<FieldRun>& alone) {
  std::vector<std::future<FieldRun>> copies;
  setting.threads = 1;
  for (const int processor : processors) {
    setting.processor = processor;
    copies.push_back(std::async(std::launch::async, run_apart, setting));
  }
  double gain = 0;
  for (std::size_t n = 0; n < copies.size(); ++n) {
    gain += alone[n].sweep_s / copies[n].get().sweep_s;
  }
  return gain;
}

/// A row for each number of threads, by turns, every other time the other way round. Speeds of this
/// kind of machine drift by half within minutes, so that gains are medians of ratios of
/// neighbouring runs, not ratios of medians. One thread is told at the mean of the speeds that it
/// has on the processors that the largest number of threads takes.
std::vector<ScalingRow> scaling_rows(double voxels, const std::vector<std::size_t>& threads,
                                     int repeats) {
  constexpr double kPi = 3.14159265358979;
  const double outer = std::pow(1 + kBandPart, 3);
  const double inner = std::pow(1 - kBandPart, 3);
  const double radius = std::round(std::cbrt(voxels * 3 / (4 * kPi * (outer - inner))));
  const std::size_t most = *std::max_element(threads.begin(), threads.end());
  std::vector<int> processors = own_processors();
  processors.resize(std::min(processors.size(), most));
  struct Times {
    std::vector<double> rasterize_s, sweep_s, copies;
  };
  std::vector<ScalingRow> rows(threads.size());
  std::vector<Times> times(threads.size());
  // A process's first runs pay for memory that the system gives it, the more the shorter they are.
  const int runs = voxels > 1e7 ? 3 : 9;
  FieldRunSetting setting{
      fmt::format("sphere-{:.0f}", radius), kBandPart * radius, 1, runs, "", -1};
  for (int n = 0; n < repeats; ++n) {
    std::vector<FieldRun> alone;
    for (std::size_t turn = 0; turn < threads.size(); ++turn) {
      const std::size_t t = n % 2 == 0 ? turn : threads.size() - 1 - turn;
      rows[t].threads = setting.threads = threads[t];
      if (threads[t] == 1) {
        alone = one_by_one(setting, processors);
        rows[t].run = at_mean_speed(alone);
      } else {
        rows[t].run = run_apart(setting);
      }
      times[t].rasterize_s.push_back(rows[t].run.rasterize_s);
      times[t].sweep_s.push_back(rows[t].run.sweep_s);
    }
    for (std::size_t t = 0; t < threads.size(); ++t) {
      const bool told = threads[t] == processors.size() && !alone.empty();
      times[t].copies.push_back(told ? gain_of_copies(setting, processors, alone) : 1);
    }
  }
  for (std::size_t t = 0; t < threads.size(); ++t) {
    const double scale = 1e9 / static_cast<double>(rows[t].run.active_voxels);
    rows[t].rasterize_ns = scale * median(times[t].rasterize_s);
    rows[t].sweep_ns = scale * median(times[t].sweep_s);
    rows[t].speed_up = median(ratios(times[0].sweep_s, times[t].sweep_s));
    rows[t].copies = median(times[t].copies);
  }
  return rows;
}

void print(const ScalingRow& row) {
  const auto peak = static_cast<double>(row.run.peak_bytes);
  fmt::print("{:2} {:>10} {:9.2f} {:9.2f} {:9.2f} {:8.3f} {:8.2f} {:8.2f} {:>12} {:6.2f}\n",
             row.threads, row.run.active_voxels, row.rasterize_ns, row.sweep_ns,
             row.rasterize_ns + row.sweep_ns, row.to_1e7, row.speed_up, row.copies,
             row.run.peak_bytes, peak / static_cast<double>(row.run.tree_bytes));
  std::fflush(stdout);
}

std::string json(const ScalingRow& row) {
  return fmt::format(
      R"({{"name": "scaling", "threads": {}, "active_voxels": {}, "rasterize_ns": {:.3f}, )"
      R"("sweep_ns": {:.3f}, "cost_to_1e7": {:.4f}, "sweep_speed_up": {:.3f}, )"
      R"("copies_speed_up": {:.3f}, "tree_bytes": {}, "peak_bytes": {}}})",
      row.threads, row.run.active_voxels, row.rasterize_ns, row.sweep_ns, row.to_1e7, row.speed_up,
      row.copies, row.run.tree_bytes, row.run.peak_bytes);
}

}  // namespace

FieldRun run_apart(const FieldRunSetting& setting) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command =
      fmt::format("{} --apart {} {} {} {} {} {}", quoted(self), quoted(setting.input), setting.band,
                  setting.threads, setting.repeats, quoted(setting.bwb), setting.processor);
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
                std::stoi(arguments.at(3)), arguments.at(4), std::stoi(arguments.at(5))});
  fmt::print("{} {} {} {:.9f} {:.9f}\n", run.active_voxels, run.tree_bytes, run.peak_bytes,
             run.rasterize_s, run.sweep_s);
  return 0;
}

std::vector<std::string> scaling(const std::vector<std::size_t>& threads, int repeats) {
  fmt::print(
      "ns a voxel; speed-up of the sweep by threads, and what as many runs of one thread do at "
      "once\n"
      "{:>2} {:>10} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>12} {:>6}\n",
      "th", "voxels", "rasterize", "sweep", "both", "to 1e7", "speed-up", "copies", "peak, bytes",
      "/tree");
  std::vector<std::string> objects;
  // 1e7 first, and more often: the others are told in its parts.
  const std::vector<ScalingRow> unit = scaling_rows(1e7, threads, 3 * repeats);
  for (const double voxels : {1e6, 3e6, 1e7, 3e7, 1e8, 2e8}) {
    std::vector<ScalingRow> rows = voxels == 1e7 ? unit : scaling_rows(voxels, threads, repeats);
    for (std::size_t t = 0; t < rows.size(); ++t) {
      rows[t].to_1e7 =
          (rows[t].rasterize_ns + rows[t].sweep_ns) / (unit[t].rasterize_ns + unit[t].sweep_ns);
      print(rows[t]);
      objects.push_back(json(rows[t]));
    }
  }
  return objects;
}

}  // namespace vdb_offset::bench
