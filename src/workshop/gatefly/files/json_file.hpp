// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

// JSON that others may have written, or changed: whatever is in a file, its reader gets a value of
// the type it asks for, or one line that says what is wrong where.

namespace gatefly::files {

/// Content of JSON file of at most 32 MiB, 64 levels, two million values and 10 000 members an
/// object: a reader may copy, compare and print it.
/// @throws std::runtime_error "run_000003.json: is damaged, ...".
[[nodiscard]] nlohmann::ordered_json read_json(const std::filesystem::path& path);

/// The same of a text. @param name  of the file, in messages.
[[nodiscard]] nlohmann::ordered_json json_of(const std::string& text, const std::string& name);

/// Reads the members of one object of a JSON file.
///
/// Every error is one line: "run_000003.json: detection.frames = "many", must be ...". Members
/// nobody asks for are left alone.
class JsonObject {
 public:
  /// @param file   in messages
  /// @param value  must live as long. @throws std::runtime_error when it is no object.
  JsonObject(const std::string& file, const nlohmann::ordered_json& value);

  /// Whether there is such a member, other than null.
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] JsonObject object(std::string_view key) const;
  [[nodiscard]] bool truth(std::string_view key) const;
  /// Any that is finite.
  [[nodiscard]] double number(std::string_view key) const;
  /// The same, or NaN for null, which stands for what is no number.
  [[nodiscard]] double number_or_null(std::string_view key) const;
  /// The members of a list of objects, at most so many.
  [[nodiscard]] std::vector<JsonObject> objects(std::string_view key, std::size_t most) const;
  /// A list of exactly so many, of which each may be null; as many NaN for null.
  [[nodiscard]] std::vector<double> numbers_or_null(std::string_view key, std::size_t count) const;
  [[nodiscard]] std::uint64_t whole(
      std::string_view key, std::uint64_t low = 0,
      std::uint64_t high = std::numeric_limits<std::uint64_t>::max()) const;
  /// A list of exactly so many.
  [[nodiscard]] std::vector<std::uint64_t> wholes(std::string_view key, std::size_t count,
                                                  std::uint64_t low, std::uint64_t high) const;
  /// A whole number that counts something: 0 to a thousand million.
  [[nodiscard]] int count(std::string_view key) const;
  [[nodiscard]] std::string text(std::string_view key) const;
  /// The same; `fallback` when it is not there.
  [[nodiscard]] std::string text(std::string_view key, const std::string& fallback) const;
  /// @throws std::runtime_error "file: where.key = value, must be <what>".
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;

 private:
  JsonObject(std::string file, std::string before, const nlohmann::ordered_json& value);
  [[nodiscard]] const nlohmann::ordered_json* find(std::string_view key) const;

  std::string file_, before_;  ///< before_: stands before a member's name, "detection.".
  const nlohmann::ordered_json* value_;
};

}  // namespace gatefly::files
