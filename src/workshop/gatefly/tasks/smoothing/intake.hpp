// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/error_state_filter.hpp"

namespace gatefly::smoothing {

/// All that a filter took in during one flight, in the order in which it was measured.
///
/// A sighting's `slot` is the landmark here, since all gates have states in a smoother.
struct Intake {
  eskf::Setup setup;
  std::vector<eskf::Landmark> landmarks;  ///< The gates of the map, each once.
  std::vector<std::size_t> first_of;      ///< Index on the map of each landmark.
  eskf::Tick start;                       ///< The belief before take-off ...
  Eigen::MatrixXd P_start;                ///< ... and how sure it was, gates left out.
  std::vector<eskf::Tick> ticks;          ///< With what the filter believed at the end of each.
  std::vector<eskf::GateBelief> gates;    ///< Its final belief about each landmark.
};

/// Reads an intake off a filter while it flies: to be called after every step of its pilot.
class IntakeWatch {
 public:
  /// @param picture  whether a picture may have corrected what was before: the memory is read again.
  void update(const eskf::ErrorStateFilter& filter, bool picture);

  [[nodiscard]] bool has_started() const { return started_; }
  [[nodiscard]] const Intake& intake() const { return intake_; }

 private:
  void begin(const eskf::ErrorStateFilter& filter);
  void begin_anew(const eskf::DelayRing& ring, bool picture);
  void read(const eskf::DelayRing& ring, std::size_t from, std::size_t to);
  void note_slots(const eskf::Landmarks& landmarks);

  Intake intake_;
  std::vector<std::size_t> in_slot_;  ///< The landmark of each slot, as of the last step.
  std::size_t first_ = 0,
              newest_ = 0;  ///< In the filter's memory: its beginning, the last one read.
  std::size_t before_ = 0;  ///< Ticks of ours before that beginning.
  bool started_ = false;
};

}  // namespace gatefly::smoothing
