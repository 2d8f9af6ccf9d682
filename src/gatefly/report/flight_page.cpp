// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_page.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <Eigen/Cholesky>

#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kPlaceOfData = "<!--gatefly:flight-->";
constexpr std::size_t kMostRows = 6000;            // two minutes at 50 Hz
constexpr std::size_t kMostLooks = 4000;           // three minutes at 20 Hz
constexpr std::size_t kMostJpegBytes = 1'850'000;  // 2.5 MB as base64
constexpr int kJpegQuality = 45;
constexpr int kLargestSide = 320;  // of a picture in the page [px]

struct Column {
  const char* name;
  double unit;  ///< What one step of the whole numbers is.
};
constexpr double kMilli = 1e-3, kTenth = 1e-4, kHundredth = 1e-5;
constexpr std::array<Column, 41> kNames{{
    {"t_s", kTenth},
    {"x_m", kMilli},
    {"y_m", kMilli},
    {"z_m", kMilli},
    {"est_x_m", kMilli},
    {"est_y_m", kMilli},
    {"est_z_m", kMilli},
    {"vx_mps", kMilli},
    {"vy_mps", kMilli},
    {"vz_mps", kMilli},
    {"est_vx_mps", kMilli},
    {"est_vy_mps", kMilli},
    {"est_vz_mps", kMilli},
    {"roll_rad", kTenth},
    {"pitch_rad", kTenth},
    {"yaw_rad", kTenth},
    {"est_roll_rad", kTenth},
    {"est_pitch_rad", kTenth},
    {"est_yaw_rad", kTenth},
    {"bax_mps2", kTenth},
    {"bay_mps2", kTenth},
    {"baz_mps2", kTenth},
    {"bgx_radps", kHundredth},
    {"bgy_radps", kHundredth},
    {"bgz_radps", kHundredth},
    // In the frame of the target gate, where the filter lives: truth less estimate, and the
    // lower Cholesky factor of the covariance by rows.
    {"error_x_m", kMilli},
    {"error_y_m", kMilli},
    {"error_z_m", kMilli},
    {"l_xx_m", kTenth},
    {"l_yx_m", kTenth},
    {"l_yy_m", kTenth},
    {"l_zx_m", kTenth},
    {"l_zy_m", kTenth},
    {"l_zz_m", kTenth},
    {"cmd_roll_rad", kTenth},
    {"cmd_pitch_rad", kTenth},
    {"cmd_yaw_rad", kTenth},
    {"cmd_thrust_mps2", kMilli},
    {"phase", 1.0},
    {"target_gate", 1.0},
    {"gates_passed", 1.0},
}};

/// Rounded for a page: millimetres, tenths of pixels.
Json rounded(double value, double unit = kMilli) {
  return number(std::round(value / unit) / std::round(1.0 / unit));
}

Json place(const Eigen::Vector3d& p) {
  return Json::array({rounded(p.x()), rounded(p.y()), rounded(p.z())});
}

template <class Points>
Json pixels(const Points& points) {
  Json json = Json::array();
  for (const Eigen::Vector2d& p : points) {
    json.push_back(rounded(p.x(), 0.1));
    json.push_back(rounded(p.y(), 0.1));
  }
  return json;
}

Json box(const sim::WorldBox& b) {
  return {{"center", {rounded(b.center.x()), rounded(b.center.y())}},
          {"size", {rounded(b.size.x()), rounded(b.size.y())}},
          {"heading", rounded(b.heading)},
          {"bottom", rounded(b.bottom)},
          {"top", rounded(b.top)},
          {"pole", b.pole}};
}

Json way(const Path& path) {
  Json json = Json::array();
  const double length = path.length();
  const int steps = std::max(1, static_cast<int>(std::ceil(length / 0.15)));
  for (int i = 0; i <= steps; ++i) {
    const double s = length * i / steps;
    const Eigen::Vector2d at = path.at(s).position;
    json.push_back(place({at.x(), at.y(), path.z_at(s)}));
  }
  return json;
}

const char* name_of(Sighting::Source source) {
  switch (source) {
    case Sighting::Source::kCorners:
      return "corners";
    case Sighting::Source::kBars:
      return "bars";
    case Sighting::Source::kNone:
      break;
  }
  return "none";
}

Json phase_names() {
  return Json::array({gatefly::name_of(OnGround{}), gatefly::name_of(TakeOff{}),
                      gatefly::name_of(Straight{}), gatefly::name_of(Turn{}),
                      gatefly::name_of(Search{}), gatefly::name_of(Land{}),
                      gatefly::name_of(Landed{})});
}

/// JSON that may stand inside a script element: nothing in it can end the element.
std::string in_a_script(const Json& json) {
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63U];
  }
  return text;
}

double speed_of(const Eigen::Vector3d& v) { return v.norm(); }

}  // namespace

std::string shipped_page() {
  const std::filesystem::path path = shipped_dir() / "viewer" / "report.html";
  std::string page = read_file(path);
  if (page.find(kPlaceOfData) == std::string::npos)
    throw std::runtime_error(path.string() + ": is not the page that a flight is put into");
  return page;
}

FlightPage::FlightPage(std::string page, const closed_loop::RaceConfig& race, bool pictures)
    : page_{std::move(page)}, race_{race}, pictures_wanted_{pictures} {
  rows_.reserve(kMostRows);
}

void FlightPage::record(const Tick& tick) {
  const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
  if (!plan_) plan_ = tick.pilot.plan();
  follow_truth(tick.truth, now);
  if (tick.sensors.image || tick.sensors.seen) look(tick, now);
  last_ = row_of(tick, now);
  if (now < next_row_) return;
  next_row_ = std::max(next_row_ + row_period_, now);
  rows_.push_back(last_);
  if (rows_.size() < kMostRows) return;
  for (std::size_t i = 0; 2 * i < rows_.size(); ++i) rows_[i] = rows_[2 * i];
  rows_.resize((rows_.size() + 1) / 2);
  row_period_ *= 2.0;
}

FlightPage::Row FlightPage::row_of(const Tick& tick, double now) const {
  const Estimate e = tick.pilot.estimate();
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  const auto target = static_cast<std::size_t>(tick.pilot.target_gate());
  if (target < race_.sim.world.gates.size()) {
    const sim::WorldGate& gate = race_.sim.world.gates[target];
    error = rotation_z(-gate.yaw_EG) * (tick.truth.p_EB - gate.p_EG) - e.p_GB;
  }
  const Eigen::Matrix3d l = e.covariance_GB.llt().matrixL();

  Row row{};
  std::size_t next = 0;
  const auto put = [&](double value) {
    const double steps = value / kNames[next].unit;
    row[next++] = std::isfinite(steps) ? std::llround(std::clamp(steps, -1e12, 1e12)) : 0;
  };
  const auto put_vector = [&](const Eigen::Vector3d& v) {
    for (const double value : v) put(value);
  };
  const auto put_attitude = [&](const Attitude& a) { put_vector({a.roll, a.pitch, a.yaw}); };
  put(now);
  put_vector(tick.truth.p_EB);
  put_vector(e.p_EB);
  put_vector(tick.truth.v_E);
  put_vector(e.v_E);
  put_attitude(tick.truth.attitude);
  put_attitude(e.attitude);
  put_vector(e.accel_bias);
  put_vector(e.gyro_bias);
  put_vector(error);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) put(l(r, c));
  const AttitudeCommand& command = tick.command.attitude;
  put_vector({command.roll, command.pitch, command.yaw});
  put(command.thrust);
  put(static_cast<double>(tick.pilot.phase().index()));
  put(tick.pilot.target_gate());
  put(e.gates_passed);
  return row;
}

void FlightPage::follow_truth(const Truth& truth, double now) {
  const auto& gates = race_.sim.world.gates;
  if (before_ && !gates.empty()) {
    const sim::WorldGate& gate = gates[passes_.size() % gates.size()];
    const Eigen::Matrix3d to_gate = rotation_z(-gate.yaw_EG);
    const Eigen::Vector3d from = to_gate * (before_->p_EB - gate.p_EG),
                          to = to_gate * (truth.p_EB - gate.p_EG);
    if (from.x() < 0.0 && to.x() >= 0.0 && to.tail<2>().cwiseAbs().maxCoeff() < 0.5 * gate.side) {
      const double part = from.x() / (from.x() - to.x());
      passes_.push_back({before_time_ + part * (now - before_time_), speed_of(truth.v_E)});
    }
  }
  before_ = truth;
  before_time_ = now;
}

void FlightPage::look(const Tick& tick, double now) {
  if (looks_seen_++ % look_step_ != 0) return;
  Look look{.time = now,
            .exposed = tick.exposed.value_or(now),
            .target = tick.pilot.target_gate(),
            .sighting = tick.pilot.sighting(),
            .jpeg = {}};
  const auto target = static_cast<std::size_t>(look.target);
  if (target < race_.sim.world.gates.size())
    look.distance = (race_.sim.world.gates[target].p_EG - tick.truth.p_EB).norm();
  if (pictures_wanted_ && tick.sensors.image) take_picture(look, *tick.sensors.image);
  looks_.push_back(std::move(look));
  if (looks_.size() < kMostLooks) return;
  for (std::size_t i = 0; 2 * i < looks_.size(); ++i) looks_[i] = looks_[2 * i];
  looks_.resize((looks_.size() + 1) / 2);
  look_step_ *= 2;
}

void FlightPage::take_picture(Look& look, const Image& image) {
  picture_width_ = image.width();
  picture_height_ = image.height();
  if (image.empty() || jpegs_seen_++ % jpeg_step_ != 0) return;
  const int largest = std::max(image.width(), image.height());
  look.jpeg = small_jpeg(image, kJpegQuality, (largest + kLargestSide - 1) / kLargestSide);
  jpeg_bytes_ += look.jpeg.size();
  if (jpeg_bytes_ < kMostJpegBytes) return;
  jpeg_step_ *= 2;  // every second one goes, and from now on comes
  jpeg_bytes_ = 0;
  bool goes = false;
  for (Look& other : looks_) {
    if (other.jpeg.empty()) continue;
    if (goes) other.jpeg = {};
    goes = !goes;
    jpeg_bytes_ += other.jpeg.size();
  }
}

Json FlightPage::course() const {
  const sim::World& world = race_.sim.world;
  Json gates = Json::array(), obstacles = Json::array(), decoys = Json::array();
  for (std::size_t i = 0; i < world.gates.size(); ++i) {
    const sim::WorldGate& gate = world.gates[i];
    Json json{{"position", place(gate.p_EG)},
              {"heading", rounded(gate.yaw_EG)},
              {"side", rounded(gate.side)},
              {"bar", rounded(gate.bar)}};
    if (i < race_.pilot.track.gates.size()) {
      const MapGate& map = race_.pilot.track.gates[i];
      json["map"] = {{"position", place(map.p_EG)}, {"heading", rounded(map.yaw_EG)}};
    }
    gates.push_back(std::move(json));
  }
  for (const sim::WorldBox& b : world.obstacles) obstacles.push_back(box(b));
  for (const sim::Decoy& decoy : world.decoys) decoys.push_back(box(decoy.shape));
  Json plan = Json::array();
  if (plan_) {
    plan.push_back(way(plan_->start));
    for (const Path& leg : plan_->legs) plan.push_back(way(leg));
  }
  return {{"room_center", {rounded(world.room_center.x()), rounded(world.room_center.y())}},
          {"room_size", place(world.room_size)},
          {"laps", race_.pilot.track.laps},
          {"speed_mps", rounded(race_.pilot.plan.speed)},
          {"gates", std::move(gates)},
          {"obstacles", std::move(obstacles)},
          {"decoys", std::move(decoys)},
          {"plan", std::move(plan)}};
}

Json FlightPage::columns() const {
  std::vector<Row> rows = rows_;
  if (!rows.empty() && rows.back() != last_) rows.push_back(last_);
  Json json = Json::object();
  for (std::size_t c = 0; c < kColumns; ++c) {
    std::vector<std::int64_t> steps;
    steps.reserve(rows.size());
    std::int64_t before = 0;
    for (const Row& row : rows) {
      steps.push_back(row[c] - before);
      before = row[c];
    }
    json[kNames[c].name] = {{"unit", kNames[c].unit}, {"steps", std::move(steps)}};
  }
  return json;
}

Json FlightPage::looks(std::size_t picture_step) const {
  Json list = Json::array();
  std::size_t pictures = 0;
  for (const Look& look : looks_) {
    const Sighting& s = look.sighting;
    Json json{{"t", rounded(look.time, kTenth)},
              {"exposed", rounded(look.exposed, kTenth)},
              {"target", look.target}};
    if (!look.jpeg.empty() && pictures++ % picture_step == 0)
      json["picture"] = (pictures - 1) / picture_step;
    if (s.offered) json["offered"] = true;
    if (s.source != Sighting::Source::kNone) {
      json["source"] = name_of(s.source);
      json["used"] = s.used;
      json["nis"] = rounded(s.nis);
      json["dof"] = s.nis_dof;
    }
    if (!s.detections.empty()) {
      Json gates = Json::array();
      for (const GateDetection& gate : s.detections)
        gates.push_back(
            {{"px", pixels(gate.corners_px)}, {"fitness", rounded(gate.fitness, 0.01)}});
      json["gates"] = std::move(gates);
    }
    if (s.bars) json["bars"] = pixels(std::array{s.bars->left_px, s.bars->right_px});
    if (s.lower_corners)
      json["lower"] =
          pixels(std::array{s.lower_corners->bottom_left_px, s.lower_corners->bottom_right_px});
    list.push_back(std::move(json));
  }
  return list;
}

Json FlightPage::gate_passes(const Json& summary) const {
  Json list = Json::array();
  const std::size_t gates = race_.sim.world.gates.size();
  if (gates == 0) return list;
  const auto passed = summary.value("gates_passed", std::size_t{0}),
             total = summary.value("gates_total", std::size_t{0});
  const Json offsets = summary.value("gate_offsets_m", Json::array());
  double from = 0.0;
  for (std::size_t i = 0; i < std::min(passed + 1, total); ++i) {
    const bool through = i < passed && i < passes_.size();
    const double until = through ? passes_[i].time : 1e9;
    Json json{{"gate", i % gates}, {"lap", i / gates}};
    const auto seen = std::find_if(looks_.begin(), looks_.end(), [&](const Look& look) {
      return look.time > from && look.time <= until && look.target == static_cast<int>(i % gates) &&
             look.sighting.source != Sighting::Source::kNone;
    });
    if (seen != looks_.end()) {
      json["seen"] = rounded(seen->time, kTenth);
      json["seen_from"] = rounded(seen->distance);
    }
    if (through) {
      json["t"] = rounded(passes_[i].time, kTenth);
      json["speed"] = rounded(passes_[i].speed);
      if (i < offsets.size()) json["offset"] = offsets[i];
      from = until;
    }
    list.push_back(std::move(json));
  }
  return list;
}

std::string FlightPage::pictures(std::size_t picture_step) const {
  std::string text = "[";
  std::size_t pictures = 0;
  for (const Look& look : looks_)
    if (!look.jpeg.empty() && pictures++ % picture_step == 0)
      text += (text.size() > 1 ? ",\"" : "\"") + base64(look.jpeg) + "\"";
  return text + "]";
}

std::string FlightPage::html(const Json& summary, const std::string& verdict) const {
  Json flight{{"format", 1},
              {"verdict", verdict},
              {"summary", summary},
              {"phases", phase_names()},
              {"camera", {picture_width_, picture_height_}},
              {"course", course()},
              {"passes", gate_passes(summary)},
              {"columns", columns()}};
  const auto head = page_.find(kPlaceOfData);
  const auto fill = [&](std::size_t picture_step) {
    flight["looks"] = looks(picture_step);
    return page_.substr(0, head) + "<script type=\"application/json\" id=\"flight\">" +
           in_a_script(flight) + "</script>\n<script type=\"application/json\" id=\"pictures\">" +
           pictures(picture_step) + "</script>" + page_.substr(head + kPlaceOfData.size());
  };
  std::string html = fill(1);
  for (std::size_t step = 2; html.size() > kMostBytes && step <= looks_.size(); step *= 2)
    html = fill(step);
  return html;
}

}  // namespace gatefly::io
