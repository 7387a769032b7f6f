#pragma once

#include <cstdio>
#include <string>

#include "console.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"

namespace vdb_offset::command {

/// With --verbose: the worst of all cells, of the levels (many of them in bands, so that a row
/// shows the worst of its band), and of the patches, the worst first.
void print_quality(const Console& console, const MultiBlock& mesh, const QualityReport& report);

/// A table's head, what its rows are called first, and a row of it.
void print_quality_head(std::FILE* to, const char* what);
void print_quality_row(std::FILE* to, const std::string& name, const QualityMinima& row);

}  // namespace vdb_offset::command
