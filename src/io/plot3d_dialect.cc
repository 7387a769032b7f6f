#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"

namespace vdb_offset {
namespace {

using Member = std::optional<bool> Plot3dHint::*;

struct Word {
  std::string_view text;
  Member member;
  bool value;
};

constexpr std::array kWords = {
    Word{"formatted", &Plot3dHint::formatted, true},
    Word{"unformatted", &Plot3dHint::records, true},
    Word{"c-stream", &Plot3dHint::records, false},
    Word{"single", &Plot3dHint::double_precision, false},
    Word{"double", &Plot3dHint::double_precision, true},
    Word{"big-endian", &Plot3dHint::big_endian, true},
    Word{"little-endian", &Plot3dHint::big_endian, false},
    Word{"iblank", &Plot3dHint::iblank, true},
    Word{"no-iblank", &Plot3dHint::iblank, false},
    Word{"single-block", &Plot3dHint::multi_block, false},
    Word{"multi-block", &Plot3dHint::multi_block, true},
    Word{"2d", &Plot3dHint::two_dimensional, true},
    Word{"3d", &Plot3dHint::two_dimensional, false},
};

void set(Plot3dHint& hint, Member member, bool value) {
  std::optional<bool>& old = hint.*member;
  if (old && *old != value) {
    throw InputError(
        "PLOT3D dialect: two of the words contradict each other; give one of each kind");
  }
  old = value;
}

void add_word(Plot3dHint& hint, std::string_view text) {
  for (const Word& word : kWords) {
    if (word.text != text) continue;
    set(hint, word.member, word.value);
    if (word.member == &Plot3dHint::records) set(hint, &Plot3dHint::formatted, false);
    return;
  }
  std::string known;
  for (const Word& word : kWords)
    known += fmt::format("{}{}", known.empty() ? "" : ", ", word.text);
  throw InputError(fmt::format("PLOT3D dialect: \"{}\" is unknown; the words are {}", text, known));
}

}  // namespace

std::string Plot3dDialect::describe() const {
  std::string text = "formatted";
  if (!formatted) {
    text = fmt::format("{}, {}, {}", records ? "Fortran records" : "C stream",
                       double_precision ? "double" : "single",
                       big_endian ? "big-endian" : "little-endian");
  }
  return fmt::format("{}, {}, {}{}", text, multi_block ? "multi-block" : "single-block",
                     two_dimensional ? "2-D" : "3-D", iblank ? ", iblank" : "");
}

Plot3dHint Plot3dHint::parse(const std::string& words) {
  Plot3dHint hint;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    std::string word;
    for (const char c : words.substr(begin, end - begin)) {
      if (c != ' ') word += c;
    }
    if (!word.empty()) add_word(hint, word);
    begin = end + 1;
  }
  return hint;
}

}  // namespace vdb_offset
