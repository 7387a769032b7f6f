// VTK's XML formats as "VTK File Formats" (Kitware) describes them.

#include "io/vtk_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>

#include "io/input_file.h"
#include "io/number_text.h"
#include "io/text_words.h"
#include "io/vtk_arrays.h"
#include "io/vtk_stream.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

/// zlib packs no data further.
constexpr std::size_t kMostPacked = 1032;

/// `visit(T{})` for the type of that name; false if there is none.
template <typename Visit>
bool with_type(std::string_view name, const Visit& visit) {
  const auto is = [&]<typename T>(std::string_view word, T zero) {
    if (name != word) return false;
    visit(zero);
    return true;
  };
  return is("Float64", double{}) || is("Float32", float{}) || is("Int8", std::int8_t{}) ||
         is("UInt8", std::uint8_t{}) || is("Int16", std::int16_t{}) ||
         is("UInt16", std::uint16_t{}) || is("Int32", std::int32_t{}) ||
         is("UInt32", std::uint32_t{}) || is("Int64", std::int64_t{}) ||
         is("UInt64", std::uint64_t{});
}

/// The next number of a header.
std::optional<std::uint64_t> take_word(VtkStream& stream, std::size_t bytes) {
  const std::string_view taken = stream.take(bytes);
  if (taken.size() < bytes) return {};
  std::uint64_t wide = 0;
  std::uint32_t narrow = 0;
  if (bytes == sizeof(wide)) {
    std::memcpy(&wide, taken.data(), bytes);
    return wide;
  }
  std::memcpy(&narrow, taken.data(), bytes);
  return narrow;
}

std::optional<std::string> take_plain(VtkStream& stream, std::size_t word, std::size_t bytes) {
  const auto said = take_word(stream, word);
  if (!said || *said != bytes) return {};
  std::string out(stream.take(bytes));
  return out.size() == bytes ? std::optional(std::move(out)) : std::nullopt;
}

/// Blocks: their number, the bytes of each but the last, those of the last (0: it is like the
/// others), and how long each is packed.
std::optional<std::string> take_packed(VtkStream& stream, std::size_t word, std::size_t bytes,
                                       std::size_t most_blocks) {
  const auto blocks = take_word(stream, word);
  const auto size = take_word(stream, word);
  const auto last = take_word(stream, word);
  if (!blocks || !size || !last || *blocks > most_blocks) return {};
  std::vector<std::uint64_t> packed;
  for (std::uint64_t b = 0; b < *blocks; ++b) {
    const auto length = take_word(stream, word);
    if (!length) return {};
    packed.push_back(*length);
  }
  std::string out;
  for (std::size_t b = 0; b < packed.size(); ++b) {
    const std::size_t want = b + 1 == packed.size() && *last > 0 ? *last : *size;
    if (want > bytes - out.size()) return {};
    const std::string_view block = stream.take(packed[b]);
    if (block.size() != packed[b]) return {};
    const std::size_t begin = out.size();
    out.resize(begin + want);
    uLongf length = want;
    const int result =
        uncompress(reinterpret_cast<Bytef*>(out.data() + begin), &length,
                   reinterpret_cast<const Bytef*>(block.data()), static_cast<uLong>(block.size()));
    if (result != Z_OK || length != want) return {};
  }
  return out.size() == bytes ? std::optional(std::move(out)) : std::nullopt;
}

std::string name_of(const pugi::xml_node& array) {
  const std::string name = array.attribute("Name").value();
  return name.empty() ? "an array without a name" : "array " + vdb_offset::quoted(name);
}

}  // namespace

void VtkFile::refuse(const std::string& why) const {
  throw IoError(fmt::format("{}: {}", name_, why));
}

VtkFile::VtkFile(const std::filesystem::path& file, std::string_view type)
    : name_(file.string()), bytes_(contents_of(file, "a VTK file")) {
  // What is appended is no XML.
  const std::string_view all = bytes_;
  const std::size_t appended = all.find("<AppendedData");
  std::string head(all.substr(0, appended));
  if (appended != std::string_view::npos) head += "</VTKFile>";
  const pugi::xml_parse_result parsed = tree_.load_buffer(head.data(), head.size());
  const pugi::xml_node top = tree_.child("VTKFile");
  if (!top || type != top.attribute("type").value() || !root()) {
    refuse(fmt::format("is no VTK file of the type {}{}{}", type, parsed ? "" : ": ",
                       parsed ? "" : parsed.description()));
  }
  if (all.rfind("</VTKFile>") == std::string_view::npos) refuse("ends before </VTKFile>");
  if (!parsed) {
    refuse(fmt::format("is no XML at byte {}: {}", parsed.offset, parsed.description()));
  }
  const std::string_view packer = top.attribute("compressor").value();
  is_packed_ = !packer.empty();
  if (is_packed_ && packer != "vtkZLibDataCompressor") {
    refuse(fmt::format("is packed by {}, but vtkZLibDataCompressor alone is read", quoted(packer)));
  }
  word_ = std::string_view(top.attribute("header_type").value()) == "UInt64" ? 8 : 4;
  if (appended == std::string_view::npos) return;
  const std::size_t end = all.find('>', appended);
  const std::size_t mark = all.find('_', end);
  if (end == std::string_view::npos || mark == std::string_view::npos) {
    refuse("<AppendedData> has no '_' before its data");
  }
  appended_ = all.substr(mark + 1);
  appended_is_raw_ = all.substr(appended, end - appended).find("base64") == std::string_view::npos;
}

pugi::xml_node VtkFile::root() const {
  const pugi::xml_node top = tree_.child("VTKFile");
  return top.child(top.attribute("type").value());
}

/// Of an array that is not text.
std::string VtkFile::data_of(const pugi::xml_node& array, std::size_t bytes) const {
  const std::string_view order = tree_.child("VTKFile").attribute("byte_order").value();
  if (order != kVtkByteOrder) {
    refuse(fmt::format("byte_order is {}, but {} alone is read, or text", quoted(order),
                       kVtkByteOrder));
  }
  std::string_view text = array.text().get();
  const bool is_appended = std::string_view(array.attribute("format").value()) == "appended";
  if (is_appended) {
    const auto offset = parse_whole(array.attribute("offset").value());
    if (!offset || *offset < 0 || *offset > std::ssize(appended_)) {
      refuse(fmt::format("{}: offset {} does not lie within the appended data", name_of(array),
                         quoted(array.attribute("offset").value())));
    }
    text = appended_.substr(static_cast<std::size_t>(*offset));
  }
  VtkStream stream(text, is_appended && appended_is_raw_);
  auto data = is_packed_ ? take_packed(stream, word_, bytes, text.size())
                         : take_plain(stream, word_, bytes);
  if (!data) {
    refuse(fmt::format("{}: its data are damaged, or are not the {} bytes they should be",
                       name_of(array), bytes));
  }
  return *std::move(data);
}

template <typename T>
std::vector<T> VtkFile::text_numbers(const pugi::xml_node& array, std::size_t count) const {
  std::vector<T> out;
  TextWords words(array.text().get());
  while (words.next()) {
    const auto value = [&] {
      if constexpr (std::is_integral_v<T>) {
        return parse_whole(words.word());
      } else {
        return parse_real(words.word());
      }
    }();
    if (!value) {
      refuse(fmt::format("{}: {} is no {}number", name_of(array), quoted(words.word()),
                         std::is_integral_v<T> ? "whole " : ""));
    }
    if (out.size() == count)
      refuse(fmt::format("{}: has more than {} numbers", name_of(array), count));
    out.push_back(*value);
  }
  if (out.size() < count) {
    refuse(fmt::format("{}: has {} numbers, not {}", name_of(array), out.size(), count));
  }
  return out;
}

template <typename T>
std::vector<T> VtkFile::numbers(const pugi::xml_node& array, std::size_t count) const {
  if (!array) refuse("an array that it needs is missing");
  const std::string_view format = array.attribute("format").value();
  const bool is_text = format == "ascii";
  if (!is_text && format != "binary" && format != "appended") {
    refuse(fmt::format("{}: format is {}, but must be ascii, binary or appended", name_of(array),
                       quoted(format)));
  }
  // A number takes a letter and a blank, or a byte of what may be packed.
  if (count > size() * (is_packed_ && !is_text ? kMostPacked : 1)) {
    refuse(fmt::format("{}: the file is too short for {} numbers", name_of(array), count));
  }
  if (is_text) return text_numbers<T>(array, count);
  std::vector<T> out;
  const std::string_view type = array.attribute("type").value();
  const bool is_known = with_type(type, [&]<typename Kept>(Kept) {
    if (std::is_integral_v<T> && !std::is_integral_v<Kept>) {
      refuse(fmt::format("{}: {} are no whole numbers", name_of(array), type));
    }
    const std::string data = data_of(array, count * sizeof(Kept));
    out.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
      Kept value{};
      std::memcpy(&value, data.data() + n * sizeof(Kept), sizeof(Kept));
      out[n] = static_cast<T>(value);
    }
  });
  if (!is_known) refuse(fmt::format("{}: type {} is not read", name_of(array), quoted(type)));
  return out;
}

std::vector<double> VtkFile::reals(const pugi::xml_node& array, std::size_t count) const {
  std::vector<double> out = numbers<double>(array, count);
  const auto bad = std::ranges::find_if(out, [](double x) { return !std::isfinite(x); });
  if (bad != out.end()) {
    refuse(fmt::format("{}: number {} is {}, but must be finite", name_of(array), bad - out.begin(),
                       *bad));
  }
  return out;
}

std::vector<std::int64_t> VtkFile::wholes(const pugi::xml_node& array, std::size_t count) const {
  return numbers<std::int64_t>(array, count);
}

Vec3List VtkFile::points(const pugi::xml_node& piece, std::size_t count) const {
  const pugi::xml_node array = piece.child("Points").child("DataArray");
  const std::vector<double> numbers = reals(array, 3 * count);
  Vec3List out(count);
  for (std::size_t p = 0; p < count; ++p) {
    out[p] = {numbers[3 * p], numbers[3 * p + 1], numbers[3 * p + 2]};
  }
  return out;
}

}  // namespace vdb_offset
