// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace gatefly::io {

/// A TOML file as a JSON value: tables are objects, numbers keep being whole or not.
/// @throws std::runtime_error "file:line: what is wrong".
[[nodiscard]] nlohmann::json read_toml(const std::filesystem::path& path);

/// One TOML value as typed after `--set key=`; bare words are text.
[[nodiscard]] nlohmann::json parse_toml_value(std::string_view text);

/// A value as an error message shows it.
[[nodiscard]] std::string shown(const nlohmann::json& value);

/// Reads one table of a file key by key; knows which keys nobody asked for.
///
/// Every error is one line: "file: where.key = value, must be ...".
class Table {
 public:
  /// @param where  the table's own name in the file, "" at the top.
  /// @throws std::runtime_error when `value` is not a table.
  Table(const nlohmann::json& value, std::string file, std::string where);

  [[nodiscard]] bool has(const std::string& key);
  /// A number in [low, high]; `fallback` when absent.
  double number(const std::string& key, double low, double high, double fallback);
  /// The same, but it must be there.
  double number(const std::string& key, double low, double high);
  int integer(const std::string& key, int low, int high, int fallback);
  /// `count` numbers, each in [low, high]; must be there.
  std::vector<double> numbers(const std::string& key, std::size_t count, double low, double high);
  std::string text(const std::string& key, const std::string& fallback);
  /// The value of a key as it is; null when absent.
  const nlohmann::json& raw(const std::string& key);

  /// To be called last. @throws std::runtime_error naming a key nobody asked for, and the nearest
  /// known.
  void refuse_others() const;
  /// @throws std::runtime_error "file: where.key = value, must be <what>".
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;
  [[nodiscard]] std::string name_of(const std::string& key) const;

 private:
  double checked(const std::string& key, const nlohmann::json& value, double low,
                 double high) const;

  const nlohmann::json& value_;
  std::string file_, where_;
  std::vector<std::string> known_;
};

}  // namespace gatefly::io
