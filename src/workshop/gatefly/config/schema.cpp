// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/schema.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "gatefly/config/allowed_values.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"

namespace gatefly::config {
namespace {

// 315.0 is as whole as 315.
bool is_whole(const nlohmann::json& value) {
  return value.is_number_integer() ||
         (value.is_number() && std::floor(value.get<double>()) == value.get<double>());
}

bool in_range(const KeyRule& rule, const nlohmann::json& value) {
  if (!value.is_number()) return false;
  const double number = value.get<double>();
  return number >= rule.low && number <= rule.high;  // NaN is not
}

bool fits(const KeyRule& rule, const nlohmann::json& value) {
  switch (rule.kind) {
    case KeyRule::Kind::kNumber:
      return in_range(rule, value);
    case KeyRule::Kind::kInteger:
      return is_whole(value) && in_range(rule, value);
    case KeyRule::Kind::kNumbers:
      return value.is_array() && value.size() == rule.count &&
             std::all_of(value.begin(), value.end(), [&](const auto& v) {
               return in_range(rule, v) && (!rule.whole || is_whole(v));
             });
    case KeyRule::Kind::kNumberOrList:
      return in_range(rule, value) || (value.is_array() && value.size() <= rule.count &&
                                       std::all_of(value.begin(), value.end(), [&](const auto& v) {
                                         return in_range(rule, v);
                                       }));
    case KeyRule::Kind::kFile:
      return value.is_string();
    case KeyRule::Kind::kText:
      break;
  }
  return value.is_string() && std::find(rule.choices.begin(), rule.choices.end(),
                                        value.get<std::string>()) != rule.choices.end();
}

}  // namespace

std::string allowed_values(const KeyRule& rule) {
  const std::string range = files::text_of(rule.low) + ".." + files::text_of(rule.high);
  switch (rule.kind) {
    case KeyRule::Kind::kNumber:
      return "a number in " + range;
    case KeyRule::Kind::kInteger:
      return "a whole number in " + range;
    case KeyRule::Kind::kNumbers:
      return std::to_string(rule.count) + (rule.whole ? " whole numbers in " : " numbers in ") +
             range;
    case KeyRule::Kind::kNumberOrList:
      return "a number or a list of at most " + std::to_string(rule.count) + ", in " + range;
    case KeyRule::Kind::kFile:
      return "the name of a file, or \"\" for none";
    case KeyRule::Kind::kText:
      break;
  }
  return (rule.choices.size() == 1 ? "\"" : "one of \"") + files::joined(rule.choices, "\", \"") +
         "\"";
}

nlohmann::json checked(const KeyRule& rule, const nlohmann::json& value, const std::string& where) {
  if (!fits(rule, value))
    throw std::runtime_error(where + ": " + rule.name + " = " + files::shown(value) + ", must be " +
                             allowed_values(rule));
  return value;
}

std::string unit_of(const std::string& key) {
  static const std::array<std::pair<const char*, const char*>, 25> units{
      {{"_rad_per_m", "rad/m"},
       {"_rad_s_per_m", "rad s/m"},
       {"_per_s2", "1/s²"},
       {"_per_s", "1/s"},
       {"_per_m", "1/m"},
       {"_radps", "rad/s"},
       {"_degps", "°/s"},
       {"_mps2", "m/s²"},
       {"_mps", "m/s"},
       {"_kgm2", "kg m²"},
       {"_kg", "kg"},
       {"_deg", "°"},
       {"_px", "px"},
       {"_hz", "Hz"},
       {"_ms", "ms"},
       {"_us", "µs"},
       {"_percent", "%"},
       {"_m", "m"},
       {"_s", "s"},
       {"_m2", "m²"},
       {"_rad", "rad"},
       {"_ah", "Ah"},
       {"_v", "V"},
       {"_ohm", "Ω"},
       {"_w", "W"}}};
  for (const auto& [ending, unit] : units)
    if (key.ends_with(ending)) return unit;
  return "";
}

double in_unit(double si, double unit) {
  if (unit == 1.0) return si;
  constexpr int kAllDigits = 17;
  const double quotient = si / unit;
  for (int digits = 1; digits <= kAllDigits; ++digits)
    if (const double value = std::stod(files::text_of(quotient, digits)); value * unit == si)
      return value;
  // The quotient is rounded: what multiplies back may be its neighbour, if anything does.
  for (const double towards : {-HUGE_VAL, HUGE_VAL})
    if (const double value = std::nextafter(quotient, towards); value * unit == si) return value;
  return quotient;
}

}  // namespace gatefly::config
