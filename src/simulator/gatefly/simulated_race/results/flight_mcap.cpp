// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/flight_mcap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "gatefly/files/base64.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/simulated_race/results/json_text.hpp"
#include "gatefly/simulated_race/results/mcap_scene.hpp"
#include "gatefly/simulated_race/results/mcap_schemas.hpp"
#include "gatefly/simulated_race/results/z_up.hpp"

namespace gatefly::simulated_race {
namespace {

using schema::Json;

constexpr double kStatePeriod = 0.04;  // of poses, estimate, control [s]
constexpr std::size_t kImuEvery = 8;   // of 512 samples a second: 64
constexpr std::size_t kPictureEvery = 2;
constexpr int kJpegQuality = 40;
constexpr int kMetre = 3, kRadian = 4, kPixel = 1;  // digits after the point

const char* name_of(Sighting::Source source) {
  constexpr std::array<const char*, 3> kNames{"none", "corners", "bars"};
  return kNames[static_cast<std::size_t>(source)];
}

const char* name_of(DetectionMethod method) {
  constexpr std::array<const char*, 4> kNames{"snake", "frames", "bars", "opening"};
  return kNames[static_cast<std::size_t>(method)];
}

/// Its rotation as a quaternion; the trace of a camera's mount is far from -1.
Quaternion quaternion_of(const Eigen::Matrix3d& R) {
  const double w = 0.5 * std::sqrt(std::max(0.0, 1.0 + R.trace()));
  return {w, (R(2, 1) - R(1, 2)) / (4 * w), (R(0, 2) - R(2, 0)) / (4 * w),
          (R(1, 0) - R(0, 1)) / (4 * w)};
}

void add_transform(JsonText& text, std::uint64_t time, std::string_view parent,
                   std::string_view child, const Eigen::Vector3d& p, const Quaternion& q) {
  text << R"({"timestamp":)";
  text.time(time) << R"(,"parent_frame_id":")" << parent << R"(","child_frame_id":")" << child
                  << R"(","translation":)";
  text.xyz(p, kMetre) << R"(,"rotation":)";
  text.quaternion(q) << "}";
}

}  // namespace

FlightMcap::FlightMcap(const std::filesystem::path& path, const RaceConfig& race)
    : writer_{path}, race_{race} {
  const auto channel = [&](const char* topic, const char* name, const Json& json) {
    return writer_.add_channel(topic, name, json.dump());
  };
  transforms_ = channel("/tf", "foxglove.FrameTransforms", schema::frame_transforms());
  fixed_transforms_ = channel("/tf_static", "foxglove.FrameTransforms", schema::frame_transforms());
  true_pose_ = channel("/truth/pose", "foxglove.PoseInFrame", schema::pose_in_frame());
  estimated_pose_ = channel("/estimate/pose", "foxglove.PoseInFrame", schema::pose_in_frame());
  scene_ = channel("/scene", "foxglove.SceneUpdate", schema::scene_update());
  truth_ = channel("/truth", "gatefly.Truth", schema::truth());
  estimate_ = channel("/estimate", "gatefly.Estimate", schema::estimate());
  control_ = channel("/control", "gatefly.Control", schema::control());
  imu_ = channel("/imu", "gatefly.Imu", schema::imu());
  detections_ = channel("/detections", "gatefly.Detections", schema::detections());
  if (race.vision != Vision::kRendered) return;
  image_ = channel("/camera/image", "foxglove.CompressedImage", schema::compressed_image());
  annotations_ =
      channel("/camera/annotations", "foxglove.ImageAnnotations", schema::image_annotations());
}

void FlightMcap::record(const flight_log::Tick& tick) {
  const auto time =
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, tick.sensors.time.count()));
  const double now = 1e-9 * static_cast<double>(time);
  if (ticks_ == 0) write_scene(tick, time);
  if (now >= next_state_) {
    next_state_ = std::max(next_state_ + kStatePeriod, now);
    write_state(tick, time);
  }
  if (ticks_++ % kImuEvery == 0) write_imu(tick.sensors.imu, time);
  if (tick.sensors.image || tick.sensors.seen) write_look(tick, time);
}

void FlightMcap::write_scene(const flight_log::Tick& tick, std::uint64_t time) {
  writer_.write(scene_, time,
                scene_of(race_.sim.world, race_.pilot.track, tick.pilot.plan(), time).dump());

  // The camera on the drone: its own axes (right, down, forward) in front, left, up.
  const Eigen::Matrix3d turn = Eigen::Vector3d{1, -1, -1}.asDiagonal();
  const world::CameraTruth& camera = race_.sim.camera;
  JsonText text{text_};
  text << R"({"transforms":[)";
  add_transform(text, time, "drone", "camera", up(camera.p_BC),
                quaternion_of(Eigen::Matrix3d{turn * camera_mount(camera.tilt_down).matrix}));
  text << "]}";
  writer_.write(fixed_transforms_, time, text_);
}

void FlightMcap::write_state(const flight_log::Tick& tick, std::uint64_t time) {
  const Estimate estimate = tick.pilot.estimate();
  write_transforms(tick.truth, estimate, time);
  write_pose(true_pose_, tick.truth.p_EB, tick.truth.attitude, time);
  write_pose(estimated_pose_, estimate.p_EB, estimate.attitude, time);
  write_truth(tick.truth, time);
  write_estimate(estimate, tick.pilot.target_gate(), time);
  write_control(tick, time);
}

void FlightMcap::write_transforms(const flight_log::Truth& truth, const Estimate& e,
                                  std::uint64_t time) {
  JsonText text{text_};
  text << R"({"transforms":[)";
  add_transform(text, time, "world", "drone", up(truth.p_EB), up(truth.attitude));
  text << ",";
  add_transform(text, time, "world", "estimate", up(e.p_EB), up(e.attitude));
  text << "]}";
  writer_.write(transforms_, time, text_);
}

void FlightMcap::write_pose(flight_log::McapWriter::Channel channel, const Eigen::Vector3d& p_EB,
                            const Attitude& attitude, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"timestamp":)";
  text.time(time) << R"(,"frame_id":"world","pose":{"position":)";
  text.xyz(up(p_EB), kMetre) << R"(,"orientation":)";
  text.quaternion(up(attitude)) << "}}";
  writer_.write(channel, time, text_);
}

void FlightMcap::write_truth(const flight_log::Truth& truth, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"position_m":)";
  text.xyz(truth.p_EB, kMetre) << R"(,"velocity_mps":)";
  text.xyz(truth.v_E, kMetre) << R"(,"attitude_rad":)";
  text.attitude(truth.attitude) << "}";
  writer_.write(truth_, time, text_);
}

void FlightMcap::write_estimate(const Estimate& e, int target_gate, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"position_m":)";
  text.xyz(e.p_EB, kMetre) << R"(,"velocity_mps":)";
  text.xyz(e.v_E, kMetre) << R"(,"attitude_rad":)";
  text.attitude(e.attitude) << R"(,"accel_bias_mps2":)";
  text.xyz(e.accel_bias, kMetre) << R"(,"gyro_bias_radps":)";
  text.xyz(e.gyro_bias, 5) << R"(,"sigma_m":)";
  text.xyz(e.covariance_GB.diagonal().cwiseMax(0.0).cwiseSqrt(), kMetre)
      << R"(,"target_gate":)" << target_gate << R"(,"gates_passed":)" << e.gates_passed << "}";
  writer_.write(estimate_, time, text_);
}

void FlightMcap::write_control(const flight_log::Tick& tick, std::uint64_t time) {
  const AttitudeCommand& command = tick.command.attitude;
  const auto& motors = tick.command.motors;
  JsonText text{text_};
  text << R"({"phase":")" << gatefly::name_of(tick.pilot.phase()) << R"(","target_gate":)"
       << tick.pilot.target_gate() << R"(,"attitude_rad":)";
  text.attitude({command.roll, command.pitch, command.yaw}) << R"(,"thrust_mps2":)";
  text.number(command.thrust, kMetre) << R"(,"motors_radps":)";
  text.members({"lf", "rf", "rb", "lb"}, {motors[0], motors[1], motors[2], motors[3]}, 1) << "}";
  writer_.write(control_, time, text_);
}

void FlightMcap::write_imu(const Imu& imu, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"gyro_radps":)";
  text.xyz(imu.gyro_B, kRadian) << R"(,"accel_mps2":)";
  text.xyz(imu.accel_B, 4) << "}";
  writer_.write(imu_, time, text_);
}

void FlightMcap::write_look(const flight_log::Tick& tick, std::uint64_t time) {
  const Sighting& sighting = tick.pilot.sighting();
  write_detections(sighting, tick.exposed.value_or(1e-9 * static_cast<double>(time)), time);
  if (!tick.sensors.image || looks_++ % kPictureEvery != 0) return;
  write_image(*tick.sensors.image, time);
  write_annotations(sighting, time);
}

void FlightMcap::write_detections(const Sighting& sighting, double exposed, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"exposed_s":)";
  text.number(exposed, 6) << R"(,"gates":[)";
  bool first = true;
  for (const GateDetection& gate : sighting.detections) {
    text << (first ? R"({"corners_px":[)" : R"(,{"corners_px":[)");
    first = false;
    for (std::size_t i = 0; i < gate.corners_px.size(); ++i) {
      text << (i == 0 ? "[" : ",[");
      text.number(gate.corners_px[i].x(), kPixel) << ",";
      text.number(gate.corners_px[i].y(), kPixel) << "]";
    }
    text << R"(],"fitness":)";
    text.number(gate.fitness, 3) << R"(,"method":")" << name_of(gate.method) << R"("})";
  }
  text << R"(],"used":)" << sighting.used << R"(,"source":")" << name_of(sighting.source)
       << R"(","nis":)";
  text.number(sighting.nis, 3) << "}";
  writer_.write(detections_, time, text_);
}

void FlightMcap::write_image(const Image& image, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"timestamp":)";
  text.time(time) << R"(,"frame_id":"camera","format":"jpeg","data":")"
                  << files::base64(files::small_jpeg(image, kJpegQuality)) << R"("})";
  writer_.write(image_, time, text_);
}

void FlightMcap::write_annotations(const Sighting& sighting, std::uint64_t time) {
  JsonText text{text_};
  text << R"({"circles":[],"texts":[],"points":[)";
  for (std::size_t i = 0; i < sighting.detections.size(); ++i) {
    text << (i == 0 ? R"({"timestamp":)" : R"(,{"timestamp":)");
    text.time(time) << R"(,"type":2,"points":[)";  // a closed line
    const Quad& corners = sighting.detections[i].corners_px;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (k > 0) text << ",";
      // Its origin is the corner of the first pixel, ours the pixel's middle.
      text.members({"x", "y"}, {corners[k].x() + 0.5, corners[k].y() + 0.5}, kPixel);
    }
    const bool used = static_cast<int>(i) == sighting.used;
    text << R"(],"outline_color":)"
         << (used ? R"({"r":0.2,"g":1,"b":0.4,"a":1})" : R"({"r":1,"g":0.8,"b":0.2,"a":1})")
         << R"(,"outline_colors":[],"fill_color":{"r":0,"g":0,"b":0,"a":0},"thickness":1})";
  }
  text << "]}";
  writer_.write(annotations_, time, text_);
}

}  // namespace gatefly::simulated_race
