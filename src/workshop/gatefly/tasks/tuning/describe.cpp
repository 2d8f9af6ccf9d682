// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/describe.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::tuning {
namespace {

using Rgb = std::array<double, 3>;

struct Name {
  const char* name;
  Rgb rgb;
};
constexpr std::array kNames{Name{"orange", {1.0, 0.4, 0.0}},  Name{"red", {0.9, 0.1, 0.1}},
                            Name{"yellow", {1.0, 0.85, 0.0}}, Name{"green", {0.1, 0.7, 0.2}},
                            Name{"cyan", {0.0, 0.75, 0.8}},   Name{"blue", {0.1, 0.3, 0.8}},
                            Name{"purple", {0.5, 0.1, 0.7}},  Name{"magenta", {0.9, 0.1, 0.8}},
                            Name{"pink", {1.0, 0.4, 0.7}}};
constexpr std::array kShades{"dark", "light", "bright", "pale"};
constexpr std::array kHueless{"white", "black", "grey", "gray", "silver"};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::optional<Rgb> named(const std::string& text) {
  std::istringstream words(text);
  std::optional<Rgb> found;
  for (std::string word; words >> word;) {
    const auto name =
        std::find_if(kNames.begin(), kNames.end(), [&](const Name& n) { return word == n.name; });
    if (name != kNames.end() && !found)
      found = name->rgb;
    else if (std::find(kShades.begin(), kShades.end(), word) == kShades.end())
      return std::nullopt;
  }
  return found;
}

std::optional<Rgb> from_hex(const std::string& text) {
  if (text.size() != 7 || text[0] != '#' ||
      text.find_first_not_of("0123456789abcdef", 1) != std::string::npos)
    return std::nullopt;
  const long all = std::strtol(text.c_str() + 1, nullptr, 16);
  return Rgb{static_cast<double>(all >> 16) / 255, static_cast<double>(all >> 8 & 255) / 255,
             static_cast<double>(all & 255) / 255};
}

std::optional<Rgb> from_numbers(const std::string& text) {
  Rgb rgb{};
  std::istringstream numbers(text);
  for (std::size_t i = 0; i < 3; ++i) {
    char comma = ',';
    if (i > 0) numbers >> comma;
    if (!(numbers >> rgb[i]) || comma != ',' || !(rgb[i] >= 0.0 && rgb[i] <= 255.0))
      return std::nullopt;
  }
  if (std::string rest; numbers >> rest) return std::nullopt;
  const bool bytes = std::any_of(rgb.begin(), rgb.end(), [](double x) { return x > 1.0; });
  for (double& x : rgb) x /= bytes ? 255.0 : 1.0;
  return rgb;
}

bool has_hue(const Rgb& rgb) {
  const auto [least, most] = std::minmax_element(rgb.begin(), rgb.end());
  return *most - *least >= 0.1;
}

}  // namespace

std::array<double, 3> described_color(const std::string& given) {
  const std::string text = lower(given);
  const bool no_hue =
      std::any_of(kHueless.begin(), kHueless.end(), [&](const char* word) { return text == word; });
  std::optional<Rgb> rgb = named(text);
  if (!rgb) rgb = from_hex(text);
  if (!rgb) rgb = from_numbers(text);
  if (no_hue || (rgb && !has_hue(*rgb)))
    throw std::invalid_argument("'" + files::one_line(given) +
                                "' has no hue: gates are told from grey things by theirs");
  if (rgb) return *rgb;
  std::vector<std::string> names;
  for (const Name& name : kNames) names.emplace_back(name.name);
  throw std::invalid_argument("'" + files::one_line(given) + "' is no colour" +
                              files::suggestion(text, names) +
                              " (there are: " + files::joined(names) + "; or #rrggbb; or r,g,b)");
}

}  // namespace gatefly::tuning
