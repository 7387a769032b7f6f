#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/zone_mesh.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// How a PLOT3D grid file is written down: it has no magic number, so this is found by parsing.
struct Plot3dDialect {
  bool formatted = true;  ///< text tokens; else binary
  bool records = true;  ///< binary: Fortran record marks around each record, else a plain C stream
  bool double_precision = true;
  bool big_endian = false;
  bool iblank = false;
  bool multi_block = true;       ///< starts with the number of blocks
  bool two_dimensional = false;  ///< `ni nj` and no z

  /// "formatted, multi-block, 3-D" or "Fortran records, double, little-endian, multi-block, 3-D,
  /// iblank".
  std::string describe() const;
};

/// What a reader may be told instead of finding out; unset members are detected.
struct Plot3dHint {
  std::optional<bool> formatted, records, double_precision, big_endian, iblank, multi_block,
      two_dimensional;
  /// Comma-separated words: formatted, unformatted, c-stream, single, double, big-endian,
  /// little-endian, iblank, no-iblank, single-block, multi-block, 2d, 3d.
  /// "unformatted" means Fortran records; what belongs to binary files is ignored for text.
  /// Throws InputError for an unknown word, listing the known, and for a contradiction.
  static Plot3dHint parse(const std::string& words);
};

struct Plot3dBlockSize {
  std::int64_t ni = 0, nj = 0, nk = 0;
};

/// Dialect and sizes: what `info` prints.
struct Plot3dInfo {
  Plot3dDialect dialect;
  std::vector<Plot3dBlockSize> blocks;
};

/// Find dialect and sizes.
///
/// A dialect fits when its sizes use up the file: the exact number of bytes (and the right record
/// marks), or of text tokens. If several fit, those with iblanks that look like iblanks come first
/// (small whole numbers, not all 0, beside coordinates that are not), then those whose coordinates
/// are finite and of a sane size, then the first in this order: Fortran records before C stream,
/// multi-block before single-block, 3-D before 2-D, no iblank before iblank, double before single,
/// little-endian before big-endian. `hint` narrows the choice.
/// Two readings of cut files are refused unless told: a C stream where record marks fit as far as
/// the file goes, and a single block 1 x ni x nj whose first coordinate is the whole number 1.
/// Text: blanks, line ends and single commas separate; `3*0.5` and 1.0D-3 are read; numbers that
/// nothing separates are not.
/// Cost    one pass over the file; memory is a small multiple of its length, and sizes are checked
///         against that length before anything is allocated.
/// Throws  IoError naming the file, the dialect that came nearest, the byte or token, and the
///         value.
Plot3dInfo inspect_plot3d(const std::filesystem::path& file, const Plot3dHint& hint = {});

/// Read a surface, or curves: every block must have exactly one of its three sizes equal to 1, and
/// becomes the patch of the other two, the earlier one as i; or every block has exactly two of them
/// equal to 1, and becomes a curve (`nj == 1`) of the third, in its order. Patches are named
/// "patch 1", "patch 2", ...; world units as in the file. A 2-D file gives z = 0, and one of blocks
/// `ni x 1` is curves. A point with iblank = 0 is an error that names it (holes are not supported).
/// Throws IoError as inspect_plot3d, and for a volume block or a single point, curves and surfaces
/// in one file, or a coordinate that is not finite.
Patches read_plot3d(const std::filesystem::path& file, const Plot3dHint& hint = {});

/// Read a volume mesh: every block becomes a zone "block 1", "block 2", ...; the format says
/// nothing of connectivity (see neutral_map.h). A plane mesh (2-D) becomes one cell thick along j,
/// its own j running along k. Throws IoError as above, and for a block without cells.
ZoneMesh read_plot3d_mesh(const std::filesystem::path& file, const Plot3dHint& hint = {});

struct Plot3dWriteOptions {
  /// Text with 17 significant digits; else Fortran records, double, native byte order.
  bool formatted = false;
};

/// Write a surface as multi-block `ni x nj x 1`, by temporary file and rename; both kinds bring
/// every double back. Curves alone, all in z = 0, become the 2-D dialect, `ni x 1` and no z; else
/// `ni x 1 x 1`. Throws IoError, before writing if a block's record would pass the 2^31 - 1
/// bytes that its marks can say, and InputError if there is nothing to write, or curves and
/// surfaces.
void write_plot3d(const std::filesystem::path& file, const Patches& patches,
                  const Plot3dWriteOptions& options = {});
/// Write blocks as multi-block `ni x nj x nk`, by temporary file and rename; those of curves as
/// plane `ni x nk`, x and y alone.
void write_plot3d(const std::filesystem::path& file, const MultiBlock& mesh,
                  const Plot3dWriteOptions& options = {});

}  // namespace vdb_offset
