// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/monitor.hpp"

#include <cmath>

namespace gatefly::eskf {
namespace {

constexpr double kStamp = 0.005;  // what the stamps of pictures jitter by [s]

// The chi-square number of n degrees of freedom that a normal number of z corresponds to. Wilson and
// Hilferty 1931.
double chi_square_bound(int n, double z) {
  const double k = 2.0 / (9.0 * n);
  const double cube = 1.0 - k + z * std::sqrt(k);
  return n * cube * cube * cube;
}

}  // namespace

void Monitor::looked(double time) { look_before_ = last_look_, last_look_ = time; }

void Monitor::taken(double nis, int rows, double time) {
  unfit_since_.reset();
  refused_ = 0;
  FixedList<One, 64> kept;
  for (const One& one : recent_)
    if (time - one.time < params_.window) (void)kept.push_back(one);
  (void)kept.push_back({time, nis, rows});
  recent_ = kept;
  double sum = 0.0;
  int all = 0;
  for (const One& one : recent_) sum += one.nis, all += one.rows;
  if (!(sum > chi_square_bound(all, params_.bound))) {
    beyond_since_.reset();
    return;
  }
  if (!beyond_since_) beyond_since_ = time;
  if (time - *beyond_since_ >= params_.beyond && !verdict_)
    verdict_ = {Divergence::kInnovations, *beyond_since_};
}

void Monitor::refused(double time) {
  if (!unfit_since_ || time - last_refused_ > params_.pause) {
    const bool between = last_look_ == time && time - look_before_ < params_.between;
    unfit_since_ = between ? look_before_ : time, refused_ = 0;
  }
  last_refused_ = time;
  ++refused_;
  if (refused_ >= params_.least && time - *unfit_since_ > params_.unfit - kStamp && !verdict_)
    verdict_ = {Divergence::kNothingFits, *unfit_since_};
}

const char* text_of(Divergence why) {
  switch (why) {
    case Divergence::kInnovations:
      return "what gates show is farther off than the filter may be (NIS beyond its 99.9 % bound "
             "for 1 s)";
    case Divergence::kNothingFits:
      return "gates were seen for 2 s and none fits where the map has one";
  }
  return "";
}

}  // namespace gatefly::eskf
