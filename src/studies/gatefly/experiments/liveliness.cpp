// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/liveliness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

using Signal = std::vector<Eigen::Vector3d>;

constexpr double kHz = 512.0;
constexpr double kSlowest = 3.0, kFast = 20.0;  // bounds of the band [Hz]

/// Second-order Butterworth low-pass, by the bilinear transform.
class Butterworth {
 public:
  explicit Butterworth(double hz) {
    const double w = std::tan(kPi * hz / kHz), norm = 1.0 / (1.0 + std::sqrt(2.0) * w + w * w);
    b_ = w * w * norm, a1_ = 2.0 * (w * w - 1.0) * norm,
    a2_ = (1.0 - std::sqrt(2.0) * w + w * w) * norm;
  }
  /// As if the first sample had been there for ever.
  void start(const Eigen::Vector3d& x) { x1_ = x2_ = y1_ = y2_ = x; }
  Eigen::Vector3d step(const Eigen::Vector3d& x) {
    const Eigen::Vector3d y = b_ * (x + 2.0 * x1_ + x2_) - a1_ * y1_ - a2_ * y2_;
    x2_ = x1_, x1_ = x, y2_ = y1_, y1_ = y;
    return y;
  }

 private:
  double b_, a1_, a2_;
  Eigen::Vector3d x1_, x2_, y1_, y2_;
};

/// To and fro: no phase.
Signal low_passed(Signal signal, double hz) {
  for (int way = 0; way < 2; ++way) {
    Butterworth filter{hz};
    if (!signal.empty()) filter.start(signal.front());
    for (auto& x : signal) x = filter.step(x);
    std::reverse(signal.begin(), signal.end());
  }
  return signal;
}

template <class Of>
Signal signal_of(const LivelyFlight& flight, const Of& of) {
  Signal signal;
  for (std::size_t i = flight.first; i < flight.last; ++i) signal.push_back(of(i));
  return signal;
}

Eigen::Vector3d deviation(const Signal& a, const Signal& b) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d d = a[i] - b[i];
    sum += d, square += d.cwiseAbs2();
  }
  const auto n = static_cast<double>(a.size());
  return (square / n - (sum / n).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
}

/// Least-squares line y = slope x + offset.
struct Line {
  double slope = 0.0, correlation = 0.0;
};
Line line_through(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i], syy += y[i] * y[i];
  const double vx = sxx / n - sx * sx / n / n, vy = syy / n - sy * sy / n / n,
               c = sxy / n - sx * sy / n / n;
  return {c / vx, c / std::sqrt(vx * vy)};
}

std::vector<double> axis_of(const Signal& signal, int axis) {
  std::vector<double> values;
  for (const auto& x : signal) values.push_back(x[axis]);
  return values;
}

/// The value of a series `delay` ago; times at about 512 Hz.
double delayed(const std::vector<double>& series, std::size_t i, double delay) {
  const double at = static_cast<double>(i) - delay * kHz;
  if (at <= 0.0) return series.front();
  const auto k = static_cast<std::size_t>(at);
  const double s = at - static_cast<double>(k);
  return k + 1 < series.size() ? series[k] + s * (series[k + 1] - series[k]) : series.back();
}

/// Lowest cost by a pattern search in the logarithms, each step half as wide as the last.
template <std::size_t N, class Cost>
std::array<double, N> lowest(std::array<double, N> best, double step, const Cost& cost) {
  double least = cost(best);
  for (; step > 0.005; step *= 0.5) {
    for (bool better = true; better;) {
      better = false;
      for (std::size_t k = 0; k < N; ++k)
        for (const double sign : {-1.0, 1.0}) {
          auto other = best;
          other[k] *= std::exp(sign * step);
          if (const double c = cost(other); c < least) least = c, best = other, better = true;
        }
    }
  }
  return best;
}

/// φ̈ = ω² (set point a delay ago − φ) − 2 ζ ω φ̇, from rest at the first value.
struct Follower {
  double omega, zeta, angle, rate = 0.0;
  double step(double wanted, double dt) {
    rate += dt * (omega * omega * (wanted - angle) - 2.0 * zeta * omega * rate);
    return angle += dt * rate;
  }
};

void add_step(AttitudeResponse& r) {
  Follower follower{r.omega, r.zeta, 0.0};
  constexpr double kDt = 1e-4;
  double most = 0.0;
  for (double t = 0.0; t < 3.0; t += kDt) {
    const double angle = follower.step(1.0, kDt);
    if (r.half == 0.0 && angle >= 0.5) r.half = r.delay + t;
    most = std::max(most, angle);
  }
  r.overshoot = std::max(0.0, most - 1.0);
}

}  // namespace

Vibration vibration_of(const LivelyFlight& flight) {
  const auto bands = [&](const Signal& raw, Eigen::Vector3d& low, Eigen::Vector3d& high) {
    const Signal slow = low_passed(raw, kSlowest), below = low_passed(raw, kFast);
    low = deviation(below, slow), high = deviation(raw, below);
  };
  Vibration v;
  bands(signal_of(flight, [&](std::size_t i) { return flight.samples[i].imu.accel_B; }),
        v.accel_low, v.accel_high);
  bands(signal_of(flight, [&](std::size_t i) { return flight.samples[i].imu.gyro_B; }), v.gyro_low,
        v.gyro_high);
  return v;
}

Drag drag_of(const LivelyFlight& flight, int axis) {
  const Signal v = low_passed(signal_of(flight, [&](std::size_t i) { return flight.v_B(i); }), 3.0);
  const Signal a = low_passed(
      signal_of(flight, [&](std::size_t i) { return flight.samples[i].imu.accel_B; }), 3.0);
  const Line line = line_through(axis_of(v, axis), axis_of(a, axis));
  return {line.slope, line.correlation};
}

AttitudeResponse response_of(const LivelyFlight& flight, int axis) {
  std::vector<double> wanted, got;
  for (std::size_t i = flight.first; i < flight.last; ++i) {
    const LivelySample& s = flight.samples[i];
    wanted.push_back(axis == 0 ? s.wanted.roll : s.wanted.pitch);
    got.push_back(axis == 0 ? s.attitude.roll : s.attitude.pitch);
  }
  // Trim may keep the attitude a little off its set point: what is left may have a mean.
  const auto cost = [&](const std::array<double, 3>& x) {
    Follower follower{x[0], x[1], got.front()};
    double sum = 0, square = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      const double d =
          follower.step(delayed(wanted, i, x[2]), flight.samples[flight.first + i].dt) - got[i];
      sum += d, square += d * d;
    }
    const auto n = static_cast<double>(got.size());
    return square / n - sum * sum / n / n;
  };
  std::array<double, 3> best{};
  double least = std::numeric_limits<double>::infinity();
  for (const double omega : {6.0, 10.0, 16.0})
    for (const double zeta : {0.5, 0.9})
      for (const double delay : {0.01, 0.03}) {
        const auto x = lowest<3>({omega, zeta, delay}, 0.4, cost);
        if (const double c = cost(x); c < least) least = c, best = x;
      }
  AttitudeResponse r{best[0], best[1], best[2], std::sqrt(least)};
  add_step(r);
  return r;
}

RotorResponse rotors_of(const LivelyFlight& flight) {
  const auto cost = [&](const std::array<double, 2>& x) {
    double square = 0;
    for (std::size_t r = 0; r < 4; ++r) {
      std::vector<double> wanted;
      for (std::size_t i = flight.first; i < flight.last; ++i)
        wanted.push_back(flight.samples[i].rotor_wanted[r]);
      double speed = flight.samples[flight.first].rotor[r];
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        const LivelySample& s = flight.samples[flight.first + i];
        speed += (1.0 - std::exp(-s.dt / x[0])) * (delayed(wanted, i, x[1]) - speed);
        square += (speed - s.rotor[r]) * (speed - s.rotor[r]);
      }
    }
    return square;
  };
  const auto x = lowest<2>({0.02, 0.004}, 0.8, cost);
  return {x[0], x[1]};
}

Effectiveness effectiveness_of(const LivelyFlight& flight) {
  constexpr double kBand = 6.0;
  constexpr std::size_t kEnds = 64;  // samples that the filter needs
  const auto filtered = [&](const auto& of) { return low_passed(signal_of(flight, of), kBand); };
  const Signal rate = filtered([&](std::size_t i) { return flight.samples[i].imu.gyro_B; });
  const Signal force = filtered([&](std::size_t i) { return flight.samples[i].imu.accel_B; });
  const Signal push = filtered([&](std::size_t i) {
    const auto& w = flight.samples[i].rotor;
    const double lf = w[0] * w[0], rf = w[1] * w[1], rb = w[2] * w[2], lb = w[3] * w[3];
    return Eigen::Vector3d{lf + lb - rf - rb, lf + rf - lb - rb, 0};
  });
  Effectiveness e;
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double sum = 0, square = 0, n = 0;
    for (std::size_t i = kEnds; i + kEnds < rate.size(); ++i) {
      const double dt = flight.samples[flight.first + i].dt;
      if (!(dt > 0.0)) continue;
      const double turn = (rate[i][axis] - rate[i - 1][axis]) / dt;
      const Eigen::Vector3d row{1e-6 * push[i][axis], force[i][1 - axis], 1.0};
      normal += row * row.transpose(), right += turn * row;
      sum += turn, square += turn * turn, n += 1.0;
    }
    const Eigen::Vector3d fit = normal.ldlt().solve(right);
    e.slope[axis] = 1e-6 * fit.x(), e.air[axis] = fit.y();
    e.explained[axis] = (fit.dot(right) - sum * sum / n) / (square - sum * sum / n);
  }
  return e;
}

std::optional<double> speed_after(const LivelyFlight& flight, double seconds) {
  constexpr double kNoseDown = -2.0 * kDegree;
  std::size_t i = flight.first;
  while (i < flight.last && flight.samples[i].wanted.pitch > kNoseDown) ++i;
  if (i == flight.last) return std::nullopt;
  const double until = flight.samples[i].t + seconds;
  while (i < flight.last && flight.samples[i].t < until) ++i;
  if (i == flight.last) return std::nullopt;
  return flight.v_B(i).x();
}

}  // namespace gatefly::experiments
