#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace vdb_offset {

/// One file of a polyMesh: its tokens, behind the header.
///
/// Words, numbers and quoted text, and each of ( ) { } ; alone; comments are passed over.
class FoamText {
 public:
  /// Throws IoError for a file that is not there, compressed, binary, or of another class.
  FoamText(const std::filesystem::path& folder, const std::string& name, std::string_view kind);

  bool at_end();
  std::string_view next();
  void expect(std::string_view token);
  /// The next token as a whole number in [least, most].
  std::int64_t whole(const char* what, std::int64_t least, std::int64_t most);
  double real();
  /// A count of items, of `item_bytes` at least, and the bracket that they begin with.
  std::size_t begin_list(std::size_t item_bytes);
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  void pass_blanks();
  void read_header(std::string_view kind);

  std::string file_;
  std::string bytes_;
  std::size_t at_ = 0;
  std::size_t begin_ = 0;  // of the token read last
};

}  // namespace vdb_offset
