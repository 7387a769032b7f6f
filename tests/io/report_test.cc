#include "vdb_offset/io/report.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/hand_made.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/version.h"

using namespace vdb_offset;
using nlohmann::json;

namespace {

struct Parts {
  Surface surface;
  BandPlan plan;
  DistanceField field;

  ReportParts field_only() const { return {&surface, &plan, &field, nullptr, nullptr}; }
};

}  // namespace

TEST_CASE("report: what is not a finite number becomes null, and the JSON stays valid") {
  Parts parts;
  parts.field.report.last_change_voxels = std::numeric_limits<double>::quiet_NaN();
  parts.field.voxel_world = std::numeric_limits<double>::infinity();
  const json report = json::parse(report_json(parts.field_only(), {}));
  CHECK(report["field"]["last_change_voxels"].is_null());
  CHECK(report["field"]["voxel_size"].is_null());
}

TEST_CASE("report: options are echoed with their types and in their order") {
  RunInfo run;
  run.command = "field";
  run.options = {{"weld", 0.01},
                 {"layers", std::int64_t{48}},
                 {"growth", OptionValue{}},
                 {"quiet", true},
                 {"output", std::vector<std::string>{"a.vtm", "b.xyz"}}};
  run.seconds = {{"surface", 0.5}, {"total", 1.5}};
  run.threads = 2;
  const std::string text = report_json(Parts{}.field_only(), run);
  const json report = json::parse(text);
  CHECK(report["options"]["weld"] == 0.01);
  CHECK(report["options"]["layers"] == 48);
  CHECK(report["options"]["growth"].is_null());
  CHECK(report["options"]["quiet"] == true);
  CHECK(report["options"]["output"] == json({"a.vtm", "b.xyz"}));
  CHECK(text.find("\"weld\"") < text.find("\"layers\""));
  CHECK(report["time"]["total"] == 1.5);
  CHECK(report["run"]["threads"] == 2);
  CHECK(report["run"]["version"] == kVersion);
}

TEST_CASE("report: a field alone has no blocks, march or quality") {
  const json report = json::parse(report_json(Parts{}.field_only(), {}));
  CHECK(report.contains("field"));
  for (const char* key : {"march", "blocks", "quality", "coverage"}) CHECK(!report.contains(key));
}

TEST_CASE("report: flipped patches are named, families listed once") {
  Parts parts;
  for (const char* name : {"nose", "body", "tail"}) {
    parts.surface.patches.push_back({.name = name,
                                     .family = std::string(name) == "nose" ? "front" : "rest",
                                     .ni = 0,
                                     .nj = 0,
                                     .points_world = {}});
  }
  parts.surface.report.flipped = {2};
  parts.plan.rule = VoxelRule::Memory;
  const json report = json::parse(report_json(parts.field_only(), {}));
  CHECK(report["surface"]["flipped"] == json({"tail"}));
  CHECK(report["surface"]["families"] == json({"front", "rest"}));
  CHECK(report["field"]["voxel_rule"] == "memory");
}

TEST_CASE("report: the quality has a row for each layer of cells and for each patch") {
  MultiBlock mesh = test::wavy_plate(5, 4, 3);
  mesh.blocks[0].family = "metal";
  const QualityField quality = judge(mesh);
  Parts parts;
  const json report = json::parse(
      report_json({&parts.surface, &parts.plan, &parts.field, &mesh, &quality}, {}))["quality"];
  REQUIRE(report["levels"].size() == 3);
  REQUIRE(report["patches"].size() == 1);
  CHECK(report["patches"][0]["patch"] == "plate");
  CHECK(report["patches"][0]["family"] == "metal");
  const auto check_row = [](const json& row, const QualityMinima& minima) {
    CHECK(row["cells"] == minima.cells);
    CHECK(row["nonpositive_cells"] == minima.nonpositive_cells);
    CHECK(row["min_scaled_jacobian"] == minima.min_scaled_jacobian);
    CHECK(row["min_jacobian"] == minima.min_jacobian);
    CHECK(row["min_volume"] == minima.min_volume);
    CHECK(row["max_skewness"] == minima.max_skewness);
    CHECK(row["max_aspect_ratio"] == minima.max_aspect_ratio);
    CHECK(row["min_orthogonality"] == minima.min_orthogonality);
    CHECK(row["max_growth"] == minima.growth_max);
    CHECK(row["max_side_growth"] == minima.side_growth_max);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(report["levels"][k]["level"] == k + 1);
    check_row(report["levels"][k], quality.report.levels[k]);
  }
  check_row(report["patches"][0], quality.report.patches[0]);
  CHECK(report["max_skewness"] == quality.report.max_skewness);
  CHECK(report["max_aspect_ratio"] == quality.report.max_aspect_ratio);
  CHECK(report["min_orthogonality"] == quality.report.min_orthogonality);
  CHECK(report["growth"]["max"] == quality.report.growth_max);
  CHECK(report["growth"]["side_max"] == quality.report.side_growth_max);
}

TEST_CASE("report: each name of boundary faces has its condition") {
  const MultiBlock mesh = test::wavy_plate(5, 4, 3);
  const QualityField quality = judge(mesh);
  Parts parts;
  const json report =
      json::parse(report_json({&parts.surface, &parts.plan, &parts.field, &mesh, &quality}, {}));
  CHECK(report["blocks"]["conditions"] ==
        json({{"wall", "wall"}, {"outer", "farfield"}, {"free", "unspecified"}}));
}

TEST_CASE("report: a name that is not UTF-8 does not lose the report") {
  RunInfo run;
  run.outputs = {"caf\xe9.vtm"};
  CHECK_NOTHROW(json::parse(report_json(Parts{}.field_only(), run)));
}

TEST_CASE("report: it is written whole, and refused by name where it cannot be") {
  const auto file = std::filesystem::temp_directory_path() / "vdb_offset_report_test.json";
  write_report(file, "{}\n");
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  CHECK(text.str() == "{}\n");
  std::filesystem::remove(file);
  CHECK_THROWS_AS(write_report(file.parent_path() / "no-such-folder" / "r.json", "{}"), IoError);
}

TEST_CASE("report: the peak memory covers what has been touched") {
  const std::vector<char> block(64 << 20, 1);
  CHECK(peak_memory_bytes() >= block.size());
}
