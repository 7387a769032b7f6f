#pragma once

#include <string>
#include <string_view>

namespace vdb_offset {

/// `text` fit for an XML attribute: markup escaped; control characters and bytes that are not
/// UTF-8, which no XML reader takes, as '?'.
std::string xml_text(std::string_view text);

}  // namespace vdb_offset
