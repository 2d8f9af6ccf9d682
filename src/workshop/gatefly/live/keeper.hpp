// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include <sys/types.h>

#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/flight_deck.hpp"

namespace gatefly::live {

/// A second process that brings the drone down when the first dies or hangs: it has the port, too, hears with every set point how
/// things are, and after two periods and a half of silence takes over: braking, then descent, until the drone is disarmed or the
/// pilot takes it back.
///
/// A fork without another program: all that it needs is in its memory. Only one of the two sends: it hangs up before its first frame,
/// and who is hung up on sends no more.
class Keeper {
 public:
  static constexpr std::chrono::nanoseconds kSilence = kStickPeriod * 5 / 2;

  /// @param port  the controller's, which it inherits. Before the first thread is started.
  /// @param witness  a socket that hears of every set point that it sends (SentFrame); -1: nobody.
  /// @throws std::runtime_error one line, when there can be no second process.
  Keeper(int port, const DroneFile& drone, const Acquaintance& known,
         std::chrono::nanoseconds brake, int witness = -1);
  /// It ends without having done anything, unless it has taken over.
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  enum class Heard { kYes, kTookOver, kGone };
  /// With every set point, before it. kTookOver: send no more. kGone: it has died, and there is no second chance.
  [[nodiscard]] Heard tell(const EndingState& ending);
  [[nodiscard]] pid_t process() const { return process_; }

 private:
  pid_t process_ = -1;
  int line_ = -1;
};

}  // namespace gatefly::live
