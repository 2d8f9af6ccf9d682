// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/simulated_arcs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/sim/drawn.hpp"

namespace gatefly::experiments {
namespace {

constexpr const char* kTrack = "oval-li18";
constexpr const char* kPapers = "li18";  // configuration
constexpr int kEvery = 4;         // ticks of 512 Hz for a sample of the motion: Motive's 120 Hz
constexpr double kSettled = 0.5;  // after the first sighting the estimate has jumped [s]

/// The pilot's way from one gate to the next.
struct PilotTurn {
  double begin = 0.0, end = 0.0;  ///< [s]
  double predicted_speed = 0.0;
  int from_gate = 0, to_gate = 0;
  double seen = -1.0;                                        ///< First fix after it [s].
  std::optional<Eigen::Vector2d> error_before, error_after;  ///< In the frame of the gate after it.
};

struct ArcFlight {
  std::vector<MotionSample> motion;
  std::vector<Eigen::Vector2d> off_plan;  ///< See SimulatedArcs.
  std::vector<double> blind;
  std::vector<PilotTurn> turns;
  std::string end;
};

/// Files that all flights share: read once.
class Races {
 public:
  explicit Races(const ArcFlights& flights) : flights_{flights}, config_{read(flights)} {
    nominal_.vision = simulated_race::Vision::kIdeal;
    nominal_.timeout = config_.sim.timeout, nominal_.pilot = config_.pilot;
    const config::TrackFile file = config::read_track(config::find_track(kTrack), config_.gate);
    nominal_.pilot.track = file.track;
    nominal_.pilot.track.laps = flights.laps;
    nominal_.sim = config::simulator_config(config_, file);
  }
  [[nodiscard]] simulated_race::RaceConfig drawn(std::uint64_t seed) const {
    simulated_race::RaceConfig race = nominal_;
    race.sim = sim::drawn(nominal_.sim, world::randomize_level(flights_.level), seed);
    if (flights_.change) flights_.change(race.sim);
    return race;
  }

 private:
  static config::Config read(const ArcFlights& flights) {
    const std::vector<std::string> names{flights.config};
    return config::load_config(config::config_files(names), flights.settings);
  }
  ArcFlights flights_;
  config::Config config_;
  simulated_race::RaceConfig nominal_;
};

/// In the horizontal frame of a gate: ahead, right.
Eigen::Vector2d beside(const world::WorldGate& gate, const Eigen::Vector3d& p_EB) {
  return (rotation_z(-gate.yaw_EG) * (p_EB - gate.p_EG)).head<2>();
}

/// The plan's way between two gates, and where on it a pilot believes to be.
class PlannedTurn {
 public:
  PlannedTurn(const Pilot& pilot, const simulated_race::RaceConfig& race)
      : gates_{race.pilot.track.gates},
        next_{static_cast<std::size_t>(pilot.target_gate())},
        before_{(next_ + gates_.size() - 1) % gates_.size()} {
    const Path& leg = pilot.plan().legs[before_];
    here_ = leg.at(leg.nearest(pilot.estimate().p_EB.head<2>(), 0.0, leg.length()));
  }
  /// The way has turned to the next gate.
  [[nodiscard]] bool is_over() const {
    return std::abs(wrap_angle(here_.heading - gates_[next_].yaw_EG)) < 1.0 * kDegree;
  }
  /// From where the plan has it to a place, as seen from the gate before: ahead, right [m].
  [[nodiscard]] Eigen::Vector2d off_plan(const Eigen::Vector2d& p_E) const {
    const Eigen::Vector2d off_E = p_E - here_.position;
    return (rotation_z(-gates_[before_].yaw_EG) * Eigen::Vector3d{off_E.x(), off_E.y(), 0.0})
        .head<2>();
  }

 private:
  const std::vector<MapGate>& gates_;
  std::size_t next_, before_;
  PathPoint here_;
};

ArcFlight flown(simulated_race::RaceConfig race, bool hides_gates, const Options& options) {
  ArcFlight flight;
  int tick_number = 0, target_before = 0;
  bool was_turning = false;
  // From a gate to the end of the planned turn behind it.
  int gates_passed = 0;
  std::optional<double> turns_since;
  Eigen::Vector2d error_at_gate = Eigen::Vector2d::Zero();
  // The paper's pilot does not look while it turns; ours is shown nothing.
  if (hides_gates)
    race.sensors = [&](Sensors& sensors) {
      if (turns_since && sensors.seen)
        *sensors.seen = {.gates = {},
                         .image_width = sensors.seen->image_width,
                         .image_height = sensors.seen->image_height};
    };
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  const auto result = simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    const double t = seconds(tick.sensors.time);
    const auto* turning = std::get_if<Turn>(&tick.pilot.phase());
    const int target = tick.pilot.target_gate();
    if (turning != nullptr && !was_turning)
      flight.turns.push_back({.begin = t,
                              .end = t,
                              .predicted_speed = turning->arc.v_F.x(),
                              .from_gate = target_before,
                              .to_gate = target,
                              .error_before = {},
                              .error_after = {}});
    const Eigen::Vector2d error_before = error;
    error = tick.pilot.estimate().p_GB.head<2>() -
            beside(race.sim.world.gates[static_cast<std::size_t>(target)], tick.truth.p_EB);
    if (!flight.turns.empty()) {
      PilotTurn& turn = flight.turns.back();
      if (turning != nullptr) turn.end = t, turn.to_gate = target;
      const bool sees = (tick.sensors.image || tick.sensors.seen) && tick.pilot.sighting().fix;
      if (turning == nullptr && turn.seen < 0.0 && sees && target == turn.to_gate)
        turn.seen = t, turn.error_before = error_before;
      if (turn.seen >= 0.0 && !turn.error_after && t >= turn.seen + kSettled &&
          target == turn.to_gate)
        turn.error_after = error;
    }
    const Eigen::Vector2d p_E = tick.truth.p_EB.head<2>();
    if (tick.pilot.estimate().gates_passed != gates_passed) {
      gates_passed = tick.pilot.estimate().gates_passed, turns_since = t;
      error_at_gate = p_E - tick.pilot.estimate().p_EB.head<2>();
    }
    if (turns_since && !tick.pilot.finished()) {
      const PlannedTurn turn{tick.pilot, race};
      if (turn.is_over()) {
        flight.off_plan.push_back(turn.off_plan(p_E - error_at_gate));
        flight.blind.push_back(t - *turns_since);
        turns_since.reset();
      }
    }
    if (turning == nullptr) target_before = target;
    was_turning = turning != nullptr;
    if (tick_number++ % kEvery == 0)
      flight.motion.push_back({.t = t, .p_E = tick.truth.p_EB, .attitude = tick.truth.attitude});
    return !options.stopped();
  });
  flight.end = result.stop_reason;
  return flight;
}

/// The simulator's knowledge of an arc that belongs to this turn of the pilot's.
SimulatedDetail detail_of(const BlindArc& arc, const PilotTurn& turn, const world::World& world) {
  const auto &from = world.gates[static_cast<std::size_t>(turn.from_gate)],
             &to = world.gates[static_cast<std::size_t>(turn.to_gate)];
  // Lane of the gate before: x ahead, y to the inside.
  BlindArc lane = arc;
  lane.heading = from.yaw_EG;
  SimulatedDetail detail{.predicted_speed = turn.predicted_speed};
  detail.entry_at_gate = lane.in_entry_frame(arc.entry - from.p_EG.head<2>());
  detail.exit_at_gate = lane.in_entry_frame(arc.exit - from.p_EG.head<2>());
  const auto in_lane = [&](const Eigen::Vector2d& of_gate) {
    const Eigen::Vector3d of_E =
        rotation_z(to.yaw_EG) * Eigen::Vector3d{of_gate.x(), of_gate.y(), 0.0};
    return lane.in_entry_frame(of_E.head<2>());
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d unknown = Eigen::Vector2d::Constant(kNan);
  detail.error_before = turn.error_before ? in_lane(*turn.error_before) : unknown;
  detail.error_after = turn.error_after ? in_lane(*turn.error_after) : unknown;
  detail.blind = turn.seen < 0.0 ? kNan : turn.seen - turn.end;
  return detail;
}

}  // namespace

SimulatedArcs simulated_arcs(const ArcFlights& flights, const Options& options) {
  struct Answer {
    HalfCircles found;
    std::vector<BlindArc> by_pilot;
    std::vector<Eigen::Vector2d> off_plan;
    std::vector<double> blind;
    std::string end;
  };
  const Races races{flights};
  std::vector<Answer> answers(static_cast<std::size_t>(flights.flights));
  in_pieces(answers.size(), options, [&](std::size_t i) {
    const std::uint64_t seed = flights.first_seed + i;
    const simulated_race::RaceConfig race = races.drawn(seed);
    const ArcFlight flight = flown(race, flights.config != kPapers, options);
    const std::vector<SmoothSample> motion = smoothed(flight.motion);
    Answer& answer = answers[i];
    answer.end = flight.end, answer.off_plan = flight.off_plan, answer.blind = flight.blind;
    answer.found = find_half_circles(motion);
    for (BlindArc& arc : answer.found.arcs) {
      arc.flight = "seed " + std::to_string(seed);
      for (const PilotTurn& turn : flight.turns) {
        const double common = std::min(arc.end, turn.end) - std::max(arc.begin, turn.begin);
        if (common < 0.5 * arc.duration()) continue;
        arc.detail = detail_of(arc, turn, race.sim.world);
        answer.by_pilot.push_back(
            arc_between(motion, turn.begin, turn.end, arc.heading, arc.right));
        answer.by_pilot.back().flight = arc.flight;
      }
    }
  });
  SimulatedArcs all;
  for (const Answer& answer : answers) {
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(all.arcs, answer.found.arcs), append(all.left_out, answer.found.left_out),
        append(all.by_pilot, answer.by_pilot), append(all.off_plan, answer.off_plan),
        append(all.blind, answer.blind);
    ++all.ends[answer.end];
  }
  return all;
}

}  // namespace gatefly::experiments
