// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/keeper.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gatefly/geometry/seconds.hpp"
#include "gatefly/live/real_time.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr char kDismissed = 'd';

/// The last message that the first process sent.
struct LastWords {
  std::optional<EndingState> ending;  ///< None: nothing was ever sent.
  bool dismissed = false;
};

LastWords listened(int line) {
  LastWords last;
  for (;;) {
    pollfd waiting{line, POLLIN, 0};
    const int limit =
        last.ending && last.ending->in_air
            ? static_cast<int>(
                  std::chrono::ceil<std::chrono::milliseconds>(Keeper::kSilence).count())
            : -1;
    const int ready = poll(&waiting, 1, limit);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return last;
    std::array<std::uint8_t, sizeof(EndingState) + 1> room{};
    const ssize_t got = recv(line, room.data(), room.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return last;
    if (got == 1 && room[0] == kDismissed) {
      last.dismissed = true;
      return last;
    }
    if (got != sizeof(EndingState)) continue;
    EndingState ending;
    std::memcpy(static_cast<void*>(&ending), room.data(), sizeof ending);
    last.ending = ending;
  }
}

/// Brakes, descends, until somebody has the drone, or until `ends`.
void bring_down(LinkCommands& link, EndingState ending, double brake, nanoseconds ends) {
  const RunClock clock;
  double ending_for = ending.ending_for;
  const double period = seconds(kStickPeriod);
  for (nanoseconds next{0}; !link.broken() && next < ends; next += kStickPeriod) {
    const ControllerState& state = link.state();
    const bool knows = clock.now() - state.status_at < 1s;
    if (knows && (!state.armed || !state.override_on)) return;
    if (state.attitude_at >= 0ns)
      ending.roll = state.attitude.roll, ending.pitch = state.attitude.pitch;
    // Before the first answer the last words tell the attitude, but not for long.
    const bool level_known =
        state.attitude_at >= 0ns ? clock.now() - state.attitude_at < 150ms : clock.now() < 100ms;
    const guard::Belief belief{.yaw = ending.yaw,
                               .v_E = {ending.v_x, ending.v_y, ending.v_z},
                               .height_age = guard::Situation::kNever,
                               .stands = ending.stands};
    const bool brakes = level_known && ending_for < brake;
    const AttitudeCommand command = ending.guard.step(
        brakes ? guard::Action::kBrake : guard::Action::kDescend, {}, belief, period);
    ending_for += period;
    // Nothing measures how much speed braking has taken away; it is reckoned.
    const double left = left_after_braking({});
    ending.v_x *= left, ending.v_y *= left;
    const Eigen::Vector3d rates_B = level_known ? rates_towards(command, ending.roll, ending.pitch)
                                                : Eigen::Vector3d::Zero().eval();
    (void)link.send({.rests = false, .rates_B = rates_B, .thrust = command.thrust}, clock);
    while (clock.now() < next + kStickPeriod && !link.broken())
      (void)link.serve(clock, std::min(next + kStickPeriod, clock.now() + 2ms));
  }
}

[[noreturn]] void keep(int line, int port, const DroneFile& drone, const Acquaintance& known,
                       nanoseconds brake, int witness) {
  setsid();  // what a terminal sends is for the first process
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) (void)dup2(nowhere, stream);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
  (void)go_first(Urgency::kKeeper), (void)hold_memory();
  const LastWords last = listened(line);
  if (last.dismissed || !last.ending || !last.ending->in_air) _exit(0);
  ::close(line);
  LinkCommands link = commands_on(Port{port, "keeper"}, drone, known);
  link.report_to(witness);
  const nanoseconds ends = drone.ts002 ? kSimulatorEnds : nanoseconds::max();
  bring_down(link, *last.ending, seconds(brake), ends);
  _exit(0);
}

}  // namespace

Keeper::Keeper(int port, const DroneFile& drone, const Acquaintance& known, nanoseconds brake,
               int witness) {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(std::string{"the second process cannot be started: "} +
                             std::strerror(errno));
  process_ = fork();
  if (process_ == 0) {
    ::close(ends[0]);
    keep(ends[1], port, drone, known, brake, witness);
  }
  ::close(ends[1]);
  line_ = ends[0];
  if (process_ < 0) {
    ::close(line_);
    throw std::runtime_error(std::string{"the second process cannot be started: "} +
                             std::strerror(errno));
  }
}

Keeper::~Keeper() {
  (void)!send(line_, &kDismissed, 1, MSG_NOSIGNAL);
  ::close(line_);
  // One that has taken over brings the drone down, longer than we are there.
  for (int i = 0; i < 50 && waitpid(process_, nullptr, WNOHANG) == 0; ++i)
    std::this_thread::sleep_for(2ms);
}

Keeper::Heard Keeper::tell(const EndingState& ending) {
  const ssize_t sent = send(line_, &ending, sizeof ending, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent == sizeof ending || errno == EAGAIN || errno == EINTR) return Heard::kYes;
  return waitpid(process_, nullptr, WNOHANG) == 0 ? Heard::kTookOver : Heard::kGone;
}

}  // namespace gatefly::live
