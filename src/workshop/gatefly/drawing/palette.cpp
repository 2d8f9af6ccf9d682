// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/palette.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace gatefly::drawing {

std::string css_of(const Color& color) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "#";
  for (const double part : {color.r, color.g, color.b}) {
    const auto byte = static_cast<unsigned>(std::lround(255.0 * part));
    text += kDigits[byte / 16 % 16];
    text += kDigits[byte % 16];
  }
  return text;
}

std::string css_of(const Palette& p) {
  const std::array<std::pair<const char*, Color>, 20> names{
      {{"page", p.page},   {"panel", p.panel},
       {"well", p.well},   {"ink", p.ink},
       {"muted", p.muted}, {"rule", p.rule},
       {"grid", p.grid},   {"solid", p.solid},
       {"gate", p.gate},   {"gate-solid", p.gate_solid},
       {"flown", p.flown}, {"slow", p.slow},
       {"fast", p.fast},   {"estimate", p.estimate},
       {"found", p.found}, {"plan", p.plan},
       {"good", p.good},   {"bad", p.bad},
       {"warn", p.warn},   {"focus", p.focus}}};
  std::string css;
  for (const auto& [name, color] : names)
    css += std::string{"--"} + name + ":" + css_of(color) + ";";
  return css;
}

}  // namespace gatefly::drawing
