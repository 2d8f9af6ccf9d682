// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <functional>

#include <sys/types.h>

#include "gatefly/guard/hand_over.hpp"
#include "gatefly/live/camera.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/uri.hpp"

namespace gatefly::live {

/// How the flying process of a hand-over test is.
struct RigNews {
  guard::Phase phase = guard::Phase::kStarting;
  guard::Reason reason = guard::Reason::kNone;
  guard::Action action = guard::Action::kSilent;
  Moment since;                               ///< When the phase began.
  Moment picture_at;                          ///< The last one; of a camera that has shown one.
  std::chrono::nanoseconds picture_limit{0};  ///< Age at which they count as gone.
  bool sees = false;                          ///< A picture has come.
  pid_t keeper = -1;                          ///< Its second process.
  std::array<char, 240> trouble{};            ///< With link, camera or second process; "": none.
};

/// The process that flies in a hand-over test, and that can be killed: link, deck, second process and camera are those of
/// `run`; in the pilot's place somebody moves all sticks, each by another amount and the other way every half second, with less
/// thrust than hovering takes.
///
/// It is a fork without another program, so there must be no other thread. Where nobody listens to it any more, it ends as `run`
/// does: it streams a descent until the drone is disarmed or the override is off.
class HandOverRig {
 public:
  struct Plan {
    CameraUri camera;
    StoredSize size;
    guard::HandOverParams limits;
  };
  /// @param port  the controller's, which it inherits: ask nothing there while the rig lives.
  /// @param told_to_end  asked in the other process, too.
  /// @throws std::runtime_error one line, when there can be no process.
  HandOverRig(const Port& port, const DroneFile& drone, const Acquaintance& known, const Plan& plan,
              const std::function<bool()>& told_to_end);
  ~HandOverRig();
  HandOverRig(const HandOverRig&) = delete;
  HandOverRig& operator=(const HandOverRig&) = delete;

  /// Hears what it says until then; each stick frame that it or its second process has sent goes to `take`. @return whether one of
  /// the two is still there.
  bool listen(Moment until, const std::function<void(const SentFrame&)>& take);
  [[nodiscard]] const RigNews& news() const { return news_; }
  [[nodiscard]] pid_t process() const { return process_; }

  void close_camera() { order('c'); }
  void bring_down() { order('e'); }
  /// Kills with -9; the process is dead when this returns.
  void kill_first();
  void kill_both();

 private:
  void order(char what) const;
  bool hear_frames(const std::function<void(const SentFrame&)>& take);
  void hear_news();

  pid_t process_ = -1;
  int frames_ = -1,
      talk_ = -1;  ///< Sockets: frames of both processes; news and orders of the first.
  RigNews news_;
};

}  // namespace gatefly::live
