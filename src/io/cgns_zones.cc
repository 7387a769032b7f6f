#include "io/cgns_zones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

constexpr std::array<const char*, 3> kCoordinates{"CoordinateX", "CoordinateY", "CoordinateZ"};

/// "Meter" of a node that has DimensionalUnits_t: five words of 32 letters, the second is length.
std::string length_unit_of(const CgnsNode& node) {
  constexpr std::size_t kWord = 32;
  const auto units = node.child("DimensionalUnits_t");
  if (!units) return {};
  const std::string words = units->text();
  if (words.size() <= kWord) return {};
  const std::string word = words.substr(kWord, kWord);
  const std::string unit = word.substr(0, word.find_last_not_of(' ') + 1);
  return unit == "Null" || unit == "UserDefined" || unit == "LengthUnitsNull" ? "" : unit;
}

std::optional<CgnsNode> grid_of(const CgnsNode& zone) {
  auto grid = zone.child("GridCoordinates_t", "GridCoordinates");
  return grid ? grid : zone.child("GridCoordinates_t");
}

/// Units stand at the base, or at a zone, its grid or its coordinates.
std::string find_unit(const CgnsNode& base, const CgnsNode& zone) {
  for (const CgnsNode& node : {base, zone}) {
    if (const std::string unit = length_unit_of(node); !unit.empty()) return unit;
  }
  const auto grid = grid_of(zone);
  if (!grid) return {};
  if (const std::string unit = length_unit_of(*grid); !unit.empty()) return unit;
  const auto x = grid->child("DataArray_t", kCoordinates[0]);
  return x ? length_unit_of(*x) : "";
}

CgnsZone read_zone(const CgnsNode& node) {
  CgnsZone zone{node, node.name(), family_of(node)};
  const auto type = node.child("ZoneType_t");
  const std::string word = type ? type->text() : "Structured";
  zone.is_structured = word == "Structured";
  if (!zone.is_structured && word != "Unstructured") {
    node.refuse("is of type " + word + "; only structured and unstructured zones are read");
  }
  const std::vector<std::int64_t> sizes = node.integers();
  zone.dimension = sizes.size() / 3;
  if (sizes.size() % 3 != 0 || zone.dimension < 1 || zone.dimension > 3 ||
      (!zone.is_structured && zone.dimension != 1)) {
    node.refuse(fmt::format(
        "has {} sizes; {}", sizes.size(),
        zone.is_structured ? "structured zones have 6 or 9" : "unstructured zones have 3"));
  }
  if (!zone.is_structured) zone.cells = sizes[1];
  for (std::size_t a = 0; a < zone.dimension; ++a) {
    if (sizes[a] < 1 || sizes[a] > std::numeric_limits<int>::max() - 1) {
      node.refuse(fmt::format("has {} points along {}", sizes[a], "ijk"[a]));
    }
    zone.size[a] = static_cast<int>(sizes[a]);
  }
  return zone;
}

CgnsFamily read_family(const CgnsNode& node) {
  CgnsFamily family{node.name(), {}};
  const auto condition = node.child("FamilyBC_t");
  if (condition) family.type = condition->text();
  family.is_overset = node.child("UserDefinedData_t", "BCOverset").has_value() ||
                      (condition && condition->child("UserDefinedData_t", "BCOverset"));
  return family;
}

/// Points outside of the grid, in front of and behind each direction.
std::array<int, 6> rind_of(const CgnsNode& grid, std::size_t dimension) {
  std::array<int, 6> rind{};
  const auto node = grid.child("Rind_t");
  if (!node) return rind;
  const std::vector<std::int64_t> values = node->integers();
  constexpr std::int64_t kMost = 1000;
  const bool fits = values.size() == 2 * dimension &&
                    std::ranges::all_of(values, [](auto v) { return v >= 0 && v <= kMost; });
  if (!fits) node->refuse(fmt::format("is not two numbers an index: {}", fmt::join(values, " ")));
  std::ranges::transform(values, rind.begin(), [](auto v) { return static_cast<int>(v); });
  return rind;
}

/// The zone's part of an array that may have rind points around it.
void take(const CgnsNode& array, const CgnsZone& zone, const std::array<int, 6>& rind,
          const std::function<void(std::size_t, double)>& put) {
  std::vector<std::int64_t> expected;
  for (std::size_t a = 0; a < zone.dimension; ++a) {
    expected.push_back(std::int64_t{zone.size[a]} + rind[2 * a] + rind[2 * a + 1]);
  }
  if (array.sizes() != expected) {
    array.refuse(fmt::format("holds {} values, but its zone has {} points",
                             fmt::join(array.sizes(), " x "), fmt::join(expected, " x ")));
  }
  const std::vector<double> values = array.reals();
  expected.resize(3, 1);
  std::size_t point = 0;
  for (int k = 0; k < zone.size[2]; ++k) {
    for (int j = 0; j < zone.size[1]; ++j) {
      const auto row =
          (static_cast<std::size_t>(k + rind[4]) * static_cast<std::size_t>(expected[1]) +
           static_cast<std::size_t>(j + rind[2])) *
              static_cast<std::size_t>(expected[0]) +
          static_cast<std::size_t>(rind[0]);
      for (int i = 0; i < zone.size[0]; ++i, ++point) {
        const double value = values[row + static_cast<std::size_t>(i)];
        if (!std::isfinite(value)) {
          array.refuse(fmt::format("is {} at ({}, {}, {})", value, i + 1, j + 1, k + 1));
        }
        put(point, value);
      }
    }
  }
}

}  // namespace

std::size_t CgnsZone::points() const {
  std::size_t count = 1;
  for (const int s : size) count *= static_cast<std::size_t>(s);
  return count;
}

bool CgnsZone::is_surface() const { return is_structured && std::ranges::count(size, 1) == 1; }

Vec3List CgnsZone::read_points() const {
  const auto grid = grid_of(node);
  if (!grid) node.refuse("has no GridCoordinates_t");
  const std::array<int, 6> rind = rind_of(*grid, dimension);
  Vec3List points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto array = grid->child("DataArray_t", kCoordinates[axis]);
    if (!array && axis < 2) {
      grid->refuse(
          fmt::format("has no {}; only Cartesian coordinates are read", kCoordinates[axis]));
    }
    if (!array) continue;
    // The array is as long as it says once its values are there: only then there is room to make.
    take(*array, *this, rind, [&](std::size_t point, double value) {
      if (points.empty()) points.resize(this->points(), Vec3::Zero());
      points[point][static_cast<Eigen::Index>(axis)] = value;
    });
  }
  return points;
}

std::string family_of(const CgnsNode& node) {
  const auto family = node.child("FamilyName_t");
  if (!family) return {};
  const std::string name = family->text();
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? name : name.substr(slash + 1);
}

CgnsBase read_base(CgnsTree& tree) {
  const CgnsNode root = tree.root();
  const std::vector<CgnsNode> bases = root.children("CGNSBase_t");
  if (bases.empty()) {
    root.refuse("holds no CGNSBase_t; it is no CGNS file, though of a CGNS file's kind");
  }
  CgnsBase base{bases.front(), static_cast<int>(bases.size())};
  if (const auto version = root.child("CGNSLibraryVersion_t")) {
    const std::vector<double> number = version->reals();
    base.version = number.empty() ? 0 : number.front();
  }
  const std::vector<std::int64_t> dimensions = base.node.integers();
  const bool fits = dimensions.size() == 2 && dimensions[0] >= 1 && dimensions[0] <= 3 &&
                    dimensions[1] >= dimensions[0] && dimensions[1] <= 3;
  if (!fits) {
    base.node.refuse(fmt::format("has the dimensions {}; it should be those of cells and of space",
                                 fmt::join(dimensions, ", ")));
  }
  base.cell_dimension = static_cast<int>(dimensions[0]);
  base.physical_dimension = static_cast<int>(dimensions[1]);
  for (const CgnsNode& node : base.node.children()) {
    if (node.label() == "Zone_t") base.zones.push_back(read_zone(node));
    if (node.label() == "Family_t") base.families.push_back(read_family(node));
  }
  if (base.zones.empty()) base.node.refuse("holds no zones");
  base.length_unit = find_unit(base.node, base.zones.front().node);
  return base;
}

void need_structured(const CgnsBase& base) {
  const auto found = std::ranges::find(base.zones, false, &CgnsZone::is_structured);
  if (found == base.zones.end()) return;
  found->node.refuse(
      "is unstructured; surfaces are taken of structured zones alone, and a mesh has zones of one "
      "type");
}

bool CgnsRange::within(const CgnsZone& zone) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::min(begin[a], end[a]) < 0 || std::max(begin[a], end[a]) >= zone.size[a]) return false;
  }
  return true;
}

}  // namespace vdb_offset
