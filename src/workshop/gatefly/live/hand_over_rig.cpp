// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/hand_over_rig.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/live/channel_watch.hpp"
#include "gatefly/live/flight_deck.hpp"
#include "gatefly/live/keeper.hpp"
#include "gatefly/live/linked.hpp"
#include "gatefly/live/stream_watch.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kSwaps = 500ms;  ///< So often the sticks go the other way.
constexpr double kSpeed =
    1.0;  ///< Forward, that the drone is said to have: braking shows in the sticks [m/s].

/// Sticks that no other channel has, beyond any dead band, and the other way about.
msp::Sticks moved(const DroneFile& drone, int sign) {
  const auto at = [&](int offset) {
    return static_cast<std::uint16_t>(drone.receiver.mid + sign * offset);
  };
  return {.roll = at(100), .pitch = at(-150), .yaw = at(200)};
}

/// The rates of those sticks; over MAVLink thousandths of a rad/s are what is read back.
Eigen::Vector3d test_rates(const DroneFile& drone, int sign) {
  return drone.by_mavlink() ? Eigen::Vector3d{sign * Eigen::Vector3d{0.1, 0.15, 0.2}}
                            : drone.rates.rates(moved(drone, sign));
}

/// Thrust below the weight whose stick is none of the others.
double test_thrust(const DroneFile& drone) {
  constexpr int kApart = 15;  // [µs]
  if (drone.by_mavlink()) return 0.5 * kGravity;
  for (double part = 0.5; part > 0.3; part -= 0.01) {
    const int throttle = drone.sticks(Eigen::Vector3d::Zero(), part * kGravity).throttle;
    bool apart = true;
    for (const int sign : {1, -1}) {
      const msp::Sticks sticks = moved(drone, sign);
      for (const int other : {int{sticks.roll}, int{sticks.pitch}, int{sticks.yaw}})
        apart = apart && std::abs(throttle - other) >= kApart;
    }
    if (apart) return part * kGravity;
  }
  return 0.5 * kGravity;
}

/// State that the threads of the flying process share.
struct Rigged {
  struct Sight {
    nanoseconds picture_at{0}, limit{0};
    bool sees = false;
  };
  Wires wires;
  RunClock clock;
  Ring<nanoseconds> arrivals{64};  ///< camera → pilot
  Latest<Sight> sight;             ///< pilot → who reports
  std::atomic<bool> camera_open = true;
};

void watch_camera(Rigged& rig, std::unique_ptr<Camera> camera) try {
  Picture picture;
  while (!rig.wires.stop && rig.camera_open) {
    const Camera::Got got = camera->next(picture, Clock::now() + 20ms);
    if (got == Camera::Got::kEnded) break;
    if (got == Camera::Got::kPicture && rig.camera_open) (void)rig.arrivals.push(rig.clock.now());
  }
  rig.wires.camera_error = camera->why();
  rig.wires.camera_over = true;
} catch (const std::exception& error) {
  rig.wires.camera_error = error.what();
  rig.wires.camera_over = true;
}

void move_all_sticks(Rigged& rig, const DroneFile& drone) {
  const std::array rates{test_rates(drone, 1), test_rates(drone, -1)};
  const double thrust = test_thrust(drone);
  StreamWatch pictures;
  Rigged::Sight sight;
  while (!rig.wires.stop && !rig.wires.link_over) {
    while (const nanoseconds* const arrived = rig.arrivals.front()) {
      pictures.arrived(*arrived);
      sight = {.picture_at = *arrived, .limit = pictures.gone(), .sees = true};
      rig.arrivals.pop();
    }
    rig.sight.write(sight);
    const nanoseconds now = rig.clock.now();
    Wanted wanted;
    wanted.at = wanted.height_at = now;
    wanted.steers = true;
    wanted.v_E = {kSpeed, 0, 0};
    if (sight.sees) wanted.picture_at = sight.picture_at;
    wanted.picture_limit = pictures.gone();
    wanted.command.attitude.thrust = thrust;
    wanted.command.rates_B = rates[static_cast<std::size_t>(now / kSwaps % 2)];
    rig.wires.wanted.write(wanted);
    std::this_thread::sleep_for(8ms);
  }
}

void tell_trouble(RigNews& news, const std::string& text) {
  std::strncpy(news.trouble.data(), text.c_str(), news.trouble.size() - 1);
}

void tell(int line, const RigNews& news) {
  (void)!send(line, &news, sizeof news, MSG_NOSIGNAL | MSG_DONTWAIT);
}

/// Reports, and takes orders, until the link's thread is over.
void report_and_obey(int line, Rigged& rig, RigNews news,
                     const std::function<bool()>& told_to_end) {
  for (bool last = false; !last;) {
    last = rig.wires.link_over;  // asked before: its last words are in what is read now
    pollfd waiting{line, POLLIN, 0};
    char order = 0;
    if (poll(&waiting, 1, 4) > 0) {
      const ssize_t got = recv(line, &order, 1, MSG_DONTWAIT);
      if (got == 0 || order == 'e') rig.wires.told_to_end = true;
      if (got == 0) std::this_thread::sleep_for(4ms);
      if (order == 'c') rig.camera_open = false;
    }
    if (told_to_end()) rig.wires.told_to_end = true;
    const DeckNews& deck = rig.wires.deck.read();
    const Rigged::Sight& sight = rig.sight.read();
    news.phase = deck.state.phase, news.reason = deck.state.reason, news.action = deck.action;
    news.since = rig.clock.moment(deck.state.since);
    news.picture_at = rig.clock.moment(sight.picture_at);
    news.picture_limit = sight.limit, news.sees = sight.sees;
    if (rig.wires.camera_over && rig.camera_open) tell_trouble(news, rig.wires.camera_error);
    if (last && !rig.wires.link_error.empty()) tell_trouble(news, rig.wires.link_error);
    tell(line, news);
  }
}

/// The process that flies.
void fly_rig(int frames, int line, const Port& port, const DroneFile& drone,
             const Acquaintance& known, const HandOverRig::Plan& plan,
             const std::function<bool()>& told_to_end) {
  RigNews news;
  try {
    LinkCommands link = commands_on(Port{port.fd(), port.name()}, drone, known);
    link.report_to(frames);
    FlightDeck::Params params;
    params.hand_over = plan.limits;
    params.hand_over_tested = true;  // this is the test
    // It lies on a bench, whatever its estimate would be.
    params.fence = {.low = {-1, -1}, .high = {1, 1}, .height = 1};
    FlightDeck deck{params};
    // As in `run`: the second process before anything else is open.
    Keeper keeper{link.fd(), drone, known, params.hand_over.brake, frames};
    news.keeper = keeper.process();
    const auto rig = std::make_unique<Rigged>();
    auto camera = opened(plan.camera, plan.size, true);
    std::thread eye{watch_camera, std::ref(*rig), std::move(camera)};
    std::thread pilot{move_all_sticks, std::ref(*rig), std::cref(drone)};
    std::thread sender{[&] {
      try {
        fly(link, deck, keeper, rig->wires, rig->clock, told_to_end);
      } catch (const std::exception& error) {
        rig->wires.link_error = error.what();
      }
      rig->wires.link_over = true;
    }};
    report_and_obey(line, *rig, news, told_to_end);
    rig->wires.stop = true;
    for (std::thread* const thread : {&sender, &pilot, &eye}) thread->join();
  } catch (const std::exception& error) {
    tell_trouble(news, error.what());
    tell(line, news);
  }
}

/// A socket pair of packets; both ends are closed in programs that are started.
std::array<int, 2> packet_line() {
  std::array<int, 2> ends{-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::runtime_error(std::string{"the process that flies cannot be started: "} +
                             std::strerror(errno));
  return ends;
}

}  // namespace

HandOverRig::HandOverRig(const Port& port, const DroneFile& drone, const Acquaintance& known,
                         const Plan& plan, const std::function<bool()>& told_to_end) {
  // Its second process is ours when the first has been killed: so that we know when it has ended.
  (void)prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
  const std::array frames = packet_line(), talk = packet_line();
  process_ = fork();
  if (process_ == 0) {
    ::close(frames[0]), ::close(talk[0]);
    fly_rig(frames[1], talk[1], port, drone, known, plan, told_to_end);
    _exit(0);
  }
  ::close(frames[1]), ::close(talk[1]);
  frames_ = frames[0], talk_ = talk[0];
  if (process_ < 0)
    throw std::runtime_error(std::string{"the process that flies cannot be started: "} +
                             std::strerror(errno));
}

HandOverRig::~HandOverRig() {
  if (frames_ >= 0) ::close(frames_);
  if (talk_ >= 0) ::close(talk_);
}

void HandOverRig::order(char what) const { (void)!send(talk_, &what, 1, MSG_NOSIGNAL); }

bool HandOverRig::listen(Moment until, const std::function<void(const SentFrame&)>& take) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    std::array<pollfd, 2> waiting{pollfd{frames_, POLLIN, 0}, pollfd{talk_, POLLIN, 0}};
    (void)poll(waiting.data(), waiting.size(), static_cast<int>(std::max<long>(0, left)));
    hear_news();
    if (!hear_frames(take)) {
      hear_news();  // its last words
      if (process_ > 0) (void)waitpid(process_, nullptr, 0);
      if (news_.keeper > 0) (void)waitpid(news_.keeper, nullptr, WNOHANG);
      process_ = -1;
      return false;
    }
    if (Clock::now() >= until || waiting[0].revents != 0) return true;
  }
}

bool HandOverRig::hear_frames(const std::function<void(const SentFrame&)>& take) {
  SentFrame frame;
  for (;;) {
    const ssize_t got = recv(frames_, &frame, sizeof frame, MSG_DONTWAIT);
    if (got == static_cast<ssize_t>(sizeof frame)) {
      take(frame);
      continue;
    }
    return got != 0;
  }
}

void HandOverRig::hear_news() {
  RigNews news;
  while (recv(talk_, &news, sizeof news, MSG_DONTWAIT) == static_cast<ssize_t>(sizeof news))
    news_ = news;
}

void HandOverRig::kill_first() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  (void)waitpid(process_, nullptr, 0);
  process_ = -1;
}

void HandOverRig::kill_both() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  if (news_.keeper > 0) ::kill(news_.keeper, SIGKILL);
  (void)waitpid(process_, nullptr, 0);
  process_ = -1;
}

}  // namespace gatefly::live
