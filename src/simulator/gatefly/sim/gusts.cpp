// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/gusts.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::sim {
namespace {

constexpr double kSlowest = 0.5;  // [m/s]

}  // namespace

// With x = n / (1 + τs) and y = x / (1 + τs): (1 + √3 τs) / (1 + τs)² n = √3 x + (1 - √3) y. Its
// variance with x of variance 1, y of 1/2 and a covariance of 1/2 is 3 + (1-√3)²/2 + √3 (1-√3) = 2.
double Gusts::Across::value() const {
  const double root3 = std::sqrt(3.0);
  return (root3 * x + (1.0 - root3) * y) / std::sqrt(2.0);
}

void Gusts::advance(double airspeed, double dt) {
  if (!(wind_.gust > 0.0)) return;
  const double part = std::min(1.0, dt * std::max(airspeed, kSlowest) / wind_.gust_length);
  const double keep = 1.0 - part, push = std::sqrt(1.0 - keep * keep);
  along_.x = keep * along_.x + push * noise_.normal();
  for (Across* filter : {&across_, &up_}) {
    filter->y += part * (filter->x - filter->y);
    filter->x = keep * filter->x + push * noise_.normal();
  }
  const double speed = wind_.mean.norm();
  const Eigen::Vector2d ahead =
      speed > 0.0 ? Eigen::Vector2d{wind_.mean / speed} : Eigen::Vector2d{1.0, 0.0};
  const double u = along_.x, v = across_.value();
  velocity_E_ =
      wind_.gust * Eigen::Vector3d{ahead.x() * u - ahead.y() * v, ahead.y() * u + ahead.x() * v,
                                   wind_.gust_vertical * up_.value()};
}

}  // namespace gatefly::sim
