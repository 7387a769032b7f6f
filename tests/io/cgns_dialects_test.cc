// Files as other programs write them, made with the library itself.

#include <cgnslib.h>
#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include "io/cgns_round.h"
#include "support/face_ranges.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset::test {
namespace {

/// Every call has to succeed.
void ok(int code) {
  if (code != CG_OK) FAIL(cg_get_error());
}

/// A file that is open to be written, with one base.
class Foreign {
 public:
  Foreign(const std::filesystem::path& file, int cells, int space) {
    ok(cg_set_file_type(CG_FILE_HDF5));
    ok(cg_open(file.c_str(), CG_MODE_WRITE, &file_));
    ok(cg_base_write(file_, "Base", cells, space, &base_));
  }
  ~Foreign() { cg_close(file_); }
  Foreign(const Foreign&) = delete;
  Foreign& operator=(const Foreign&) = delete;

  /// Points x = i, y = j, z = k of 4 x 3 x 2, doubles.
  int zone(const char* name) {
    const std::array<cgsize_t, 9> size{4, 3, 2, 3, 2, 1, 0, 0, 0};
    int zone = 0;
    ok(cg_zone_write(file_, base_, name, size.data(), CGNS_ENUMV(Structured), &zone));
    constexpr std::array<const char*, 3> kNames{"CoordinateX", "CoordinateY", "CoordinateZ"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (int n = 0; n < 24; ++n) {
        const std::array<int, 3> at{n % 4, n / 4 % 3, n / 12};
        values.push_back(at[axis]);
      }
      int index = 0;
      ok(cg_coord_write(file_, base_, zone, CGNS_ENUMV(RealDouble), kNames[axis], values.data(),
                        &index));
    }
    return zone;
  }

  using Range = std::array<cgsize_t, 6>;
  int boundary(int zone, const char* name, BCType_t type, const Range& range) {
    int index = 0;
    ok(cg_boco_write(file_, base_, zone, name, type, CGNS_ENUMV(PointRange), 2, range.data(),
                     &index));
    return index;
  }
  void family(const char* name, BCType_t type) {
    int family = 0;
    int index = 0;
    ok(cg_family_write(file_, base_, name, &family));
    ok(cg_fambc_write(file_, base_, family, "FamBC", type, &index));
  }
  void go_to_boundary(int zone, int index) {
    ok(cg_goto(file_, base_, "Zone_t", zone, "ZoneBC_t", 1, "BC_t", index, "end"));
  }
  int file() const { return file_; }
  int base() const { return base_; }

 private:
  int file_ = 0;
  int base_ = 0;
};

TEST_CASE("cgns: plane surfaces in single precision, with points around them, are read") {
  const TempFolder folder;
  {
    Foreign out(folder / "plane.cgns", 2, 2);
    const std::array<cgsize_t, 6> size{3, 2, 2, 1, 0, 0};
    int zone = 0;
    ok(cg_zone_write(out.file(), out.base(), "plane", size.data(), CGNS_ENUMV(Structured), &zone));
    int grid = 0;
    ok(cg_grid_write(out.file(), out.base(), zone, "GridCoordinates", &grid));
    ok(cg_goto(out.file(), out.base(), "Zone_t", zone, "GridCoordinates_t", 1, "end"));
    constexpr std::array<int, 4> kRind{1, 0, 0, 2};
    ok(cg_rind_write(kRind.data()));
    const std::array<cgsize_t, 2> points{4, 4};
    std::vector<float> x;
    std::vector<float> y;
    for (int n = 0; n < 16; ++n) {
      x.push_back(static_cast<float>(n % 4) + 0.5F);
      y.push_back(static_cast<float>(n / 4));
    }
    ok(cg_array_write("CoordinateX", CGNS_ENUMV(RealSingle), 2, points.data(), x.data()));
    ok(cg_array_write("CoordinateY", CGNS_ENUMV(RealSingle), 2, points.data(), y.data()));
  }
  const Patches patches = read_cgns(folder / "plane.cgns");
  REQUIRE(patches.size() == 1);
  CHECK(patches[0].points_world ==
        Vec3List{{1.5, 0, 0}, {2.5, 0, 0}, {3.5, 0, 0}, {1.5, 1, 0}, {2.5, 1, 0}, {3.5, 1, 0}});
}

TEST_CASE("cgns: a family makes a wall of a boundary, wherever that lies") {
  const TempFolder folder;
  const auto file = folder / "mesh.cgns";
  SUBCASE("as a range of points") {
    Foreign out(file, 3, 3);
    const int zone = out.zone("zone");
    out.family("skin", CGNS_ENUMV(BCWallInviscid));
    out.go_to_boundary(zone,
                       out.boundary(zone, "b", CGNS_ENUMV(FamilySpecified), {4, 1, 1, 4, 3, 2}));
    ok(cg_famname_write("skin"));
  }
  SUBCASE("as a range of faces") {
    Foreign out(file, 3, 3);
    const int zone = out.zone("zone");
    out.family("skin", CGNS_ENUMV(BCWallInviscid));
    out.go_to_boundary(zone,
                       out.boundary(zone, "b", CGNS_ENUMV(FamilySpecified), {4, 1, 1, 4, 2, 1}));
    ok(cg_gridlocation_write(CGNS_ENUMV(IFaceCenter)));
    ok(cg_famname_write("Base/skin"));
  }
  SUBCASE("as a list of points") {
    Foreign out(file, 3, 3);
    const int zone = out.zone("zone");
    out.family("skin", CGNS_ENUMV(BCWallInviscid));
    std::vector<cgsize_t> list;
    for (int k = 1; k <= 2; ++k) {
      for (int j = 1; j <= 3; ++j) list.insert(list.end(), {4, j, k});
    }
    int index = 0;
    ok(cg_boco_write(out.file(), out.base(), zone, "b", CGNS_ENUMV(FamilySpecified),
                     CGNS_ENUMV(PointList), 6, list.data(), &index));
    out.go_to_boundary(zone, index);
    ok(cg_famname_write("skin"));
  }
  const Patches patches = read_cgns(file);
  REQUIRE(patches.size() == 1);
  CHECK(patches[0].family == "skin");
  CHECK(patches[0].points_world.size() == 6);
  for (const Vec3& p : patches[0].points_world) CHECK(p.x() == 3);
  const ZoneMesh mesh = read_cgns_mesh(file);
  CHECK(mesh.faults.empty());
  REQUIRE(mesh.boundary_faces.size() == 1);
  CHECK(mesh.boundary_faces[0].range.face == BlockFace::IMax);
  CHECK(mesh.boundary_faces[0].range.end == Index3{3, 2, 1});
  CHECK(mesh.boundary_faces[0].condition.kind == ConditionKind::InviscidWall);
}

TEST_CASE("cgns: overset and periodic connectivity are boundaries, what is not read is a fault") {
  const TempFolder folder;
  const auto file = folder / "mesh.cgns";
  {
    Foreign out(file, 3, 3);
    const int zone = out.zone("zone");
    int index = 0;
    const Foreign::Range top{1, 1, 2, 4, 3, 2};
    const Foreign::Range low{1, 1, 1, 4, 3, 1};
    ok(cg_conn_write(out.file(), out.base(), zone, "hole", CGNS_ENUMV(Vertex), CGNS_ENUMV(Overset),
                     CGNS_ENUMV(PointRange), 2, top.data(), "zone", CGNS_ENUMV(Structured),
                     CGNS_ENUMV(PointListDonor), CGNS_ENUMV(Integer), 0, nullptr, &index));
    ok(cg_conn_write(out.file(), out.base(), zone, "patched", CGNS_ENUMV(Vertex),
                     CGNS_ENUMV(Abutting), CGNS_ENUMV(PointRange), 2, low.data(), "zone",
                     CGNS_ENUMV(Structured), CGNS_ENUMV(PointListDonor), CGNS_ENUMV(Integer), 0,
                     nullptr, &index));
    const Foreign::Range first{1, 1, 1, 1, 3, 2};
    const Foreign::Range second{4, 1, 1, 4, 3, 2};
    constexpr std::array<int, 3> kSame{1, 2, 3};
    ok(cg_1to1_write(out.file(), out.base(), zone, "round", "zone", first.data(), second.data(),
                     kSame.data(), &index));
    constexpr std::array<float, 3> kNone{0, 0, 0};
    constexpr std::array<float, 3> kAcross{3, 0, 0};
    ok(cg_1to1_periodic_write(out.file(), out.base(), zone, index, kNone.data(), kNone.data(),
                              kAcross.data()));
    out.boundary(zone, "line", CGNS_ENUMV(BCDegenerateLine), {1, 1, 1, 4, 1, 1});
    out.boundary(zone, "inside", CGNS_ENUMV(BCInflow), {2, 1, 1, 2, 3, 2});
    out.boundary(zone, "in", CGNS_ENUMV(BCInflowSubsonic), {1, 1, 1, 4, 1, 2});
  }
  const ZoneMesh mesh = read_cgns_mesh(file);
  const auto is_named = [&](const char* name, ConditionKind kind, BlockFace face) {
    return std::ranges::count_if(mesh.boundary_faces, [&](const BoundaryFace& one) {
             return one.name == name && one.condition.kind == kind && one.range.face == face;
           }) == 1;
  };
  CHECK(mesh.boundary_faces.size() == 3);
  CHECK(is_named("hole", ConditionKind::Overset, BlockFace::KMax));
  CHECK(is_named("round", ConditionKind::Other, BlockFace::IMin));
  CHECK(is_named("in", ConditionKind::Inflow, BlockFace::JMin));
  CHECK(mesh.interfaces.empty());
  CHECK(mesh.faults.size() == 4);  // patched, round, line, inside
  for (const char* part : {"'patched' is connectivity of type Abutting", "'round' is periodic",
                           "'line' covers no part of a face", "'inside' covers no part"}) {
    CAPTURE(part);
    CHECK(std::ranges::count_if(mesh.faults, [&](const std::string& fault) {
            return fault.find(part) != std::string::npos;
          }) == 1);
  }
}

TEST_CASE("cgns: zones that are not structured, or no zones, are refused by name") {
  const TempFolder folder;
  {
    Foreign out(folder / "tets.cgns", 3, 3);
    const std::array<cgsize_t, 3> size{4, 1, 0};
    int zone = 0;
    ok(cg_zone_write(out.file(), out.base(), "tets", size.data(), CGNS_ENUMV(Unstructured), &zone));
    const Foreign empty(folder / "empty.cgns", 3, 3);
  }
  CHECK_THROWS_WITH_AS(read_cgns(folder / "tets.cgns"),
                       doctest::Contains("Base/tets: is unstructured"), IoError);
  CHECK_THROWS_WITH_AS(read_cgns(folder / "empty.cgns"), doctest::Contains("no zones"), IoError);
}

TEST_CASE("cgns: units are found at the base or at the coordinates") {
  const TempFolder folder;
  for (const bool at_base : {true, false}) {
    const auto file = folder / "units.cgns";
    {
      Foreign out(file, 3, 3);
      const int zone = out.zone("zone");
      ok(at_base ? cg_goto(out.file(), out.base(), "end")
                 : cg_goto(out.file(), out.base(), "Zone_t", zone, "GridCoordinates_t", 1,
                           "CoordinateX", 0, "end"));
      ok(cg_units_write(CGNS_ENUMV(MassUnitsNull), CGNS_ENUMV(Inch), CGNS_ENUMV(TimeUnitsNull),
                        CGNS_ENUMV(TemperatureUnitsNull), CGNS_ENUMV(AngleUnitsNull)));
    }
    CHECK(inspect_cgns(file).length_unit == "Inch");
    CHECK(read_cgns_mesh(file).length_unit == "Inch");
  }
}

}  // namespace
}  // namespace vdb_offset::test
