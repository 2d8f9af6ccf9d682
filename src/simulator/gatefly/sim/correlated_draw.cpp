// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/correlated_draw.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/sim/normal.hpp"

namespace gatefly::sim {

namespace {

constexpr double kMomentsPerSecond = 30.0;               // [ours: twice the Bebop's pictures]
constexpr std::uint32_t kRow = 2, kNew = 3, kOther = 4;  // Stream::uniform() has 1

double uniform_at(const Stream& stream, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto w = stream.words(a, b, c);
  return (w[0] + 0x1p32 * (w[1] & 0x1fffff)) * 0x1p-53;
}

double normal_at(const Stream& stream, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform_at(stream, a, b, c)));
  return radius * std::cos(6.283185307179586 * uniform_at(stream, a, b + 1, c));
}

}  // namespace

double Draws::uniform() { return uniform_at(stream_, moment_, count_++, kOther); }

double Draws::normal() {
  count_ += 2;
  return normal_at(stream_, moment_, count_ - 2, kOther);
}

std::uint32_t moment_of(double t) {
  return static_cast<std::uint32_t>(std::llround(std::max(0.0, t) * kMomentsPerSecond));
}

CorrelatedDraw::CorrelatedDraw(const Staying& staying, double seed_part, const Stream& stream)
    : seed_part_{std::sqrt(staying.seed) * seed_part},
      row_share_{std::sqrt(staying.row)},
      new_share_{std::sqrt(std::max(0.0, 1.0 - staying.seed - staying.row))},
      same_{std::exp(-1.0 / (kMomentsPerSecond * staying.time))},
      stream_{stream},
      row_{normal_at(stream_, 0, 0, kRow)} {}

double CorrelatedDraw::normal(double t) {
  const std::uint32_t now = moment_of(t);
  while (moment_ < now)
    row_ = same_ * row_ + std::sqrt(1.0 - same_ * same_) * normal_at(stream_, ++moment_, 0, kRow);
  return seed_part_ + row_share_ * row_ + new_share_ * normal_at(stream_, now, 0, kNew);
}

double CorrelatedDraw::part(double t) { return normal_cdf(normal(t)); }

CorrelatedDraws::CorrelatedDraws(std::uint64_t seed, const std::string& name,
                                 const Staying& staying, bool shared)
    : seed_{seed}, name_{name}, staying_{staying}, shared_{shared} {}

CorrelatedDraw& CorrelatedDraws::of(int which) {
  const auto known = draws_.find(which);
  if (known != draws_.end()) return known->second;
  const std::string own = name_ + " " + std::to_string(which);
  // The stream's name decides what is drawn: another one would redraw every race.
  Stream of_seed{seed_, (shared_ ? name_ : own) + " day"};
  return draws_.emplace(which, CorrelatedDraw{staying_, of_seed.normal(), Stream{seed_, own}})
      .first->second;
}

bool CorrelatedDraws::happens(int which, double rate, double t, double& surplus) {
  const double part = of(which).part(t);
  if (part >= rate) return false;
  surplus = 1.0 - part / rate;
  return true;
}

}  // namespace gatefly::sim
