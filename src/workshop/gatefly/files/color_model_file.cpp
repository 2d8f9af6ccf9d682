// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/color_model_file.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include <nlohmann/json.hpp>

#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::files {
namespace {

constexpr std::string_view kLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr int kVersion = 1, kStep = ColorModel::kUnit / 8, kZero = 32;
constexpr std::size_t kRow = ColorModel::kChroma * ColorModel::kChroma;
using Values = std::array<std::int8_t, ColorModel::kBins>;

char letter_of(int value) {
  const int steps = (value + (value >= 0 ? kStep / 2 : -kStep / 2)) / kStep;
  return kLetters[static_cast<std::size_t>(std::clamp(steps + kZero, 0, 63))];
}

std::string toml_line(const std::string& name, const Values& values) {
  std::string text = name + " = [\n";
  for (std::size_t row = 0; row < ColorModel::kLuma; ++row) {
    text += "  \"";
    for (std::size_t i = 0; i < kRow; ++i) text += letter_of(values[row * kRow + i]);
    text += "\",\n";
  }
  return text + "]\n";
}

void read_values(Table& table, const std::filesystem::path& path, const std::string& key,
                 Values& values) {
  const nlohmann::json& rows = table.raw(key);
  if (!rows.is_array() || rows.size() != ColorModel::kLuma)
    table.fail(key, "a list of " + std::to_string(ColorModel::kLuma) + " texts");
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::string letters = rows[row].is_string() ? rows[row].get<std::string>() : "";
    if (letters.size() != kRow || letters.find_first_not_of(kLetters) != std::string::npos)
      throw std::runtime_error(path.string() + ": " + key + "[" + std::to_string(row) + "] has " +
                               std::to_string(letters.size()) + " letters, must be " +
                               std::to_string(kRow) + " of A-Z, a-z, 0-9, +, /");
    for (std::size_t i = 0; i < kRow; ++i)
      values[row * kRow + i] =
          static_cast<std::int8_t>((static_cast<int>(kLetters.find(letters[i])) - kZero) * kStep);
  }
}

}  // namespace

std::string color_model_text(const ColorModel& model, const std::string& about) {
  return "# A gate's colours, fitted by gatefly tune: one letter a bin. Named by color.table in a "
         "configuration.\nversion = " +
         std::to_string(kVersion) + "\nabout = " +
         nlohmann::json(about).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n" + toml_line("absolute", model.absolute) + toml_line("relative", model.relative);
}

ColorModel read_color_model(const std::filesystem::path& path) {
  const TomlFile file(path);
  Table table(file);
  if (!table.has("version"))
    throw std::runtime_error(path.string() + ": has no version: not a colour table");
  if (table.integer("version", 0, 1'000'000, 0) != kVersion)
    table.fail("version", std::to_string(kVersion));
  (void)table.text("about", "");
  ColorModel model;
  read_values(table, path, "absolute", model.absolute);
  read_values(table, path, "relative", model.relative);
  table.refuse_others();
  model.find_hopeless();
  return model;
}

}  // namespace gatefly::files
