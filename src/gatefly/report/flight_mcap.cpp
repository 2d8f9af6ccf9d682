// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_mcap.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "gatefly/files/base64.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/report/mcap_schemas.hpp"

namespace gatefly::io {
namespace {

using schema::Json;

constexpr double kStatePeriod = 0.04;  // of poses, estimate, control [s]
constexpr std::size_t kImuEvery = 8;   // of 512 samples a second: 64
constexpr std::size_t kPictureEvery = 2;
constexpr int kJpegQuality = 40;
constexpr int kMetre = 3, kRadian = 4, kPixel = 1;  // digits after the point
constexpr std::uint64_t kSecond = 1'000'000'000;

/// A JSON text that grows: ten times as fast as a tree of values, for ten thousand messages.
class Text {
 public:
  explicit Text(std::string& text) : text_{text} { text_.clear(); }
  Text& operator<<(std::string_view piece) {
    text_ += piece;
    return *this;
  }
  Text& operator<<(std::uint64_t value) {
    text_ += std::to_string(value);
    return *this;
  }
  Text& operator<<(int value) {
    text_ += std::to_string(value);
    return *this;
  }
  Text& number(double value, int digits) {
    std::array<char, 400> place{};  // 1e308 has 309 digits
    if (!std::isfinite(value)) return *this << "null";
    const auto end = std::to_chars(place.data(), place.data() + place.size(), value,
                                   std::chars_format::fixed, digits);
    text_.append(place.data(), end.ptr);
    return *this;
  }
  Text& time(std::uint64_t ns) {
    return *this << R"({"sec":)" << ns / kSecond << R"(,"nsec":)" << ns % kSecond << "}";
  }
  Text& members(std::initializer_list<std::string_view> names, std::initializer_list<double> values,
                int digits) {
    *this << "{";
    auto value = values.begin();
    for (const std::string_view name : names) {
      if (value != values.begin()) *this << ",";
      *this << "\"" << name << "\":";
      number(*value++, digits);
    }
    return *this << "}";
  }
  Text& xyz(const Eigen::Vector3d& v, int digits) {
    return members({"x", "y", "z"}, {v.x(), v.y(), v.z()}, digits);
  }
  Text& attitude(const Attitude& a) {
    return members({"roll", "pitch", "yaw"}, {a.roll, a.pitch, a.yaw}, kRadian);
  }
  Text& quaternion(const Quaternion& q) {
    return members({"x", "y", "z", "w"}, {q.x, q.y, q.z, q.w}, kRadian);
  }

 private:
  std::string& text_;
};

/// North, east, down as north, west, up: half a turn about x.
Eigen::Vector3d up(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }
/// The attitude of front, left, up in north, west, up.
Quaternion up(const Attitude& attitude) {
  const Quaternion q = quaternion_of(attitude);
  return {q.w, q.x, -q.y, -q.z};
}

Json xyz(const Eigen::Vector3d& v) {
  const auto rounded = [](double value) { return std::round(1e4 * value) / 1e4; };
  return {{"x", rounded(v.x())}, {"y", rounded(v.y())}, {"z", rounded(v.z())}};
}

/// @param heading  as ours, clockwise from above.
Json pose(const Eigen::Vector3d& p_up, double heading = 0.0) {
  const Quaternion q = up(Attitude{.roll = 0.0, .pitch = 0.0, .yaw = heading});
  return {{"position", xyz(p_up)},
          {"orientation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

Json color(double r, double g, double b, double a = 1.0) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

enum class LineType { kStrip = 0, kLoop = 1 };

Json line(LineType type, const std::vector<Eigen::Vector3d>& points_up, double thickness,
          const Json& its_color) {
  Json points = Json::array();
  for (const Eigen::Vector3d& p : points_up) points.push_back(xyz(p));
  return {{"type", static_cast<int>(type)}, {"pose", pose({0, 0, 0})},     {"thickness", thickness},
          {"scale_invariant", false},       {"points", std::move(points)}, {"color", its_color},
          {"colors", Json::array()},        {"indices", Json::array()}};
}

Json entity(const std::string& id, std::uint64_t time) {
  Json json{{"timestamp", {{"sec", time / kSecond}, {"nsec", time % kSecond}}},
            {"frame_id", "world"},
            {"id", id},
            {"lifetime", {{"sec", 0}, {"nsec", 0}}},
            {"frame_locked", false}};
  for (const char* kind : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"})
    json[kind] = Json::array();
  return json;
}

/// Middle lines of a gate's bars.
std::vector<Eigen::Vector3d> frame_of(const Eigen::Vector3d& p_EG, double yaw, double side) {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector3d& corner : gate_corners_G(side))
    corners.push_back(up(Eigen::Vector3d{p_EG + rotation_z(yaw) * corner}));
  return corners;
}

/// sRGB of a linear albedo, about.
Json shown(const Eigen::Vector3d& albedo) {
  const auto bright = [](double value) { return std::pow(std::clamp(value, 0.0, 1.0), 1 / 2.2); };
  return color(bright(albedo.x()), bright(albedo.y()), bright(albedo.z()));
}

void add_box(Json& entity, const sim::WorldBox& box, const Json& its_color) {
  const Eigen::Vector3d middle{box.center.x(), -box.center.y(), 0.5 * (box.bottom + box.top)};
  Json solid{
      {"pose", pose(middle, box.heading)},
      {"size", xyz({box.size.x(), box.pole ? box.size.x() : box.size.y(), box.top - box.bottom})}};
  if (box.pole) solid["bottom_scale"] = solid["top_scale"] = 1.0;
  solid["color"] = its_color;
  entity[box.pole ? "cylinders" : "cubes"].push_back(std::move(solid));
}

std::vector<Eigen::Vector3d> way(const RacePlan& plan) {
  std::vector<Eigen::Vector3d> points;
  const auto add = [&](const Path& path) {
    const double length = path.length();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / 0.2)));
    for (int i = 0; i <= steps; ++i) {
      const double s = length * i / steps;
      const Eigen::Vector2d at = path.at(s).position;
      points.push_back(up(Eigen::Vector3d{at.x(), at.y(), path.z_at(s)}));
    }
  };
  add(plan.start);
  for (const Path& leg : plan.legs) add(leg);
  return points;
}

const char* name_of(Sighting::Source source) {
  constexpr std::array<const char*, 3> kNames{"none", "corners", "bars"};
  return kNames[static_cast<std::size_t>(source)];
}

const char* name_of(DetectionMethod method) {
  constexpr std::array<const char*, 3> kNames{"snake", "frames", "bars"};
  return kNames[static_cast<std::size_t>(method)];
}

/// Its rotation as a quaternion; the trace of a camera's mount is far from -1.
Quaternion quaternion_of(const Eigen::Matrix3d& R) {
  const double w = 0.5 * std::sqrt(std::max(0.0, 1.0 + R.trace()));
  return {w, (R(2, 1) - R(1, 2)) / (4 * w), (R(0, 2) - R(2, 0)) / (4 * w),
          (R(1, 0) - R(0, 1)) / (4 * w)};
}

void add_transform(Text& text, std::uint64_t time, std::string_view parent, std::string_view child,
                   const Eigen::Vector3d& p, const Quaternion& q) {
  text << R"({"timestamp":)";
  text.time(time) << R"(,"parent_frame_id":")" << parent << R"(","child_frame_id":")" << child
                  << R"(","translation":)";
  text.xyz(p, kMetre) << R"(,"rotation":)";
  text.quaternion(q) << "}";
}

}  // namespace

FlightMcap::FlightMcap(const std::filesystem::path& path, const closed_loop::RaceConfig& race)
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
  if (race.vision != closed_loop::Vision::kRendered) return;
  image_ = channel("/camera/image", "foxglove.CompressedImage", schema::compressed_image());
  annotations_ =
      channel("/camera/annotations", "foxglove.ImageAnnotations", schema::image_annotations());
}

void FlightMcap::record(const Tick& tick) {
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

void FlightMcap::write_scene(const Tick& tick, std::uint64_t time) {
  const sim::World& world = race_.sim.world;
  Json entities = Json::array();
  for (std::size_t i = 0; i < world.gates.size(); ++i) {
    const sim::WorldGate& gate = world.gates[i];
    Json json = entity("gate " + std::to_string(i + 1), time);
    json["lines"].push_back(line(LineType::kLoop,
                                 frame_of(gate.p_EG, gate.yaw_EG, gate.side - gate.bar), gate.bar,
                                 shown(gate.color)));
    json["texts"].push_back({{"pose", pose(up(gate.p_EG) + Eigen::Vector3d{0, 0, 0.7 * gate.side})},
                             {"billboard", true},
                             {"font_size", 0.3},
                             {"scale_invariant", false},
                             {"color", color(0.5, 0.5, 0.5)},
                             {"text", std::to_string(i + 1)}});
    entities.push_back(std::move(json));
  }
  Json map = entity("gates on the pilot's map", time);
  for (const MapGate& gate : race_.pilot.track.gates)
    map["lines"].push_back(line(LineType::kLoop, frame_of(gate.p_EG, gate.yaw_EG, gate.side), 0.01,
                                color(0.5, 0.5, 0.5)));
  entities.push_back(std::move(map));
  Json obstacles = entity("obstacles", time);
  for (const sim::WorldBox& box : world.obstacles)
    add_box(obstacles, box, color(0.6, 0.62, 0.65, 0.8));
  for (const sim::Decoy& decoy : world.decoys) add_box(obstacles, decoy.shape, shown(decoy.color));
  entities.push_back(std::move(obstacles));
  Json plan = entity("planned way", time);
  plan["lines"].push_back(
      line(LineType::kStrip, way(tick.pilot.plan()), 0.03, color(0.3, 0.6, 0.9)));
  entities.push_back(std::move(plan));
  writer_.write(scene_, time,
                Json{{"deletions", Json::array()}, {"entities", std::move(entities)}}.dump());

  // The camera on the drone: its own axes (right, down, forward) in front, left, up.
  const Eigen::Matrix3d turn = Eigen::Vector3d{1, -1, -1}.asDiagonal();
  const sim::CameraTruth& camera = race_.sim.camera;
  Text text{text_};
  text << R"({"transforms":[)";
  add_transform(text, time, "drone", "camera", up(camera.p_BC),
                quaternion_of(Eigen::Matrix3d{turn * camera_mount(camera.tilt_down).matrix}));
  text << "]}";
  writer_.write(fixed_transforms_, time, text_);
}

void FlightMcap::write_state(const Tick& tick, std::uint64_t time) {
  const Truth& truth = tick.truth;
  const Estimate e = tick.pilot.estimate();
  const Quaternion true_q = up(truth.attitude), q = up(e.attitude);
  {
    Text text{text_};
    text << R"({"transforms":[)";
    add_transform(text, time, "world", "drone", up(truth.p_EB), true_q);
    text << ",";
    add_transform(text, time, "world", "estimate", up(e.p_EB), q);
    text << "]}";
    writer_.write(transforms_, time, text_);
  }
  const auto write_pose = [&](McapWriter::Channel channel, const Eigen::Vector3d& p,
                              const Quaternion& turned) {
    Text text{text_};
    text << R"({"timestamp":)";
    text.time(time) << R"(,"frame_id":"world","pose":{"position":)";
    text.xyz(up(p), kMetre) << R"(,"orientation":)";
    text.quaternion(turned) << "}}";
    writer_.write(channel, time, text_);
  };
  write_pose(true_pose_, truth.p_EB, true_q);
  write_pose(estimated_pose_, e.p_EB, q);
  {
    Text text{text_};
    text << R"({"position_m":)";
    text.xyz(truth.p_EB, kMetre) << R"(,"velocity_mps":)";
    text.xyz(truth.v_E, kMetre) << R"(,"attitude_rad":)";
    text.attitude(truth.attitude) << "}";
    writer_.write(truth_, time, text_);
  }
  {
    Text text{text_};
    text << R"({"position_m":)";
    text.xyz(e.p_EB, kMetre) << R"(,"velocity_mps":)";
    text.xyz(e.v_E, kMetre) << R"(,"attitude_rad":)";
    text.attitude(e.attitude) << R"(,"accel_bias_mps2":)";
    text.xyz(e.accel_bias, kMetre) << R"(,"gyro_bias_radps":)";
    text.xyz(e.gyro_bias, 5) << R"(,"sigma_m":)";
    text.xyz(e.covariance_GB.diagonal().cwiseMax(0.0).cwiseSqrt(), kMetre)
        << R"(,"target_gate":)" << tick.pilot.target_gate() << R"(,"gates_passed":)"
        << e.gates_passed << "}";
    writer_.write(estimate_, time, text_);
  }
  const AttitudeCommand& command = tick.command.attitude;
  const auto& motors = tick.command.motors;
  Text text{text_};
  text << R"({"phase":")" << gatefly::name_of(tick.pilot.phase()) << R"(","target_gate":)"
       << tick.pilot.target_gate() << R"(,"attitude_rad":)";
  text.attitude({command.roll, command.pitch, command.yaw}) << R"(,"thrust_mps2":)";
  text.number(command.thrust, kMetre) << R"(,"motors_radps":)";
  text.members({"lf", "rf", "rb", "lb"}, {motors[0], motors[1], motors[2], motors[3]}, 1) << "}";
  writer_.write(control_, time, text_);
}

void FlightMcap::write_imu(const Imu& imu, std::uint64_t time) {
  Text text{text_};
  text << R"({"gyro_radps":)";
  text.xyz(imu.gyro_B, kRadian) << R"(,"accel_mps2":)";
  text.xyz(imu.accel_B, 4) << "}";
  writer_.write(imu_, time, text_);
}

void FlightMcap::write_look(const Tick& tick, std::uint64_t time) {
  const Sighting& sighting = tick.pilot.sighting();
  {
    Text text{text_};
    text << R"({"exposed_s":)";
    text.number(tick.exposed.value_or(1e-9 * static_cast<double>(time)), 6) << R"(,"gates":[)";
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
  if (!tick.sensors.image || looks_++ % kPictureEvery != 0) return;
  {
    Text text{text_};
    text << R"({"timestamp":)";
    text.time(time) << R"(,"frame_id":"camera","format":"jpeg","data":")"
                    << base64(small_jpeg(*tick.sensors.image, kJpegQuality)) << R"("})";
    writer_.write(image_, time, text_);
  }
  Text text{text_};
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

}  // namespace gatefly::io
