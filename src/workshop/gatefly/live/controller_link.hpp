// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <sys/types.h>

#include "gatefly/link/msp_lists.hpp"
#include "gatefly/live/clock.hpp"
#include "gatefly/live/dialect.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/port.hpp"
#include "gatefly/live/uri.hpp"

namespace gatefly::live {

/// A set point that has gone out, and what the controller had said by then: all that a witness needs to know.
struct SentFrame {
  pid_t process = 0;
  Moment at;
  msp::Sticks sent, read;  ///< Read back: what the controller flies by.
  Moment read_at, status_at;
  bool armed = false, override_on = false;
  int acknowledged = 0;
};

/// A controller that is asked, and nothing else: a link of this type has no function that flies.
class LinkQueries {
 public:
  LinkQueries(Port port, std::unique_ptr<Listener> listener);

  /// Asks what is due and takes what comes, until something has come or `until`. @return whether an IMU sample has.
  bool serve(const RunClock& clock, std::chrono::nanoseconds until);
  [[nodiscard]] const ControllerState& state() const { return listener_->state(); }
  [[nodiscard]] bool broken() const { return broken_; }
  [[nodiscard]] const std::string& name() const { return port_.name(); }

 private:
  friend class LinkCommands;
  Port port_;
  std::unique_ptr<Listener> listener_;
  RunClock clock_;  ///< By which the listener's times are measured.
  std::array<std::uint8_t, 2048> room_{};
  bool broken_ = false;
};

/// The same, and it flies.
class LinkCommands : public LinkQueries {
 public:
  /// Both in one, as MspSpeaker is.
  template <class Dialect>
  LinkCommands(Port port, std::unique_ptr<Dialect> dialect)
      : LinkCommands{std::move(port), *dialect, std::move(dialect)} {}
  /// A set point, whole or, where the line does not take it at once, not at all.
  bool send(const Demand& demand, const RunClock& clock);
  [[nodiscard]] int fd() const { return port_.fd(); }
  /// From now on a SentFrame goes there with every set point, if there is room for it. @param line  a socket of packets.
  void report_to(int line) { witness_ = line; }

 private:
  LinkCommands(Port port, Speaker& speaker, std::unique_ptr<Listener> listener);
  void report(const msp::Sticks& sticks) const;

  Speaker* speaker_;
  int witness_ = -1;
};

/// The port that `--link` names; no recording. @throws std::runtime_error one line: nobody is there.
[[nodiscard]] Port opened(const LinkUri& uri);

/// A controller's answers that are needed to decode its messages and are not constants of the drone.
struct Acquaintance {
  msp::BoxIds boxes{};   ///< Betaflight only.
  double imu_hz = 50.0;  ///< At which one that sends by itself is asked for samples.
};

/// A controller that has answered as the drone of the file does.
struct Introduced {
  Port port;
  Acquaintance known;
};
/// It answers, but is not the file's, or not ours alone.
class AnotherDrone : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// @param only_listens  one who never flies may come in flight.
/// @param imu_hz  as often as the pilot's filter expects samples, of a drone that sends them by itself; 0: 50.
/// @throws AnotherDrone one line: another drone or another client; another std::runtime_error: nobody is there, a complaint; armed or
///     overridden.
[[nodiscard]] Introduced introduced(const LinkUri& uri, const DroneFile& drone, bool only_listens,
                                    double imu_hz = 0.0);

/// Links to that controller. @param drone  outlives the link.
[[nodiscard]] LinkQueries queries_on(Port port, const DroneFile& drone, const Acquaintance& known);
[[nodiscard]] LinkCommands commands_on(Port port, const DroneFile& drone,
                                       const Acquaintance& known);

}  // namespace gatefly::live
