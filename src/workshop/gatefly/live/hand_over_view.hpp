// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "gatefly/live/channel_watch.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/hand_over_rig.hpp"

namespace gatefly::live {

/// The latest known state of the controller, whoever asked for it.
struct Witnessed {
  bool armed = false, override_on = false;
  msp::Sticks sticks;
  Moment sticks_at, status_at, overridden_at;  ///< The last: status with the override on.
};

/// A hand-over test's view of controller and rig: the rig tells it while one of its processes lives, and it asks itself when none does.
/// Two who ask at once would hang the controller.
class HandOverView {
 public:
  HandOverView(Introduced met, const DroneFile& drone)
      : port_{std::move(met.port)},
        known_{met.known},
        drone_{drone},
        channels_{drone.by_mavlink()} {}

  /// A new rig; there must be none. @throws std::runtime_error one line.
  void begin_flight(const HandOverRig::Plan& plan, const std::function<bool()>& told_to_end);
  /// Looks for about 5 ms.
  void look();

  /// nullptr once the last look() has seen both of its processes gone.
  [[nodiscard]] HandOverRig* rig() { return rig_.get(); }
  /// Last words of the latest rig's first process.
  [[nodiscard]] const RigNews& news() const { return news_; }
  [[nodiscard]] bool flies() const { return news_.phase == guard::Phase::kFlying; }
  /// The last stick frame of the latest rig.
  [[nodiscard]] const std::optional<SentFrame>& last() const { return last_; }
  [[nodiscard]] const Witnessed& told() const { return told_; }
  [[nodiscard]] ChannelWatch& channels() { return channels_; }
  /// Why it cannot go on: link, camera, a rig that ends; "" when it can.
  [[nodiscard]] std::string trouble() const;
  [[nodiscard]] bool link_is_gone() const { return queries_ && queries_->broken(); }
  /// Says whether the end of the rig is part of the test; else it is trouble.
  void let_end(bool may_end) { may_end_ = may_end; }

  [[nodiscard]] long frames() const { return frames_; }
  [[nodiscard]] std::chrono::nanoseconds longest_gap() const { return longest_gap_; }
  /// Between the last frame of a first process and the first one of its second.
  [[nodiscard]] std::chrono::nanoseconds taken_over_after() const { return taken_over_after_; }

 private:
  void heard(const SentFrame& frame);
  void ask();

  Port port_;
  Acquaintance known_;
  const DroneFile& drone_;
  std::unique_ptr<HandOverRig> rig_;
  std::unique_ptr<LinkQueries> queries_;  ///< None while the rig is there.
  RunClock clock_;                        ///< The times of queries_ are measured by it.
  ChannelWatch channels_;
  Witnessed told_;
  RigNews news_;
  std::optional<SentFrame> last_;
  std::chrono::nanoseconds longest_gap_{0}, taken_over_after_{0};
  long frames_ = 0;
  bool may_end_ = false;
};

}  // namespace gatefly::live
