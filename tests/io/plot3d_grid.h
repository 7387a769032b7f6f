#pragma once

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"

/// A writer of every PLOT3D dialect, apart from the library's, for its tests.
namespace plot3d_test {

using vdb_offset::Plot3dBlockSize;
using vdb_offset::Plot3dDialect;
using vdb_offset::Vec3;
using vdb_offset::Vec3List;
using vdb_offset::test::file_bytes;
using vdb_offset::test::TempFolder;

struct Grid {
  std::vector<Plot3dBlockSize> sizes;
  std::vector<Vec3List> points;
  std::vector<std::vector<int>> blanks;
};

/// Blocks of seeded points of a size that single precision holds exactly; in 2-D z is 0.
/// Iblanks are 1, with some other legal values among them.
inline Grid make_grid(const std::vector<Plot3dBlockSize>& sizes, bool two_dimensional,
                      unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-10.0, 10.0);
  Grid grid{sizes, {}, {}};
  for (const Plot3dBlockSize& size : sizes) {
    Vec3List points(static_cast<std::size_t>(size.ni * size.nj * size.nk));
    std::vector<int> blanks(points.size(), 1);
    for (std::size_t p = 0; p < points.size(); ++p) {
      for (int c = 0; c < 3; ++c) {
        points[p][c] = static_cast<double>(static_cast<float>(coordinate(random)));
      }
      if (two_dimensional) points[p].z() = 0.0;
      if (p % 5 == 3) blanks[p] = p % 2 == 0 ? 2 : -7;
    }
    grid.points.push_back(points);
    grid.blanks.push_back(blanks);
  }
  return grid;
}

class Encoder {
 public:
  explicit Encoder(const Plot3dDialect& dialect) : dialect_(dialect) {}

  std::string encode(const Grid& grid) {
    if (dialect_.multi_block) {
      whole(static_cast<int>(grid.sizes.size()));
      end_record();
    }
    for (const Plot3dBlockSize& size : grid.sizes) {
      whole(static_cast<int>(size.ni));
      whole(static_cast<int>(size.nj));
      if (!dialect_.two_dimensional) whole(static_cast<int>(size.nk));
    }
    end_record();
    for (std::size_t b = 0; b < grid.sizes.size(); ++b) {
      for (int c = 0; c < (dialect_.two_dimensional ? 2 : 3); ++c) {
        for (const Vec3& point : grid.points[b]) real(point[c]);
      }
      if (dialect_.iblank) {
        for (const int blank : grid.blanks[b]) whole(blank);
      }
      end_record();
    }
    return file_;
  }

 private:
  template <typename T>
  void raw(std::string& to, T value) const {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (dialect_.big_endian != (std::endian::native == std::endian::big)) {
      bytes = std::string(bytes.rbegin(), bytes.rend());
    }
    to += bytes;
  }
  void whole(int value) {
    if (dialect_.formatted) {
      record_ += fmt::format(" {}", value);
    } else {
      raw(record_, static_cast<std::int32_t>(value));
    }
  }
  void real(double value) {
    if (dialect_.formatted) {
      record_ += fmt::format(" {:.17e}", value);
    } else if (dialect_.double_precision) {
      raw(record_, value);
    } else {
      raw(record_, static_cast<float>(value));
    }
  }
  void end_record() {
    const bool marks = !dialect_.formatted && dialect_.records;
    const auto bytes = static_cast<std::uint32_t>(record_.size());
    if (marks) raw(file_, bytes);
    file_ += record_;
    if (marks) raw(file_, bytes);
    if (dialect_.formatted) file_ += '\n';
    record_.clear();
  }

  Plot3dDialect dialect_;
  std::string file_, record_;
};

inline std::string encode(const Plot3dDialect& dialect, const Grid& grid) {
  return Encoder(dialect).encode(grid);
}

/// All 72: 8 of text, 64 of bytes.
inline std::vector<Plot3dDialect> all_dialects() {
  std::vector<Plot3dDialect> all;
  for (unsigned bits = 0; bits < 128; ++bits) {
    const auto bit = [bits](unsigned b) { return (bits >> b & 1u) != 0; };
    const Plot3dDialect dialect{bit(6), bit(0), bit(1), bit(2), bit(3), bit(4), bit(5)};
    if (dialect.formatted && (bits & 7u) != 3u) continue;  // what text leaves at its defaults
    all.push_back(dialect);
  }
  return all;
}

/// A hint that leaves nothing open.
inline vdb_offset::Plot3dHint hint_of(const Plot3dDialect& d) {
  return {d.formatted, d.records,     d.double_precision, d.big_endian,
          d.iblank,    d.multi_block, d.two_dimensional};
}

/// ../shared/data/plot3d, or an empty path where that is absent.
inline std::filesystem::path shared_folder() {
  const char* told = std::getenv("VDB_OFFSET_SHARED_DATA");
  const std::filesystem::path data =
      told != nullptr ? std::filesystem::path(told)
                      : std::filesystem::path(VDB_OFFSET_SOURCE_DIR) / "../shared/data";
  return std::filesystem::is_directory(data / "plot3d") ? data / "plot3d" : std::filesystem::path();
}

/// What `call` says in its IoError, or "" if it throws none.
template <class Call>
std::string io_error(const Call& call) {
  try {
    call();
  } catch (const vdb_offset::IoError& error) {
    return error.what();
  }
  return {};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace plot3d_test
