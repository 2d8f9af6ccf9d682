// SPDX-License-Identifier: Apache-2.0
#include "gatefly/closed_loop/race.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <string>
#include <variant>

#include "gatefly/closed_loop/logbook.hpp"
#include "gatefly/closed_loop/sensor_suite.hpp"
#include "gatefly/closed_loop/simulators.hpp"
#include "gatefly/closed_loop/stopwatch.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/referee.hpp"

namespace gatefly::closed_loop {
namespace {

constexpr double kPhysicsHz = 1024.0;  // the body takes at least so many steps a second
constexpr double kAirborne = 0.15;     // from here on, a contact is a crash [m]
constexpr double kRunOut = 8.0;        // after the last gate the race is over, landed or not [s]

/// Of this thread: a campaign flies several races at once, each in a thread of its own.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Truth truth_of(const sim::BodyState& s) {
  return {s.p_EB, s.v_E, attitude_of({sim::R_EB_of(s.q_EB)})};
}

bool is_landing(const Pilot& pilot) {
  return std::holds_alternative<Land>(pilot.phase()) || pilot.landed();
}

/// The body among gates and obstacles, and the referee who watches it.
template <class Simulator>
class Arena {
 public:
  explicit Arena(const RaceConfig& config)
      : simulator{config.sim},
        referee{config.sim.world, config.sim.vehicle, config.pilot.track.laps},
        steps_{static_cast<int>(std::ceil(kPhysicsHz / config.sim.sensors.imu_hz))},
        timeout_{config.timeout} {}

  /// `dt` seconds with these rotor speeds.
  void advance(const std::array<double, 4>& motors, double dt, const Pilot& pilot,
               SensorSuite& sensors, Logbook& book, RaceResult& result) {
    auto& body = simulator.body;
    for (int i = 0; i < steps_; ++i) {
      body.step(motors, dt / steps_);
      sensors.remember(body.state(), body.time());
      book.moved(body.state(), dt / steps_, !referee.finished());
      if (const auto pass = referee.update(body.state(), body.time())) {
        book.passed(*pass);
        if (referee.finished()) finished_at_ = pass->time;
      }
      airborne_ = airborne_ || -body.state().p_EB.z() > kAirborne;
      const auto touched = body.contact();
      if (touched && airborne_ && result.stop_reason.empty()) stop_at(*touched, pilot, result);
    }
  }

  /// Why the race is over now; empty while it goes on.
  [[nodiscard]] std::string verdict(const Pilot& pilot) const {
    const double now = simulator.body.time();
    if (referee.finished() && (pilot.landed() || now > finished_at_ + kRunOut)) return "finished";
    if (pilot.landed() && !referee.finished()) return "abort";
    return now > timeout_ ? "timeout" : "";
  }

  Simulator simulator;
  sim::Referee referee;

 private:
  void stop_at(const std::string& object, const Pilot& pilot, RaceResult& result) const {
    if (referee.finished()) {
      result.stop_reason = "finished";
      if (object != "floor") result.landing_contact = object;
    } else if (is_landing(pilot) && object == "floor") {
      result.stop_reason = "abort";
    } else {
      result.stop_reason = "crash";
      result.crash_time = simulator.body.time();
      result.crash_object = object;
    }
  }

  int steps_;
  double timeout_;
  bool airborne_ = false;
  double finished_at_ = -1.0;
};

template <class Simulator>
RaceResult fly_in(const RaceConfig& config, const std::function<bool(const Tick&)>& on_tick) {
  Pilot pilot{config.pilot};
  Arena<Simulator> arena{config};
  SensorSuite suite{config.sim};
  Logbook book{config};
  Stopwatch step_watch{"pilot_step"}, image_watch{"pilot_step_with_image"}, camera_watch{"camera"},
      physics_watch{"physics"};
  RaceResult result;
  const double cpu_start = cpu_seconds();
  const auto wall_start = std::chrono::steady_clock::now();
  const sim::BodyState& body = arena.simulator.body.state();

  Command command;
  for (std::int64_t tick = 0; result.stop_reason.empty(); ++tick) {
    // The world moves on, the sensors look at it.
    const double dt = suite.next_interval();
    physics_watch.time([&] { arena.advance(command.motors, dt, pilot, suite, book, result); });
    Sensors sensors = suite.read(tick, dt, arena.simulator, camera_watch);
    if (config.sensors) config.sensors(sensors);
    const bool looks = sensors.image || sensors.seen;
    const double now = arena.simulator.body.time();

    // The pilot thinks, the motors obey.
    const std::uint64_t allocated = config.allocations ? config.allocations() : 0;
    command = (looks ? image_watch : step_watch).time([&] { return pilot.step(sensors); });
    if (config.allocations) result.step_allocations += config.allocations() - allocated;

    // The books.
    book.motors(command, now);
    if (looks) book.looked(pilot, suite.camera().middle_pose(), arena.simulator.sight());
    book.flown(pilot, body, now, !arena.referee.finished());
    const auto picture = looks ? arena.simulator.picture() : std::span<const std::uint8_t>{};
    const auto exposed = looks ? std::optional{suite.camera().start()} : std::nullopt;
    if (on_tick && !on_tick({sensors, command, pilot, truth_of(body), picture, exposed}))
      result.stop_reason = "stopped";
    if (result.stop_reason.empty()) result.stop_reason = arena.verdict(pilot);
  }

  book.fill(result);
  result.finished = arena.referee.finished();
  result.landed = pilot.landed();
  result.gates_total = arena.referee.total();
  result.bake_seconds = arena.simulator.bake_seconds();
  result.flight_time = arena.simulator.body.time();
  if (result.stop_reason == "abort")
    result.abort_reason = pilot.abort_reason() == AbortReason::kNone
                              ? "landed before the last gate"
                              : text_of(pilot.abort_reason());
  result.cpu_seconds = cpu_seconds() - cpu_start;
  result.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  result.timings = {step_watch.result(), image_watch.result(), camera_watch.result(),
                    physics_watch.result()};
  return result;
}

}  // namespace

RaceResult fly(const RaceConfig& config, const std::function<bool(const Tick&)>& on_tick) {
  return config.vision == Vision::kIdeal ? fly_in<IdealSimulator>(config, on_tick)
                                         : fly_in<RenderedSimulator>(config, on_tick);
}

}  // namespace gatefly::closed_loop
