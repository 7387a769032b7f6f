#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace vdb_offset {

/// Base of everything this library throws on purpose.
///
/// `what()` says where, which value, which rule it breaks, and what to try.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, std::vector<std::int64_t> indices = {})
      : std::runtime_error(message), indices_(std::move(indices)) {}

  /// The offending indices, outermost first: {patch, i, j}, {block, i, j, k} or {byte}; may be
  /// empty.
  const std::vector<std::int64_t>& indices() const { return indices_; }

 private:
  std::vector<std::int64_t> indices_;
};

/// The input breaks a rule: a surface that is not a manifold, an option out of range.
class InputError : public Error {
 public:
  using Error::Error;
};

/// A file cannot be read or written.
class IoError : public Error {
 public:
  using Error::Error;
};

/// A limit set by the user or the machine would be passed: memory, iterations.
class LimitError : public Error {
 public:
  using Error::Error;
};

/// The caller asked to stop (`Progress::cancel`).
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace vdb_offset
