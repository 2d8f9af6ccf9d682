// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"

namespace gatefly::files {

/// A TOML file as a JSON value, tables are objects, numbers keep being whole or not; and where in
/// it everything stands. Of at most 1 MiB and 16 levels.
class TomlFile {
 public:
  /// @throws std::runtime_error "file:line: what is wrong".
  explicit TomlFile(const std::filesystem::path& path);
  /// Reads content that is already known.
  TomlFile(const std::filesystem::path& path, std::string_view content);

  [[nodiscard]] const nlohmann::json& content() const { return content_; }
  /// "file:12": the line of what a JSON pointer leads to, or of the nearest table around it.
  [[nodiscard]] std::string place(std::string pointer) const;

 private:
  std::string name_;
  nlohmann::json content_;
  std::map<std::string, unsigned> lines_;  ///< By JSON pointer.
};

/// One TOML value as typed after `--set key=`; bare words are text.
[[nodiscard]] nlohmann::json parse_toml_value(std::string_view text);

/// Reads one table of a file key by key; knows which keys nobody asked for.
///
/// Every error is one line: "file:12: where.key = value, must be ...".
class Table {
 public:
  /// The whole file, which must live as long.
  explicit Table(const TomlFile& file) : Table{file, "", ""} {}
  /// A table in this one, by its key. @throws std::runtime_error when it is none.
  [[nodiscard]] Table table(const std::string& key);
  /// One of a list of tables; `name` is for people, who count from 1: "gate 1".
  [[nodiscard]] Table item(const std::string& key, std::size_t index, const std::string& name);

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
  /// @throws std::runtime_error "file:12: where.key = value, must be <what>".
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  /// @param pointer  leads to it in the file; @param before  stands before a key's name.
  Table(const TomlFile& file, std::string pointer, std::string before);
  [[nodiscard]] std::string place_and_name(const std::string& key) const;
  double checked(const std::string& key, const nlohmann::json& value, double low,
                 double high) const;

  const TomlFile& file_;
  const nlohmann::json& value_;
  std::string pointer_, before_;
  std::vector<std::string> known_;
};

}  // namespace gatefly::files
