#include "io/openfoam_case.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "vdb_offset/core/error.h"
#include "vdb_offset/io/output.h"

namespace vdb_offset {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kSystemFiles{
    {{"controlDict",
      "startFrom       latestTime;\nstartTime       0;\nstopAt          endTime;\n"
      "endTime         1000;\ndeltaT          1;\nwriteControl    timeStep;\n"
      "writeInterval   1000;\n"},
     {"fvSchemes",
      "ddtSchemes {}\ngradSchemes {}\ndivSchemes {}\nlaplacianSchemes {}\n"
      "interpolationSchemes {}\nsnGradSchemes {}\n"},
     {"fvSolution", "solvers {}\n"}}};

/// Sets that checkMesh writes, of cells, faces and points that it finds fault with, and of the
/// cells of regions that do not hang together.
constexpr std::array<const char*, 30> kSets{"concaveCells",
                                            "concaveFaces",
                                            "duplicateFaces",
                                            "edgeFaces",
                                            "highAspectRatioCells",
                                            "interpolationFaces",
                                            "lowQualityTetFaces",
                                            "lowVolRatioCells",
                                            "lowVolRatioFaces",
                                            "lowWeightFaces",
                                            "multiRegionPoints",
                                            "nearPoints",
                                            "negativeVolumeCells",
                                            "nonAlignedEdges",
                                            "nonClosedCells",
                                            "nonManifoldPoints",
                                            "nonOrthoFaces",
                                            "oneInternalFaceCells",
                                            "outOfRangeFaces",
                                            "region#",
                                            "shortEdges",
                                            "skewFaces",
                                            "twoInternalFacesCells",
                                            "underdeterminedCells",
                                            "unusedPoints",
                                            "upperTriangularFace",
                                            "warpedFaces",
                                            "wrongOrientedFaces",
                                            "zeroAreaFaces",
                                            "zeroVolumeCells"};

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

void check_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw IoError(folder.string() +
                  ": is no folder, but a case of OpenFOAM is one; move it or "
                  "choose another name");
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw IoError("the folder '" + folder.string() + "' may not be written");
  }
}

}  // namespace

OpenfoamCase::OpenfoamCase(const fs::path& file) {
  if (file.extension() == ".foam") {
    marker = file;
    folder = file.parent_path();
  } else {
    folder = file.has_filename() ? file : file.parent_path();  // "case/" is "case"
  }
  if (folder.empty()) folder = ".";
}

Pieces OpenfoamCase::poly_mesh() const {
  return {.folder = folder / "constant" / "polyMesh",
          .names = {"points", "faces", "owner", "neighbour", "boundary"},
          .leftovers = "sets",
          .leftover_names = {kSets.begin(), kSets.end()}};
}

void OpenfoamCase::check() const {
  if (!is_there(folder)) {
    output_place(folder);  // its own folder is there, and may be written
    return;
  }
  check_folder(folder);
  for (const char* part : {"constant", "system"}) {
    if (is_there(folder / part)) check_folder(folder / part);
  }
  poly_mesh().check_ours();
  if (!marker.empty()) output_place(marker);
}

void OpenfoamCase::write_rest() const {
  for (const auto& [name, text] : kSystemFiles) {
    const fs::path file = folder / "system" / name;
    if (is_there(file)) continue;
    OutputFile out(file);
    out.stream() << openfoam_header("dictionary", "system", std::string(name)) << text;
    out.commit();
  }
  if (!marker.empty()) OutputFile(marker).commit();
}

std::string openfoam_header(const std::string& kind, const std::string& location,
                            const std::string& object) {
  return fmt::format(
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n"
      "    location    \"{}\";\n    object      {};\n}}\n\n",
      kind, location, object);
}

NewFolders::~NewFolders() {
  std::error_code ignored;
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) {
    fs::remove(*folder, ignored);  // only if it is empty
  }
}

void NewFolders::make(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return;
  if (!fs::create_directory(folder, error)) {
    throw IoError(folder.string() + ": cannot be created: " + error.message());
  }
  made_.push_back(folder);
}

}  // namespace vdb_offset
