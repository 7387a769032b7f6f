#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "vdb_offset/blocks/check_crossings.h"
#include "vdb_offset/blocks/check_sides.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/blocks/repair.h"
#include "vdb_offset/rasterize/rasterize.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// What a report is made from; `mesh` and `quality` are null for a field alone.
struct ReportParts {
  const Surface* surface = nullptr;
  const BandPlan* plan = nullptr;
  const DistanceField* field = nullptr;
  const MultiBlock* mesh = nullptr;
  const QualityField* quality = nullptr;
  const RepairReport* repair = nullptr;
  const SidesReport* sides = nullptr;
  const CrossingsReport* crossings = nullptr;
};

/// An option as given, in the units of the command line; monostate: chosen by the program.
using OptionValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::string>>;

/// Facts of a run that no stage knows.
struct RunInfo {
  std::string command;  ///< "mesh" or "field"
  std::vector<std::string> outputs;
  std::vector<std::pair<std::string, OptionValue>> options;  ///< all, defaults included, in order
  std::vector<std::pair<std::string, double>> seconds;       ///< by stage, in order
  int threads = 0;
};

/// "given", "distance", "surface-edge" or "memory".
std::string_view voxel_rule_name(VoxelRule rule);

/// Whether the last round's change is no change of a distance, but a voxel that had none before.
bool reached_new_voxels(const SweepReport& sweep);

/// The most memory that this process has held so far, in bytes.
std::uint64_t peak_memory_bytes();

/// A run as JSON: surface, field, spacing, march, coverage, blocks, repair, quality, options, time,
/// run. Lengths in world units; a number that is not finite becomes null.
std::string report_json(const ReportParts& parts, const RunInfo& run);

/// Write it by temporary file and rename. Throws IoError.
void write_report(const std::filesystem::path& file, const std::string& json);

}  // namespace vdb_offset
