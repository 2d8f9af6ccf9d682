// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "gatefly/sim/detector_statistics.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::sim {

/// Random numbers of one purpose at one moment, whatever was drawn before: by position in a stream.
class Draws {
 public:
  Draws(const Stream& stream, std::uint32_t moment) : stream_{stream}, moment_{moment} {}

  double uniform();  ///< [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal();

 private:
  Stream stream_;
  std::uint32_t moment_, count_ = 0;
};

/// Number of a moment, for Draws; pictures are farther apart.
[[nodiscard]] std::uint32_t moment_of(double t);

/// A random number correlated in time: standard normal, one part of its variance the seed's, one
/// that stays with a thing for some time, the rest new at every moment. It follows from the time
/// alone, not from which pictures came through.
class CorrelatedDraw {
 public:
  /// @param seed_part  standard normal.
  CorrelatedDraw(const Staying& staying, double seed_part, const Stream& stream);

  /// At `t` [s]; in order.
  [[nodiscard]] double normal(double t);
  /// The part of all such numbers that is less: uniform in 0..1.
  [[nodiscard]] double part(double t);

 private:
  double seed_part_, row_share_, new_share_, same_;
  Stream stream_;
  double row_;
  std::uint32_t moment_ = 0;
};

/// Draws for every thing of a kind, each with a stream of its own.
class CorrelatedDraws {
 public:
  /// @param shared  whether the seed's part is the same for all things, else each has its own.
  CorrelatedDraws(std::uint64_t seed, const std::string& name, const Staying& staying, bool shared);

  [[nodiscard]] CorrelatedDraw& of(int which);
  /// Whether something that happens to this part of the things happens now. When it does `surplus`
  /// is how well: uniform in 0..1, best 1.
  [[nodiscard]] bool happens(int which, double rate, double t, double& surplus);

 private:
  std::uint64_t seed_;
  std::string name_;
  Staying staying_;
  bool shared_;
  std::map<int, CorrelatedDraw> draws_;
};

}  // namespace gatefly::sim
