// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"

namespace gatefly::bench {
namespace {

double fraction(double x) { return x - std::floor(x); }

/// 0..1, the same for the same whole numbers.
double random_at(double x, double y) {
  const auto number = [](double z) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(z)));
  };
  Rng rng{number(x) * 0x9E3779B97F4A7C15ull ^ (number(y) + 0x1000) * 0xD1B54A32D192ED03ull};
  return rng.uniform(0.0, 1.0);
}

double ring(double x, double y) { return std::max(std::abs(x), std::abs(y)); }

// Whether the pattern is coloured at a point; the picture is 315 wide, (x, y) from its middle.
bool is_colored(const Pattern& pattern, double x, double y) {
  const auto& [a, b, c] = pattern.numbers;
  const auto& kind = pattern.kind;
  const double r = std::hypot(x, y), cosine = std::cos(c * kDegree), sine = std::sin(c * kDegree);
  const double along = cosine * x + sine * y, across = cosine * y - sine * x;
  if (kind == "gate") return ring(along, across) <= 0.5 * a && ring(along, across) >= (0.5 - b) * a;
  if (kind == "all") return true;
  if (kind == "checker") return (fraction(0.5 * along / a) < b) == (fraction(0.5 * across / a) < b);
  if (kind == "noise") return random_at(x / a, y / a) < b;
  if (kind == "spiral") return fraction(r / a - std::atan2(y, x) / (2.0 * kPi)) < b;
  if (kind == "rings") return fraction(ring(along, across) / a) < b;
  if (kind == "stripes") return fraction(along / a) < b;
  if (kind == "comb") return fraction(along / a) < b || across > 78.0 * (1.0 - b);
  // gates: one in every cell of a grid
  const double inner = ring(fraction(along / a) - 0.5, fraction(across / a) - 0.5);
  return inner <= 0.42 && inner >= 0.42 - b;
}

}  // namespace

Picture as_uyvy(const std::string& name, const Image& stored, int rotation_deg) {
  Picture picture{name, {}, stored.width() / 2 * 2, stored.height(), rotation_deg};
  picture.uyvy.reserve(
      image_bytes(PixelFormat::kUyvy, picture.stored_width, picture.stored_height));
  for (int v = 0; v < stored.height(); ++v)
    for (int u = 0; u + 1 < stored.width(); u += 2) {
      const Yuv a = stored.at(u, v), b = stored.at(u + 1, v);
      for (const int byte : {(a.u + b.u) / 2, int{a.y}, (a.v + b.v) / 2, int{b.y}})
        picture.uyvy.push_back(static_cast<std::uint8_t>(byte));
    }
  return picture;
}

std::string Pattern::name() const {
  std::string text = kind;
  for (const double number : numbers) text += ":" + files::text_of(number, 4);
  return text;
}

std::span<const PatternKind> pattern_kinds() {
  static const std::vector<PatternKind> kinds{
      {"gate", "one: side px, bar/side, roll deg", {1, 0.01, -60}, {400, 0.5, 60}},
      {"all", "all colour", {0, 0, 0}, {1, 1, 1}},
      {"checker", "squares: px, part, roll deg", {1, 0.1, 0}, {60, 0.9, 45}},
      {"noise", "grains: px, density", {1, 0.005, 0}, {20, 0.95, 1}},
      {"spiral", "turns: distance px, part", {3, 0.1, 0}, {60, 0.9, 1}},
      {"rings", "squares in squares: distance px, part, roll deg", {3, 0.1, 0}, {80, 0.9, 60}},
      {"stripes", "distance px, part, roll deg", {2, 0.1, 0}, {80, 0.9, 90}},
      {"comb",
       "bars on one bar, up to the border: distance px, part, roll deg",
       {3, 0.03, -10},
       {100, 0.6, 10}},
      {"gates", "a grid: distance px, bar/distance, roll deg", {10, 0.03, 0}, {160, 0.3, 60}}};
  return kinds;
}

Pattern pattern_of(const std::string& text) {
  std::istringstream parts{text};
  Pattern pattern;
  std::getline(parts, pattern.kind, ':');
  const auto kinds = pattern_kinds();
  const auto known = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const auto& k) { return k.kind == pattern.kind; });
  if (known == kinds.end()) {
    std::vector<std::string> names;
    for (const auto& kind : kinds) names.push_back(kind.kind);
    throw std::runtime_error("'" + files::one_line(text) +
                             "' is no file, and no pattern (there are: " + files::joined(names) +
                             ")");
  }
  for (std::size_t i = 0; i < pattern.numbers.size(); ++i) {
    pattern.numbers[i] = 0.5 * (known->least[i] + known->most[i]);
    std::string number;
    if (!std::getline(parts, number, ':')) continue;
    char* end = nullptr;
    pattern.numbers[i] = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' ||
        !(pattern.numbers[i] >= known->least[i] && pattern.numbers[i] <= known->most[i]))
      throw std::runtime_error("pattern '" + files::one_line(text) + "': '" +
                               files::one_line(number) + "' must be in " +
                               files::text_of(known->least[i]) + ".." +
                               files::text_of(known->most[i]) + " (" + known->what + ")");
  }
  return pattern;
}

Picture drawn(const Pattern& pattern, int width, int height) {
  const double scale = 315.0 / width;
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0, 255.0)); };
  std::vector<std::uint8_t> upright;  // Y Cb Cr
  upright.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const double x = scale * (u + 0.5 - 0.5 * width), y = scale * (v + 0.5 - 0.5 * height);
      const bool colored = is_colored(pattern, x, y);
      const double grain = random_at(u + 7, v + 3) - 0.5,
                   patch = random_at(x / 9 + 500, y / 9) - 0.5;
      upright.push_back(byte((colored ? 130 : 110 + 40 * patch) + 12 * grain));
      upright.push_back(byte((colored ? 80 : 128 - 12 * patch) + 4 * grain));
      upright.push_back(byte((colored ? 185 : 128 + 12 * patch) - 4 * grain));
    }
  // Stored as the Bebop does: turned clockwise, to be turned back by 90°.
  const Image stored{upright.data(), PixelFormat::kYuv444, width, height, 270};
  return as_uyvy(pattern.name(), stored, 90);
}

}  // namespace gatefly::bench
