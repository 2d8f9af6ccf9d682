// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/ardupilot_json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace gatefly::ardupilot {
namespace {

constexpr std::uint16_t kMagic16 = 18458, kMagic32 = 29569;
constexpr std::size_t kHeader = 8;

/// Text in fixed room; once something did not fit, or was no number, there is none.
class Line {
 public:
  explicit Line(std::span<char> out) : out_{out} {}

  void text(std::string_view text) {
    if (!good_ || out_.size() - size_ < text.size()) {
      good_ = false;
      return;
    }
    std::copy(text.begin(), text.end(), out_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += text.size();
  }
  /// The shortest decimal that reads back as the same number.
  void number(double value) {
    good_ = good_ && std::isfinite(value);
    if (!good_) return;
    const auto [end, error] = std::to_chars(out_.data() + size_, out_.data() + out_.size(), value);
    good_ = error == std::errc{};
    if (good_) size_ = static_cast<std::size_t>(end - out_.data());
  }
  /// Its reader looks for keys by their text: no blank behind a colon, one behind a comma of a list.
  void list(std::string_view key, std::span<const double> values) {
    text(key);
    for (std::size_t i = 0; i < values.size(); ++i) {
      text(i == 0 ? "[" : ", ");
      number(values[i]);
    }
    text("]");
  }
  void list(std::string_view key, const Eigen::Vector3d& v) {
    list(key, std::span<const double>{v.data(), 3});
  }
  [[nodiscard]] std::size_t size() const { return good_ ? size_ : 0; }

 private:
  std::span<char> out_;
  std::size_t size_ = 0;
  bool good_ = true;
};

}  // namespace

std::optional<Servos> servos_in(Bytes datagram) {
  link::ByteReader in{datagram};
  Servos servos;
  const auto magic = in.take<std::uint16_t>();
  servos.channels = magic == kMagic16 ? 16 : 32;
  if (magic != kMagic16 && magic != kMagic32) return std::nullopt;
  if (datagram.size() != kHeader + 2 * servos.channels) return std::nullopt;
  servos.steps_per_second = in.take<std::uint16_t>();
  servos.frame = in.take<std::uint32_t>();
  for (std::size_t i = 0; i < servos.channels; ++i) servos.pulse_us[i] = in.take<std::uint16_t>();
  return servos;
}

std::size_t encode_state(const State& state, std::span<char> out) {
  const Quaternion& q = state.attitude;
  const std::array quaternion{q.w, q.x, q.y, q.z};
  Line line{out};
  line.text("\n{\"timestamp\":");
  line.number(std::chrono::duration<double>(state.time).count());
  line.list(",\"imu\":{\"gyro\":", state.imu.gyro_B);
  line.list(",\"accel_body\":", state.imu.accel_B);
  line.list("},\"position\":", state.p_EB);
  line.list(",\"quaternion\":", quaternion);
  line.list(",\"velocity\":", state.v_E);
  if (state.range_down) {
    line.text(",\"rng_1\":");
    line.number(*state.range_down);
  }
  line.text("}\n");
  return line.size();
}

std::array<std::uint8_t, 32> encode_receiver(const msp::Sticks& sticks,
                                             const std::array<std::uint16_t, 12>& aux) {
  std::array<std::uint8_t, 32> datagram{};
  link::ByteWriter out{datagram};
  out.put(sticks.roll), out.put(sticks.pitch), out.put(sticks.throttle), out.put(sticks.yaw);
  for (const std::uint16_t pulse : aux) out.put(pulse);
  return datagram;
}

}  // namespace gatefly::ardupilot
