// SPDX-License-Identifier: Apache-2.0
#include "gatefly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gatefly/config/pilot_files.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/sensing/sensor_watch.hpp"

#include "microsecond_clock.hpp"

// Marks functions that may not allocate, lock or call the system: clang checks it
// (tools/check_realtime.sh).
#if defined(__clang__) && __clang_major__ >= 20
#define GATEFLY_NONBLOCKING noexcept [[clang::nonblocking]]
#else
#define GATEFLY_NONBLOCKING noexcept
#endif

namespace {

using gatefly::Command;
using gatefly::Imu;
using gatefly::Pilot;
using gatefly::SensorFault;
using gatefly::Sensors;
using gatefly::c_interface::MicrosecondClock;

constexpr std::uint64_t kAlive = 0x67617465666c7931;  // "gatefly1": what is a pilot begins with it
constexpr std::int64_t kMostApart = 1'000'000;        // stamps of one clock, at one time [µs]
constexpr int kStands = 50;                           // refused stamps: 0.1 s of 512 Hz
constexpr std::uint64_t kImuLost = 100'000, kImageLost = 250'000;  // [µs] reliability: F4, F7

/// Stamps of one sensor: each is later than the one before, and of about the IMU's time.
class Order {
 public:
  bool takes(std::uint32_t stamp, const MicrosecondClock& clock) {
    const auto age = clock.age_of(stamp);
    if (age && std::abs(*age) > kMostApart) return false;
    if (last_ && static_cast<std::int32_t>(stamp - *last_) <= 0 && !is_old(clock)) return false;
    last_ = stamp;
    return true;
  }

 private:
  // A clock that was set leaves stamps behind that mean nothing any more.
  [[nodiscard]] bool is_old(const MicrosecondClock& clock) const {
    return std::abs(clock.age_of(*last_).value_or(0)) > kMostApart;
  }
  std::optional<std::uint32_t> last_;
};

gatefly_command as_c(const Command& command) {
  gatefly_command c{};
  c.struct_size = sizeof c;
  c.roll_rad = command.attitude.roll;
  c.pitch_rad = command.attitude.pitch;
  c.yaw_rad = command.attitude.yaw;
  c.yaw_rate_radps = command.attitude.yaw_rate;
  c.thrust_mps2 = command.attitude.thrust;
  std::copy(command.motors.begin(), command.motors.end(), c.motors_radps);
  std::copy_n(command.rates_B.data(), 3, c.rates_radps);
  c.motors_off = std::all_of(command.motors.begin(), command.motors.end(),
                             [](double speed) { return speed == 0.0; });
  return c;
}

/// Structures of callers begin with their size: as much is written as both know. A caller of an older
/// version never has less than the first version's.
template <class Struct>
gatefly_status written(const Struct& from, Struct* to, std::size_t first_version) {
  if (to == nullptr) return GATEFLY_NULL;
  const std::uint32_t size = to->struct_size;
  if (size < first_version) return GATEFLY_WRONG_SIZE;
  std::memcpy(to, &from, std::min<std::size_t>(size, sizeof from));
  to->struct_size = size;
  return GATEFLY_OK;
}

std::string text(const char* c) { return c == nullptr ? std::string{} : std::string{c}; }

std::vector<std::string> texts(const char* const* list, std::uint32_t count) {
  std::vector<std::string> all;
  for (std::uint32_t i = 0; i < count; ++i) all.emplace_back(text(list[i]));
  return all;
}

void say(const char* what, char* error, std::size_t size) {
  if (error == nullptr || size == 0) return;
  const std::string_view words{what};
  error[words.copy(error, size - 1)] = '\0';
}

}  // namespace

/// Everything of one pilot, in the caller's memory but for what Pilot itself allocates.
struct gatefly_pilot {
  explicit gatefly_pilot(const gatefly::config::PilotFiles& files)
      : pilot{files.pilot},
        width{files.stored_width},
        height{files.stored_height},
        rotation{files.stored_rotation_deg},
        period{static_cast<std::uint64_t>(1e6 / files.pilot.imu_hz)} {}

  gatefly_status step(const Imu& imu) GATEFLY_NONBLOCKING;

  std::uint64_t alive = kAlive;
  void* memory = nullptr;  // where it begins, aligned or not ...
  bool allocated = false;  // ... and whether it is ours to free
  Pilot pilot;
  int width, height, rotation;  // of a stored picture
  std::uint64_t period;         // of the IMU, nominal [µs]
  MicrosecondClock clock;
  Order sonar, baro, images, navigation_imu;
  Sensors next;  // what was pushed for the next step
  gatefly_command command = as_c({});
  gatefly_health counts{};
  std::uint64_t time = 0, last_imu = 0, last_image = 0;  // [µs]
  bool clock_refused = false;
};

namespace {

bool is_pilot(const gatefly_pilot* pilot) { return pilot != nullptr && pilot->alive == kAlive; }

gatefly_status as_status(SensorFault fault) {
  if (fault == SensorFault::kNone) return GATEFLY_OK;
  return fault == SensorFault::kNotFinite ? GATEFLY_NOT_FINITE : GATEFLY_OUT_OF_RANGE;
}

Imu imu_of(const double* gyro, const double* accel) {
  return {{gyro[0], gyro[1], gyro[2]}, {accel[0], accel[1], accel[2]}};
}

/// Runs what may not throw across the border; nothing in it does.
template <class Work>
gatefly_status guarded(const gatefly_pilot* pilot, const Work& work) noexcept {
  if (!is_pilot(pilot)) return GATEFLY_NULL;
  try {
    return work();
  } catch (...) {
    return GATEFLY_INTERNAL;
  }
}

gatefly_status push_height(gatefly_pilot& pilot, Order& order, std::uint32_t stamp, double value,
                           SensorFault fault, std::optional<double>& next) {
  gatefly_status status = as_status(fault);
  if (status == GATEFLY_OK && !order.takes(stamp, pilot.clock)) status = GATEFLY_STALE;
  if (status == GATEFLY_OK) next = value;
  ++(status == GATEFLY_OK ? pilot.counts.heights : pilot.counts.heights_refused);
  return status;
}

/// The caller's structure as this version has it; what an older one does not know is 0.
std::optional<gatefly_setup> known(const gatefly_setup& given) {
  gatefly_setup setup{};
  if (given.struct_size < sizeof setup) return std::nullopt;  // there is no older version
  const auto* bytes = reinterpret_cast<const unsigned char*>(&given);
  // A later version's caller may be served where it asks for nothing that is not known here.
  if (given.struct_size > 4096 ||
      std::any_of(bytes + sizeof setup, bytes + given.struct_size, [](auto b) { return b != 0; }))
    return std::nullopt;
  std::memcpy(&setup, &given, sizeof setup);
  return setup;
}

gatefly::config::PilotFiles read(const gatefly_setup& setup) {
  return gatefly::config::read_pilot_files(
      {.track = text(setup.track),
       .track_text = text(setup.track_text),
       .configs = texts(setup.configs, setup.config_count),
       .config_text = text(setup.config_text),
       .settings = texts(setup.settings, setup.setting_count)});
}

bool is_whole(const gatefly_setup& setup) {
  const auto all = [](const char* const* list, std::uint32_t count) {
    return count == 0 || (list != nullptr && std::all_of(list, list + count, [](const char* each) {
                            return each != nullptr;
                          }));
  };
  return all(setup.configs, setup.config_count) && all(setup.settings, setup.setting_count);
}

}  // namespace

gatefly_status gatefly_pilot::step(const Imu& imu) GATEFLY_NONBLOCKING {
  const gatefly_status status = as_status(fault_of(imu));
  next.time = std::chrono::microseconds{time};
  next.imu = imu;
  if (status == GATEFLY_OK || counts.steps == 0) last_imu = time;
  if (next.image || counts.steps == 0) last_image = time;
  counts.imu_not_finite += status == GATEFLY_NOT_FINITE;
  counts.imu_out_of_range += status == GATEFLY_OUT_OF_RANGE;
  counts.images += next.image.has_value();
  ++counts.steps;
  command = as_c(pilot.step(next));
  next = Sensors{};
  return status;
}

uint32_t gatefly_abi(void) { return GATEFLY_ABI; }

const char* gatefly_version(void) { return GATEFLY_VERSION; }

const char* gatefly_status_text(gatefly_status status) {
  switch (status) {
    case GATEFLY_OK:
      return "ok";
    case GATEFLY_NOT_FINITE:
      return "not a finite number";
    case GATEFLY_OUT_OF_RANGE:
      return "out of any sensor's range";
    case GATEFLY_STALE:
      return "the stamp is not later than the last one, or of another time";
    case GATEFLY_WRONG_IMAGE:
      return "not a picture of the camera's size and format";
    case GATEFLY_NULL:
      return "a pointer is NULL, or to no pilot";
    case GATEFLY_WRONG_SIZE:
      return "struct_size is of no known version";
    case GATEFLY_NO_MEMORY:
      return "too little memory";
    case GATEFLY_WRONG_SETUP:
      return "the configuration cannot be flown";
    case GATEFLY_WRONG_ARGUMENT:
      return "an argument is not known";
    case GATEFLY_INTERNAL:
      return "a fault of the library";
  }
  return "no status";
}

size_t gatefly_size(void) { return sizeof(gatefly_pilot) + alignof(gatefly_pilot); }

gatefly_status gatefly_create(void* memory, size_t size, const gatefly_setup* setup,
                              gatefly_pilot** pilot, char* error, size_t error_size) {
  const auto failed = [&](gatefly_status status, const char* why) {
    say(why, error, error_size);
    return status;
  };
  say("", error, error_size);
  if (pilot == nullptr || setup == nullptr) return failed(GATEFLY_NULL, "setup or pilot is NULL");
  *pilot = nullptr;
  const auto whole = known(*setup);
  if (!whole) return failed(GATEFLY_WRONG_SIZE, "setup.struct_size is not sizeof(gatefly_setup)");
  if (!is_whole(*whole)) return failed(GATEFLY_NULL, "a name in setup is NULL");
  if ((whole->track == nullptr) == (whole->track_text == nullptr))
    return failed(GATEFLY_WRONG_SETUP, "setup: one of track and track_text must be given");
  if (memory != nullptr && size < gatefly_size())
    return failed(GATEFLY_NO_MEMORY, "memory has less than gatefly_size() bytes");
  std::unique_ptr<unsigned char[]> own;
  try {
    if (memory == nullptr) {
      size = gatefly_size();
      own.reset(new unsigned char[size]);
      memory = own.get();
    }
    void* const begin = memory;
    void* place = std::align(alignof(gatefly_pilot), sizeof(gatefly_pilot), memory, size);
    auto* made = new (place) gatefly_pilot{read(*whole)};
    made->allocated = own != nullptr;
    made->memory = begin;
    own.release();
    *pilot = made;
    return GATEFLY_OK;
  } catch (const std::bad_alloc&) {
    return failed(GATEFLY_NO_MEMORY, "no memory is left");
  } catch (const std::exception& what) {
    return failed(GATEFLY_WRONG_SETUP, what.what());
  } catch (...) {
    return failed(GATEFLY_INTERNAL, "a fault of the library");
  }
}

void gatefly_destroy(gatefly_pilot* pilot) {
  if (!is_pilot(pilot)) return;
  auto* const own = pilot->allocated ? static_cast<unsigned char*>(pilot->memory) : nullptr;
  pilot->alive = 0;
  pilot->~gatefly_pilot();
  delete[] own;
}

gatefly_status gatefly_step(gatefly_pilot* pilot, uint32_t time_us, const double gyro_radps[3],
                            const double accel_mps2[3], gatefly_command* command) {
  return guarded(pilot, [&]() -> gatefly_status {
    if (gyro_radps == nullptr || accel_mps2 == nullptr || command == nullptr) return GATEFLY_NULL;
    if (command->struct_size < sizeof(gatefly_command)) return GATEFLY_WRONG_SIZE;
    gatefly_pilot& p = *pilot;
    gatefly_status status = GATEFLY_STALE;
    const auto time = p.clock.next(time_us);
    p.clock_refused = !time;
    if (time) {
      p.time = *time;
      status = p.step(imu_of(gyro_radps, accel_mps2));
    } else {
      ++p.counts.imu_stale;
      // A clock that stands: to the pilot its samples are lost, so that it lands.
      if (p.clock.refused_in_a_row() > kStands) {
        p.time = p.clock.pass(p.period);
        constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
        const std::array<double, 3> nothing{kNothing, kNothing, kNothing};
        (void)p.step(imu_of(nothing.data(), nothing.data()));
        --p.counts.imu_not_finite;
      }
    }
    (void)written(p.command, command, sizeof(gatefly_command));
    return status;
  });
}

gatefly_status gatefly_push_navigation_imu(gatefly_pilot* pilot, uint32_t time_us,
                                           const double gyro_radps[3], const double accel_mps2[3]) {
  return guarded(pilot, [&]() -> gatefly_status {
    if (gyro_radps == nullptr || accel_mps2 == nullptr) return GATEFLY_NULL;
    const Imu imu = imu_of(gyro_radps, accel_mps2);
    const gatefly_status status = as_status(fault_of(imu));
    if (status != GATEFLY_OK) return status;
    if (!pilot->navigation_imu.takes(time_us, pilot->clock)) return GATEFLY_STALE;
    pilot->next.navigation_imu = imu;
    return GATEFLY_OK;
  });
}

gatefly_status gatefly_push_sonar(gatefly_pilot* pilot, uint32_t time_us, double range_m) {
  return guarded(pilot, [&]() -> gatefly_status {
    return push_height(*pilot, pilot->sonar, time_us, range_m, gatefly::fault_of_sonar(range_m),
                       pilot->next.sonar);
  });
}

gatefly_status gatefly_push_baro(gatefly_pilot* pilot, uint32_t time_us, double height_m) {
  return guarded(pilot, [&]() -> gatefly_status {
    return push_height(*pilot, pilot->baro, time_us, height_m, gatefly::fault_of_baro(height_m),
                       pilot->next.baro);
  });
}

gatefly_status gatefly_push_image(gatefly_pilot* pilot, uint32_t time_us, gatefly_format format,
                                  uint32_t width, uint32_t height, const uint8_t* bytes,
                                  size_t size) {
  return guarded(pilot, [&]() -> gatefly_status {
    if (bytes == nullptr) return GATEFLY_NULL;
    gatefly::PixelFormat layout{};
    switch (format) {
      case GATEFLY_UYVY:
        layout = gatefly::PixelFormat::kUyvy;
        break;
      case GATEFLY_RGB:
        layout = gatefly::PixelFormat::kRgb;
        break;
      case GATEFLY_YUV444:
        layout = gatefly::PixelFormat::kYuv444;
        break;
      default:
        return GATEFLY_WRONG_ARGUMENT;
    }
    gatefly_pilot& p = *pilot;
    const bool fits = width == static_cast<std::uint32_t>(p.width) &&
                      height == static_cast<std::uint32_t>(p.height) &&
                      size == gatefly::image_bytes(layout, p.width, p.height);
    if (!fits) return ++p.counts.images_refused, GATEFLY_WRONG_IMAGE;
    if (!p.images.takes(time_us, p.clock)) return ++p.counts.images_refused, GATEFLY_STALE;
    p.counts.images_overtaken += p.next.image.has_value();
    p.next.image = gatefly::Image{bytes, layout, p.width, p.height, p.rotation};
    return GATEFLY_OK;
  });
}

gatefly_status gatefly_look_on(gatefly_pilot* pilot, int lifted, const double* motors_radps) {
  return guarded(pilot, [&]() -> gatefly_status {
    std::optional<std::array<double, 4>> motors;
    if (motors_radps != nullptr) {
      motors.emplace();
      std::copy_n(motors_radps, 4, motors->begin());
      if (!std::all_of(motors->begin(), motors->end(), [](double m) { return std::isfinite(m); }))
        return GATEFLY_NOT_FINITE;
    }
    pilot->next.looks_on = true;
    pilot->next.lifted = lifted != 0;
    pilot->next.motors = motors;
    return GATEFLY_OK;
  });
}

gatefly_status gatefly_get_command(const gatefly_pilot* pilot, gatefly_command* command) {
  return guarded(pilot, [&] { return written(pilot->command, command, sizeof(gatefly_command)); });
}

gatefly_status gatefly_get_state(const gatefly_pilot* pilot, gatefly_state* state) {
  return guarded(pilot, [&]() -> gatefly_status {
    const Pilot& p = pilot->pilot;
    const gatefly::Estimate e = p.estimate();
    gatefly_state s{};
    s.phase = static_cast<std::uint32_t>(p.phase().index());
    s.abort_reason = static_cast<std::uint32_t>(p.abort_reason());
    s.finished = p.finished();
    s.gates_passed = static_cast<std::uint32_t>(e.gates_passed);
    s.target_gate = static_cast<std::uint32_t>(p.target_gate());
    s.time_us = pilot->time;
    std::copy_n(e.p_EB.data(), 3, s.position_m);
    std::copy_n(e.v_E.data(), 3, s.velocity_mps);
    s.attitude_rad[0] = e.attitude.roll;
    s.attitude_rad[1] = e.attitude.pitch;
    s.attitude_rad[2] = e.attitude.yaw;
    std::copy_n(e.p_GB.data(), 3, s.gate_position_m);
    for (int i = 0; i < 3; ++i) s.gate_sigma_m[i] = std::sqrt(std::max(0.0, e.covariance_GB(i, i)));
    std::copy_n(e.gyro_bias.data(), 3, s.gyro_bias_radps);
    std::copy_n(e.accel_bias.data(), 3, s.accel_bias_mps2);
    return written(s, state, sizeof s);
  });
}

gatefly_status gatefly_get_health(const gatefly_pilot* pilot, gatefly_health* health) {
  return guarded(pilot, [&]() -> gatefly_status {
    const gatefly_pilot& p = *pilot;
    gatefly_health h = p.counts;
    h.clock_jumps = p.clock.jumps();
    h.clock_wraps = p.clock.wraps();
    h.since_imu_us = p.time - p.last_imu;
    h.since_image_us = p.time - p.last_image;
    const bool flies = gatefly::is_flying(p.pilot.phase());
    const auto problem = [&](bool is, std::uint32_t bit) { h.problems |= is ? bit : 0u; };
    problem(h.since_imu_us >= kImuLost, GATEFLY_PROBLEM_IMU);
    problem(p.clock_refused, GATEFLY_PROBLEM_CLOCK);
    problem(flies && h.since_image_us >= kImageLost, GATEFLY_PROBLEM_IMAGE);
    problem(p.pilot.divergence().has_value(), GATEFLY_PROBLEM_DIVERGED);
    problem(p.pilot.abort_reason() != gatefly::AbortReason::kNone, GATEFLY_PROBLEM_ABORTED);
    return written(h, health, sizeof h);
  });
}
