// SPDX-License-Identifier: Apache-2.0
#include "gatefly/closed_loop/race.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "gatefly/closed_loop/scorer.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/body.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/sim/referee.hpp"
#include "gatefly/sim/sensors.hpp"
#include "gatefly/sim/twin_body.hpp"

namespace gatefly::closed_loop {
namespace {

constexpr int kSonarEvery = 26;     // IMU ticks: 20 Hz
constexpr int kBaroEvery = 20;      // 25 Hz
constexpr double kAirborne = 0.15;  // from here on, a contact is a crash [m]

/// Of this thread: a campaign flies several races at once, each in a thread of its own.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Attitude attitude_of_body(const sim::BodyState& s) {
  return attitude_of(RotationEB{sim::R_EB_of(s.q_EB)});
}

/// Wall-clock of one stage, for the summary's `timings`; nothing in the race depends on it.
class Stopwatch {
 public:
  explicit Stopwatch(std::string stage) : stage_{std::move(stage)} { samples_.reserve(1 << 17); }
  template <class Work>
  auto time(Work&& work) {
    const auto from = std::chrono::steady_clock::now();
    struct AtEnd {
      Stopwatch* self;
      std::chrono::steady_clock::time_point from;
      ~AtEnd() {
        self->samples_.push_back(
            std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - from)
                .count());
      }
    } at_end{this, from};
    return work();
  }
  [[nodiscard]] StageTime result() {
    if (samples_.empty()) return {stage_};
    std::sort(samples_.begin(), samples_.end());
    const auto at = [&](double q) {
      return static_cast<double>(
          samples_[static_cast<std::size_t>(q * static_cast<double>(samples_.size() - 1))]);
    };
    return {stage_, at(0.5), at(0.99), at(1.0)};
  }

 private:
  std::string stage_;
  std::vector<float> samples_;
};

/// The camera's schedule: frames are exposed at its rate, some are lost, the others arrive later.
class CameraFeed {
 public:
  CameraFeed(const sim::SimConfig& config)
      : truth_{config.sensors},
        span_{config.camera.readout + config.camera.exposure},
        schedule_{config.seed, "camera schedule"} {
    history_.reserve(2048);
  }

  void remember(const sim::BodyState& state, double t) {
    if (history_.size() > 1024) history_.erase(history_.begin(), history_.begin() + 512);
    history_.push_back({t, state.p_EB, state.q_EB});
  }

  /// Exposes when a frame's time has ended; true when a frame arrives at `t`.
  template <class Simulator>
  bool advance(double t, Simulator& simulator, Stopwatch& watch) {
    if (t >= next_start_ + span_ && !pending_) {
      const double jitter = std::abs(schedule_.normal_cut(truth_.latency_jitter));
      const bool lost = schedule_.uniform() < truth_.frame_loss;
      ++frame_;
      if (!lost) {
        watch.time([&] { simulator.expose(frame_, next_start_, history_); });
        start_ = next_start_;
        arrival_ = next_start_ + span_ + truth_.camera_latency + jitter;
        pending_ = true;
      }
      next_start_ += 1.0 / truth_.camera_hz;
    }
    if (!pending_ || t < arrival_) return false;
    pending_ = false;
    return true;
  }

  /// When the delivered frame began its exposure [s].
  [[nodiscard]] double start() const { return start_; }
  /// Pose in the middle of it.
  [[nodiscard]] sim::BodyPose middle_pose() const {
    const auto later = std::lower_bound(history_.begin(), history_.end(), start_ + 0.5 * span_,
                                        [](const sim::BodyPose& p, double t) { return p.t < t; });
    return later == history_.end() ? history_.back() : *later;
  }

 private:
  sim::SensorTruth truth_;
  double span_;
  sim::Stream schedule_;
  std::vector<sim::BodyPose> history_;
  double next_start_ = 0.2, arrival_ = 0.0, start_ = 0.0;
  std::uint32_t frame_ = 0;
  bool pending_ = false;
};

/// Collects what the summary says about the way flown.
struct Logbook {
  std::vector<sim::GatePass> passes;
  double path_since_first = 0.0, path_at_last = 0.0;
  double max_speed = 0.0;
  Eigen::Vector3d error2 = Eigen::Vector3d::Zero();
  int error_count = 0;

  void moved(const sim::BodyState& s, double dt, bool racing) {
    if (!racing || passes.empty()) return;
    path_since_first += s.v_E.norm() * dt;
    max_speed = std::max(max_speed, s.v_E.norm());
  }
};

void fill(RaceResult& result, const Logbook& book, int gates_per_lap, double motors_on) {
  result.gates_passed = static_cast<int>(book.passes.size());
  for (const auto& pass : book.passes) result.gate_offsets.push_back(pass.offset);
  double lap_start = motors_on;
  for (std::size_t i = 0; i < book.passes.size(); ++i)
    if ((i + 1) % static_cast<std::size_t>(gates_per_lap) == 0) {
      result.lap_times.push_back(book.passes[i].time - lap_start);
      lap_start = book.passes[i].time;
    }
  if (!book.passes.empty()) result.race_time = book.passes.back().time - motors_on;
  if (book.passes.size() > 1)
    result.mean_speed = book.path_at_last / (book.passes.back().time - book.passes.front().time);
  result.max_speed = book.max_speed;
  if (book.error_count > 0) result.estimation_rmse = (book.error2 / book.error_count).cwiseSqrt();
}

/// MuJoCo's body, and pictures.
struct RenderedSimulator {
  explicit RenderedSimulator(const sim::SimConfig& config)
      : truth{config.camera},
        renderer{config.world, config.camera,    config.light,
                 config.seed,  config.cache_dir, config.bake_threads},
        body{config} {}

  [[nodiscard]] const sim::Sight& sight() const { return renderer; }
  [[nodiscard]] double bake_seconds() const { return renderer.bake_seconds(); }
  void expose(std::uint32_t frame, double t_start, std::span<const sim::BodyPose> history) {
    renderer.render(frame, t_start, history, bytes);
  }
  void deliver(Sensors& sensors) const {
    sensors.image =
        Image{bytes.data(), PixelFormat::kUyvy, truth.stored_width, truth.stored_height, 90};
  }
  [[nodiscard]] std::span<const std::uint8_t> picture() const { return bytes; }

  sim::CameraTruth truth;
  sim::CameraRenderer renderer;
  sim::Body body;
  std::vector<std::uint8_t> bytes;
};

/// The twin body, and detections without pictures.
struct IdealSimulator {
  explicit IdealSimulator(const sim::SimConfig& config)
      : body{config},
        vision{config.world, config.camera, config.ideal_vision, config.seed, body.sight()},
        width{config.camera.stored_height} {}  // the upright picture's
  IdealSimulator(const IdealSimulator&) = delete;
  IdealSimulator& operator=(const IdealSimulator&) = delete;

  [[nodiscard]] const sim::Sight& sight() const { return body.sight(); }
  [[nodiscard]] double bake_seconds() const { return 0.0; }
  void expose(std::uint32_t, double t_start, std::span<const sim::BodyPose> history) {
    seen = vision.look(t_start, history);
  }
  void deliver(Sensors& sensors) const {
    SeenGates& gates = sensors.seen.emplace();
    gates.image_width = width;
    for (const auto& gate : seen.gates)
      (void)gates.gates.push_back({gate.corners_px, gate.fitness});
    if (seen.lower) gates.open = OpenGate{seen.lower->left_px, seen.lower->right_px, 1.0};
    if (seen.bars) gates.bars = GateBars{seen.bars->left_px, seen.bars->right_px};
  }
  [[nodiscard]] std::span<const std::uint8_t> picture() const { return {}; }

  sim::TwinBody body;
  sim::IdealVision vision;
  int width;
  sim::SeenPicture seen;
};

template <class Simulator>
RaceResult fly_in(const RaceConfig& config, const std::function<bool(const Tick&)>& on_tick) {
  Pilot pilot{config.pilot};
  Simulator simulator{config.sim};
  auto& body = simulator.body;
  sim::Referee referee{config.sim.world, config.sim.vehicle, config.pilot.track.laps};
  sim::ImuModel imu{config.sim.sensors, config.sim.seed};
  sim::SonarModel sonar{config.sim.sensors, config.sim.seed};
  sim::BaroModel baro{config.sim.sensors, config.sim.seed};
  CameraFeed camera{config.sim};
  Scorer scorer{config.sim.world, config.sim.camera};
  ConsistencyWatch consistency{config.sim.world.gates, config.pilot.track};
  Stopwatch step_watch{"pilot_step"}, image_watch{"pilot_step_with_image"}, camera_watch{"camera"},
      physics_watch{"physics"};

  RaceResult result;
  result.gates_total = referee.total();
  result.bake_seconds = simulator.bake_seconds();
  const double cpu_start = cpu_seconds();
  const auto wall_start = std::chrono::steady_clock::now();

  Logbook book;
  std::array<double, 4> motors{};
  bool airborne = false, was_searching = false;
  double motors_on = -1.0, finish_time = -1.0;

  for (std::int64_t tick = 0; result.stop_reason.empty(); ++tick) {
    // The world moves on: two physics steps for each IMU sample.
    const double dt = imu.next_interval();
    physics_watch.time([&] {
      for (int half = 0; half < 2; ++half) {
        body.step(motors, 0.5 * dt);
        camera.remember(body.state(), body.time());
        book.moved(body.state(), 0.5 * dt, !referee.finished());
        if (const auto pass = referee.update(body.state(), body.time())) {
          book.passes.push_back(*pass);
          book.path_at_last = book.path_since_first;
          if (referee.finished()) finish_time = pass->time;
        }
        const auto touched = body.contact();
        airborne = airborne || -body.state().p_EB.z() > kAirborne;
        const bool landing = std::holds_alternative<Land>(pilot.phase()) || pilot.landed();
        if (touched && airborne && result.stop_reason.empty()) {
          if (referee.finished()) {
            result.stop_reason = "finished";
          } else if (landing && *touched == "floor") {
            result.stop_reason = "abort";
          } else {
            result.stop_reason = "crash";
            result.crash_time = body.time();
            result.crash_object = *touched;
          }
        }
      }
    });
    const double now = body.time();

    // The sensors look at it.
    Sensors sensors;
    sensors.time = std::chrono::nanoseconds{std::llround(now * 1e9)};
    sensors.imu = imu.measure(body.state(), dt);
    if (tick % kSonarEvery == 0) sensors.sonar = sonar.measure(body.state(), &simulator.sight());
    if (tick % kBaroEvery == 0) sensors.baro = baro.measure(body.state(), kBaroEvery / 512.0);
    const bool frame = camera.advance(now, simulator, camera_watch);
    if (frame) simulator.deliver(sensors);

    // The pilot thinks, the motors obey.
    const std::uint64_t allocated = config.allocations ? config.allocations() : 0;
    const Command command =
        (frame ? image_watch : step_watch).time([&] { return pilot.step(sensors); });
    if (config.allocations) result.step_allocations += config.allocations() - allocated;
    motors = command.motors;
    if (motors_on < 0.0 && motors[0] > 0.0) motors_on = now;

    // The books.
    if (frame)
      scorer.score(camera.middle_pose(), pilot.sighting(), pilot.target_gate(), simulator.sight());
    const bool searching = std::holds_alternative<Search>(pilot.phase());
    result.searches += searching && !was_searching;
    was_searching = searching;
    const sim::BodyState& s = body.state();
    if (!referee.finished()) consistency.update(belief_of(pilot, frame), s.p_EB, now);
    if (!book.passes.empty() && !referee.finished()) {
      book.error2 += (pilot.estimate().p_EB - s.p_EB).cwiseAbs2();
      ++book.error_count;
    }
    const Tick record{sensors,
                      command,
                      pilot,
                      {s.p_EB, s.v_E, attitude_of_body(s)},
                      frame ? simulator.picture() : std::span<const std::uint8_t>{},
                      frame ? std::optional{camera.start()} : std::nullopt};
    if (on_tick && !on_tick(record)) result.stop_reason = "stopped";
    if (result.stop_reason.empty() && referee.finished() &&
        (pilot.landed() || now > finish_time + 8.0))
      result.stop_reason = "finished";
    if (result.stop_reason.empty() && pilot.landed() && !referee.finished())
      result.stop_reason = "abort";
    if (result.stop_reason.empty() && now > config.timeout) result.stop_reason = "timeout";
  }

  result.finished = referee.finished();
  if (result.stop_reason == "abort")
    result.abort_reason = pilot.abort_reason() == AbortReason::kNone
                              ? "landed before the last gate"
                              : text_of(pilot.abort_reason());
  result.flight_time = body.time();
  fill(result, book, static_cast<int>(config.sim.world.gates.size()), motors_on);
  result.consistency = consistency.result();
  result.frames = scorer.frames();
  result.frames_with_gate = scorer.frames_with_gate();
  result.true_positives = scorer.true_positives();
  result.false_positives = scorer.false_positives();
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
