// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/bench.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/guard/axis_check.hpp"
#include "gatefly/link/msp_lists.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr std::array<const char*, 3> kAxes{"front (roll)", "right (pitch)", "down (yaw)"};
constexpr std::array<double, 5> kCountsPerG{256, 512, 1024, 2048, 4096};
constexpr int kEnd = 32760;  ///< Largest count of a sensor before it saturates.

/// A sample of IMU and attitude, and how long it took to be answered.
struct BenchSample {
  msp::RawImu imu;
  msp::Attitude attitude;
  nanoseconds at{0}, took{0};
};

/// Fifty questions a second, one at a time, and what became of them.
class Sampler {
 public:
  Sampler(Port& port, const msp::ChannelOrder* sticks) : port_{port}, order_{sticks} {}

  /// @param on_sample  answers whether it has seen enough.
  template <class OnSample>
  void run(std::chrono::milliseconds limit, OnSample&& on_sample) {
    const RunClock clock;
    nanoseconds next{0}, next_sticks{0};
    while (clock.now() < limit) {
      if (order_ != nullptr && clock.now() >= next_sticks) next_sticks += 25ms, send_sticks();
      const bool late = asked_at_ && clock.now() - *asked_at_ > 100ms;
      if (late) ++lost_, asked_at_.reset();
      if (!asked_at_ && clock.now() >= next)
        next = std::max(next + 20ms, clock.now()), ask(clock.now());
      if (const auto sample = listen(clock); sample && on_sample(*sample)) return;
      if (closed_) return;
    }
  }
  [[nodiscard]] int asked() const { return asked_; }
  [[nodiscard]] int lost() const { return lost_; }
  [[nodiscard]] int sticks_sent() const { return sticks_sent_; }
  [[nodiscard]] int acknowledged() const { return acknowledged_; }
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  static constexpr std::array<std::uint8_t, 2> kIds{102, 108};

  void send_sticks() {
    std::array<std::uint8_t, 32> frame{};
    const std::size_t size = msp::encode_frame({msp::kSetRawRc, order_->set_raw_rc(msp::kNeutral),
                                                msp::Direction::kToController, msp::Version::k1},
                                               frame);
    closed_ = !port_.write({frame.data(), size}, Clock::now() + 20ms) || closed_;
    ++sticks_sent_;
  }
  void ask(nanoseconds now) {
    std::array<std::uint8_t, 32> frame{};
    const std::size_t size = msp::encode_frame(
        {msp::kMultiple, kIds, msp::Direction::kToController, msp::Version::k2}, frame);
    closed_ = !port_.write({frame.data(), size}, Clock::now() + 20ms) || closed_;
    asked_at_ = now;
    ++asked_;
  }
  std::optional<BenchSample> listen(const RunClock& clock) {
    std::array<std::uint8_t, 512> room{};
    const auto got = port_.read(room, Clock::now() + 2ms);
    closed_ = closed_ || !got;
    std::optional<BenchSample> sample;
    stream_.feed(link::Bytes{room}.first(got.value_or(0)), [&](const msp::Frame& frame) {
      acknowledged_ +=
          frame.id == msp::kSetRawRc && frame.direction == msp::Direction::kFromController;
      if (frame.id != msp::kMultiple || !asked_at_) return;
      BenchSample found;
      found.at = clock.now();
      found.took = found.at - *asked_at_;
      int parts = 0;
      (void)msp::each_answer(kIds, frame.payload, [&](std::uint16_t id, link::Bytes payload) {
        if (const auto imu = link::decoded<msp::RawImu>(payload); id == kIds[0] && imu)
          found.imu = *imu, ++parts;
        if (const auto is = link::decoded<msp::Attitude>(payload); id == kIds[1] && is)
          found.attitude = *is, ++parts;
      });
      if (parts == 2) sample = found;
      asked_at_.reset();
    });
    return sample;
  }

  Port& port_;
  const msp::ChannelOrder* order_;
  msp::Stream stream_;
  std::optional<nanoseconds> asked_at_;
  int asked_ = 0, lost_ = 0, sticks_sent_ = 0, acknowledged_ = 0;
  bool closed_ = false;
};

/// "roll 16.4, pitch 0.1": what it says must be within limits, or the line is another one.
Finding finding(bool well, const std::string& is_well, const std::string& is_not) {
  return {well, well ? is_well : is_not};
}

Eigen::Vector3d mean_of(const std::vector<BenchSample>& samples,
                        std::array<std::int16_t, 3> msp::RawImu::*part) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const BenchSample& sample : samples)
    for (std::size_t i = 0; i < 3; ++i) sum[static_cast<Eigen::Index>(i)] += (sample.imu.*part)[i];
  return sum / static_cast<double>(samples.size());
}

bool at_its_end(const std::vector<BenchSample>& samples) {
  return std::any_of(samples.begin(), samples.end(), [](const BenchSample& sample) {
    const auto high = [](std::int16_t count) { return std::abs(int(count)) >= kEnd; };
    return std::any_of(sample.imu.gyro.begin(), sample.imu.gyro.end(), high) ||
           std::any_of(sample.imu.accel.begin(), sample.imu.accel.end(), high);
  });
}

/// Samples that are another than the one before.
std::size_t fresh_ones(const std::vector<BenchSample>& samples) {
  std::size_t fresh = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    fresh += samples[i].imu.gyro != samples[i - 1].imu.gyro ||
             samples[i].imu.accel != samples[i - 1].imu.accel;
  return fresh;
}

std::string list_of(std::initializer_list<int> values) {
  std::string all;
  for (const int value : values) all += (all.empty() ? "" : ", ") + std::to_string(value);
  return "[" + all + "]";
}

}  // namespace

bool all_well(const Findings& findings) {
  return std::all_of(findings.begin(), findings.end(),
                     [](const Finding& each) { return each.well; });
}

Findings of_introduction(const Introduction& said) {
  Findings found;
  if (said.other_client) found.push_back({false, "another program talks to the controller"});
  for (const guard::Complaint complaint : guard::complaints_about(said.facts))
    found.push_back({false, std::string{guard::text_of(complaint)}});
  if (said.board.size() != 4)
    found.push_back({false, "the controller does not say what board it is"});
  if (found.empty())
    found.push_back({true, "Betaflight, board " + files::one_line(said.board) + ", MSP API 1." +
                               std::to_string(said.facts.api->minor) +
                               "; rates, throttle curve, channels and switches are known here"});
  return found;
}

Findings of_rest(Port& port, std::chrono::milliseconds lasts, msp::ImuScale& scale) {
  std::vector<BenchSample> samples;
  Sampler sampler{port, nullptr};
  sampler.run(lasts, [&](const BenchSample& sample) {
    samples.push_back(sample);
    return false;
  });
  const double per_second =
      static_cast<double>(samples.size()) / std::chrono::duration<double>(lasts).count();
  Findings found{
      finding(per_second >= 20, "IMU: " + files::fixed(per_second, 0) + " samples a second",
              "IMU: " + files::fixed(per_second, 0) + " samples a second, must be at least 20")};
  if (samples.size() < 10) return found;
  if (2 * fresh_ones(samples) < samples.size()) {
    found.push_back({false, "IMU: it repeats itself, frozen"});
    return found;
  }
  if (at_its_end(samples)) {
    found.push_back({false, "IMU: saturated, a count is at its end"});
    return found;
  }
  const Eigen::Vector3d accel = mean_of(samples, &msp::RawImu::accel),
                        gyro = mean_of(samples, &msp::RawImu::gyro);
  const double norm = accel.norm(), turning = gyro.norm() / scale.gyro_counts_per_deg_per_s;
  found.push_back(finding(turning < 2.0, "gyro: still at rest",
                          "gyro: at rest it turns by " + files::fixed(turning, 1) +
                              " °/s: hold it still, or calibrate it"));
  if (norm < 20.0) {
    found.push_back({false, "accelerometer: it shows nothing"});
    return found;
  }
  found.push_back(finding(
      accel.z() > 0.95 * norm, "accelerometer: up is up",
      "accelerometer: level, it says that up is (" + files::fixed(accel.x() / norm, 2) + ", " +
          files::fixed(accel.y() / norm, 2) + ", " + files::fixed(accel.z() / norm, 2) +
          ") of front, left, up: put the drone level, or align the board"));
  const double nearest = *std::min_element(
      kCountsPerG.begin(), kCountsPerG.end(),
      [&](double a, double b) { return std::abs(a - norm) < std::abs(b - norm); });
  found.push_back(finding(std::abs(norm - nearest) < 0.05 * nearest,
                          "accelerometer: " + files::fixed(nearest, 0) + " counts are 1 g (" +
                              files::fixed(norm, 0) + " at rest)",
                          "accelerometer: " + files::fixed(norm, 0) +
                              " counts at rest, no scale that is known: calibrate it"));
  scale.accel_counts_per_g = nearest;
  return found;
}

Findings of_turns(Port& port, const msp::ImuScale& scale, std::chrono::milliseconds limit,
                  const std::function<void(const std::string&)>& say) {
  guard::AxisCheck check;
  std::optional<nanoseconds> last;
  nanoseconds said{0};
  Sampler sampler{port, nullptr};
  sampler.run(limit, [&](const BenchSample& sample) {
    const Imu imu = msp::imu_of(sample.imu, scale);
    check.take(imu.gyro_B, msp::attitude_of(sample.attitude),
               last ? seconds(sample.at - *last) : 0.0);
    last = sample.at;
    if (sample.at - said > 1s) {
      said = sample.at;
      std::string left;
      for (int axis = 0; axis < 3; ++axis)
        if (check.verdict(axis) == guard::AxisVerdict::kNotTurned)
          left += (left.empty() ? "" : ", ") + std::string{kAxes[static_cast<std::size_t>(axis)]};
      if (!left.empty()) say(std::string{kTurnPrompt} + left);
      if (left.empty() && !check.all_agree()) return true;
    }
    return check.all_agree();
  });
  Findings found;
  for (int axis = 0; axis < 3; ++axis) {
    const guard::AxisVerdict verdict = check.verdict(axis);
    const auto part = check.scale(axis);
    std::string line = "gyro about " + std::string{kAxes[static_cast<std::size_t>(axis)]} + ": " +
                       std::string{guard::text_of(verdict)};
    if (part) line += " (" + files::fixed(*part, 2) + " of it)";
    found.push_back({verdict == guard::AxisVerdict::kAgrees, line});
  }
  return found;
}

Findings of_link(Port& port, const msp::ChannelOrder& order, std::chrono::milliseconds lasts) {
  std::vector<double> took;
  Sampler sampler{port, &order};
  sampler.run(lasts, [&](const BenchSample& sample) {
    took.push_back(1e3 * seconds(sample.took));
    return false;
  });
  const double per_second =
      static_cast<double>(took.size()) / std::chrono::duration<double>(lasts).count();
  const std::string timing =
      took.empty() ? "no answers"
                   : files::fixed(per_second, 0) +
                         " samples a second beside 40 stick frames, 95 % answered within " +
                         files::fixed(files::nearest_rank(took, 0.95), 1) + " ms, " +
                         std::to_string(sampler.lost()) + " lost";
  const double answered =
      sampler.sticks_sent() > 0 ? double(sampler.acknowledged()) / sampler.sticks_sent() : 0.0;
  return {finding(per_second >= 20 && sampler.lost() * 20 < sampler.asked(), "link: " + timing,
                  "link: too slow: " + timing),
          finding(answered > 0.9, "link: stick frames are acknowledged",
                  "link: of " + std::to_string(sampler.sticks_sent()) + " stick frames " +
                      std::to_string(sampler.acknowledged()) + " were acknowledged")};
}

std::string drone_toml(const Introduction& said, const msp::ImuScale& scale, const Told& told) {
  const msp::RcTuning& t = *said.facts.tuning;
  const msp::RcDeadband& deadband = *said.facts.deadband;
  const msp::RxConfig& receiver = *said.facts.receiver;
  const msp::RxMap& map = *said.facts.map;
  std::string text = std::string{kDroneFileMark} +
                     "; what was told and not read: name, hover_stick_us, exponent, least_v.\n";
  const auto line = [&text](const std::string& key, const std::string& value) {
    text += key + " = " + value + "\n";
  };
  text += "[drone]\n";
  line("name", "\"" + told.name + "\"");
  text += "\n[controller]\n";
  line("firmware", "\"BTFL\"");
  line("board", "\"" + said.board + "\"");
  line("api_minor", std::to_string(said.facts.api->minor));
  text += "\n[imu]\n";
  line("axes", "\"front-left-up\"");
  line("gyro_counts_per_deg_per_s", files::text_of(scale.gyro_counts_per_deg_per_s));
  line("accel_counts_per_g", files::text_of(scale.accel_counts_per_g));
  text += "\n[rates]\n";
  line("type", t.rates_type == 3 ? "\"actual\"" : "\"betaflight\"");
  line("rc_rate", list_of({t.roll_rc_rate, t.pitch_rc_rate, t.yaw_rc_rate}));
  line("super_rate", list_of({t.super_rate[0], t.super_rate[1], t.super_rate[2]}));
  line("expo", list_of({t.roll_expo, t.pitch_expo, t.yaw_expo}));
  line("limit_deg_per_s", list_of({t.rate_limit[0], t.rate_limit[1], t.rate_limit[2]}));
  line("mid_us", std::to_string(receiver.mid));
  line("deadband_us", std::to_string(deadband.roll_and_pitch));
  line("yaw_deadband_us", std::to_string(deadband.yaw));
  text += "\n[throttle]\n";
  line("mid_percent", std::to_string(t.throttle_mid));
  line("expo_percent", std::to_string(t.throttle_expo));
  line("min_check_us", std::to_string(receiver.min_check));
  line("hover_stick_us", std::to_string(told.hover_stick_us));
  line("exponent", files::text_of(told.exponent));
  text += "\n[channels]\n";
  line("place", list_of({map.place[0], map.place[1], map.place[2], map.place[3]}));
  line("override", "[0, 1, 2, 3]");
  text += "\n[battery]\n";
  line("least_v", files::text_of(told.least_v));
  return text;
}

}  // namespace gatefly::live
