// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/autopilot/companion.hpp"
#include "gatefly/sim/people.hpp"
#include "gatefly/sim/referee.hpp"
#include "gatefly/sim/stray_passes.hpp"
#include "gatefly/simulated_race/closed_loop/logbook.hpp"
#include "gatefly/simulated_race/closed_loop/sensor_suite.hpp"
#include "gatefly/simulated_race/closed_loop/simulators.hpp"
#include "gatefly/simulated_race/closed_loop/stopwatch.hpp"

namespace gatefly::simulated_race {

/// A flight, whichever simulator it is flown in.
class AnyFlight {
 public:
  AnyFlight() = default;
  virtual ~AnyFlight() = default;
  AnyFlight(const AnyFlight&) = delete;
  AnyFlight& operator=(const AnyFlight&) = delete;

  virtual bool step() = 0;
  virtual bool fall() = 0;
  [[nodiscard]] virtual flight_log::Tick tick() const = 0;
  virtual void stop() = 0;
  [[nodiscard]] virtual bool over() const = 0;
  [[nodiscard]] virtual RaceResult result() = 0;
};

namespace {

constexpr const char* kStopped = "stopped";  // by who looks on
constexpr double kAirborne = 0.15;           // from here on, a contact is a crash [m]
constexpr double kFall = 1.5;                // what is shown of a crash [s]
constexpr double kRunOut = 8.0;  // after the last gate the race is over, landed or not [s]

/// CPU time of this thread: a campaign flies several races at once, each in its own thread.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Body>
flight_log::Truth truth_of(const Body& body) {
  const sim::BodyState& s = body.state();
  return {s.p_EB, s.v_E, attitude_of({sim::R_EB_of(s.q_EB)}), s.wind_E.head<2>(), body.battery_v()};
}

bool is_landing(const Pilot& pilot) {
  return std::holds_alternative<Land>(pilot.phase()) || pilot.landed();
}

/// The body among gates and obstacles, and the referee who watches it.
template <class Simulator>
class Arena {
 public:
  explicit Arena(const RaceConfig& config)
      : simulator{config.sim, config.while_baking},
        referee{config.sim.world, config.sim.vehicle, config.pilot.track.laps},
        stray_passes{config.sim.world},
        steps_{physics_steps(config.sim.sensors.imu_hz)},
        people_{config.sim.world.people},
        drone_radius_{0.5 * config.sim.vehicle.size.head<2>().minCoeff()},
        timeout_{config.timeout} {}

  /// `dt` seconds with these rotor speeds.
  void advance(const std::array<double, 4>& motors, double dt, const Pilot& pilot,
               SensorSuite& sensors, Logbook& book, RaceResult& result) {
    auto& body = simulator.body;
    for (int i = 0; i < steps_; ++i) {
      body.step(motors, dt / steps_);
      sensors.remember(body.state(), body.time());
      book.moved(body.state(), dt / steps_, !referee.finished());
      if (!referee.finished()) stray_passes.update(body.state().p_EB, referee.next());
      if (const auto pass = referee.update(body.state(), body.time())) {
        book.passed(*pass);
        if (referee.finished()) finished_at_ = pass->time;
      }
      airborne_ = airborne_ || -body.state().p_EB.z() > kAirborne;
      auto touched = body.contact();
      if (!touched) touched = touched_by_person();
      if (touched && airborne_ && result.stop_reason.empty()) stop_at(*touched, pilot, result);
    }
  }

  /// `dt` seconds with motors off.
  void fall(double dt, SensorSuite& sensors) {
    for (int i = 0; i < steps_; ++i) {
      simulator.body.step({}, dt / steps_);
      sensors.remember(simulator.body.state(), simulator.body.time());
    }
  }

  /// Bodies know what stands still only.
  [[nodiscard]] std::optional<std::string> touched_by_person() const {
    const auto& body = simulator.body;
    const auto who = sim::touched_person(people_, body.state().p_EB, drone_radius_, body.time());
    if (!who) return std::nullopt;
    return "person " + std::to_string(*who + 1);
  }

  /// Why the race is over now; empty while it goes on.
  [[nodiscard]] std::string verdict(const Pilot& pilot) const {
    const double now = simulator.body.time();
    if (referee.finished() && (pilot.landed() || now > finished_at_ + kRunOut)) return "finished";
    // With its motors off in the air it falls first: on the floor, or onto something else.
    if (pilot.landed() && !referee.finished() && !falls()) return "abort";
    return now > timeout_ ? "timeout" : "";
  }

  Simulator simulator;
  sim::Referee referee;
  sim::StrayPasses stray_passes;

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

  [[nodiscard]] bool falls() const {
    return airborne_ && -simulator.body.state().p_EB.z() > kAirborne;
  }

  int steps_;
  std::vector<world::Person> people_;
  double drone_radius_;
  double timeout_;
  bool airborne_ = false;
  double finished_at_ = -1.0;
};

/// From the pilot to the rotors by way of an autopilot.
class AutopilotLine {
 public:
  explicit AutopilotLine(const RaceConfig& config)
      : companion_{config.sim.autopilot, config.pilot.vehicle.max_speed, config.sim.seed},
        autopilot_{config.sim.autopilot, config.sim.vehicle} {}

  std::array<double, 4> rotors(const Command& command, const Imu& imu, double time, double dt) {
    const AttitudeCommand& attitude = command.attitude;
    const sim::Wish wish{attitude.roll, attitude.pitch, command.rates_B, command.motors[0]};
    return autopilot_.step(companion_.pass_on(wish, time), imu, dt);
  }

 private:
  sim::Companion companion_;
  sim::Autopilot autopilot_;
};

std::optional<AutopilotLine> line_of(const RaceConfig& config) {
  if (config.sim.autopilot.takes == world::AutopilotTruth::Takes::kNone) return std::nullopt;
  return AutopilotLine{config};
}

template <class Simulator>
class FlightIn final : public AnyFlight {
 public:
  explicit FlightIn(const RaceConfig& config) : config_{config} {}

  bool step() override {
    if (over()) return false;
    // The world moves on, the sensors look at it.
    const double dt = suite_.next_interval();
    physics_watch_.time([&] { arena_.advance(rotors_, dt, pilot_, suite_, book_, result_); });
    sensors_ = suite_.read(ticks_++, dt, arena_.simulator, camera_watch_);
    if (config_.sensors) config_.sensors(sensors_);
    looks_ = sensors_.image || sensors_.seen;
    const double now = arena_.simulator.body.time();

    // The pilot thinks, the motors obey.
    const std::uint64_t allocated = config_.allocations ? config_.allocations() : 0;
    Stopwatch& watch = looks_ ? image_watch_ : step_watch_;
    command_ = watch.time([&] { return pilot_.step(sensors_); });
    took_ = watch.latest();
    rotors_ = line_ ? line_->rotors(command_, suite_.own_imu(), now, dt) : command_.motors;
    if (config_.allocations) result_.step_allocations += config_.allocations() - allocated;

    // The books.
    book_.motors(command_, now);
    if (looks_) book_.looked(pilot_, suite_.camera().middle_pose(), arena_.simulator.sight());
    book_.flown(pilot_, arena_.simulator.body.state(), now, !arena_.referee.finished());
    if (result_.stop_reason.empty()) result_.stop_reason = arena_.verdict(pilot_);
    return true;
  }

  bool fall() override {
    if (result_.stop_reason != "crash" || fallen_ >= kFall) return false;
    const double dt = suite_.next_interval();
    arena_.fall(dt, suite_);
    fallen_ += dt;
    sensors_ = suite_.read(ticks_++, dt, arena_.simulator, camera_watch_);
    looks_ = sensors_.image || sensors_.seen;
    command_ = {};
    return true;
  }

  [[nodiscard]] flight_log::Tick tick() const override {
    const auto picture = looks_ ? arena_.simulator.picture() : std::span<const std::uint8_t>{};
    const auto exposed = looks_ ? std::optional{suite_.camera().start()} : std::nullopt;
    const auto next_gate = looks_ ? book_.next_gate() : std::nullopt;
    return {sensors_, command_, pilot_, truth_of(arena_.simulator.body),
            picture,  exposed,  took_,  next_gate};
  }

  void stop() override { result_.stop_reason = kStopped; }
  [[nodiscard]] bool over() const override { return !result_.stop_reason.empty(); }

  [[nodiscard]] RaceResult result() override {
    RaceResult result = result_;
    book_.fill(result);
    result.finished = arena_.referee.finished();
    result.landed = pilot_.landed();
    const eskf::ErrorStateFilter* filter = pilot_.navigator().error_state();
    if (filter != nullptr && filter->has_started()) result.findings = eskf::findings_of(*filter);
    result.truth = truth_of_findings(config_.sim, config_.pilot);
    result.sensor_health = pilot_.health();
    result.divergence = pilot_.divergence();
    result.true_gates = config_.sim.world.gates;
    result.gates_total = arena_.referee.total();
    result.through_false_gates = arena_.stray_passes.through_false_gates();
    result.through_other_gates = arena_.stray_passes.through_other_gates();
    result.bake_seconds = arena_.simulator.bake_seconds();
    result.flight_time = arena_.simulator.body.time() - fallen_;
    if (result.stop_reason == "abort")
      result.abort_reason = pilot_.abort_reason() == AbortReason::kNone
                                ? "landed before the last gate"
                                : text_of(pilot_.abort_reason());
    if (over() && !result.finished && result.stop_reason != kStopped)
      result.why_lost = book_.why_lost(pilot_, result);
    result.cpu_seconds = cpu_seconds() - cpu_start_;
    result.wall_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start_).count();
    result.timings = {step_watch_.result(), image_watch_.result(), camera_watch_.result(),
                      physics_watch_.result()};
    return result;
  }

 private:
  RaceConfig config_;
  Pilot pilot_{config_.pilot};
  Arena<Simulator> arena_{config_};
  SensorSuite suite_{config_.sim};
  std::optional<AutopilotLine> line_ = line_of(config_);
  Logbook book_{config_};
  Stopwatch step_watch_{"pilot_step"}, image_watch_{"pilot_step_with_image"},
      camera_watch_{"camera"}, physics_watch_{"physics"};
  RaceResult result_;  ///< As far as it is known.
  double cpu_start_ = cpu_seconds();
  std::chrono::steady_clock::time_point wall_start_ = std::chrono::steady_clock::now();
  // State after the last tick.
  Sensors sensors_;
  Command command_;
  std::array<double, 4> rotors_{};  ///< [rad/s]
  bool looks_ = false;
  double took_ = 0.0;  ///< By the pilot's step [s].
  std::int64_t ticks_ = 0;
  double fallen_ = 0.0;  ///< After a crash [s].
};

}  // namespace

Flight::Flight(const RaceConfig& config) {
  if (config.vision == Vision::kIdeal)
    flight_ = std::make_unique<FlightIn<IdealSimulator>>(config);
  else
    flight_ = std::make_unique<FlightIn<RenderedSimulator>>(config);
}
Flight::~Flight() = default;

bool Flight::step() { return flight_->step(); }
bool Flight::fall() { return flight_->fall(); }
flight_log::Tick Flight::tick() const { return flight_->tick(); }
void Flight::stop() { flight_->stop(); }
bool Flight::over() const { return flight_->over(); }
RaceResult Flight::result() const { return flight_->result(); }

RaceResult fly(const RaceConfig& config,
               const std::function<bool(const flight_log::Tick&)>& on_tick) {
  Flight flight{config};
  while (flight.step())
    if (on_tick && !on_tick(flight.tick())) flight.stop();
  return flight.result();
}

}  // namespace gatefly::simulated_race
