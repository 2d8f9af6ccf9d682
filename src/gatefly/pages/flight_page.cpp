// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pages/flight_page.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include <Eigen/Cholesky>

#include "gatefly/files/base64.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/pages/page.hpp"

namespace gatefly::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 6000;            // two minutes at 50 Hz
constexpr std::size_t kMostLooks = 4000;           // three minutes at 20 Hz
constexpr std::size_t kMostJpegBytes = 1'850'000;  // 2.5 MB as base64
constexpr int kJpegQuality = 45;
constexpr int kLargestSide = 320;  // of a picture in the page [px]

struct Column {
  const char* name;
  double unit;  ///< What one step of the whole numbers is.
};
constexpr std::int64_t kMissing = std::numeric_limits<std::int64_t>::min();
constexpr double kMilli = 1e-3, kTenth = 1e-4, kHundredth = 1e-5;
constexpr std::array<Column, 54> kNames{{
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
    // Truth less estimate along the body's axes, and how sure the filter is.
    {"error_vx_mps", kMilli},
    {"error_vy_mps", kMilli},
    {"error_vz_mps", kMilli},
    {"sigma_vx_mps", kMilli},
    {"sigma_vy_mps", kMilli},
    {"sigma_vz_mps", kMilli},
    {"sigma_bax_mps2", kTenth},
    {"sigma_bay_mps2", kTenth},
    {"sigma_baz_mps2", kTenth},
    {"sigma_tilt_rad", kTenth},
    {"sigma_yaw_rad", kTenth},
    {"wind_north_mps", kMilli},
    {"wind_east_mps", kMilli},
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

}  // namespace

PageCourse page_course(const PilotConfig& pilot, const sim::SimConfig& sim, bool pictures) {
  return {.world = sim.world,
          .map = pilot.track,
          .speed = pilot.plan.speed,
          .pictures_per_second = pictures ? sim.sensors.camera_hz : 0.0,
          .accel_bias = sim.sensors.accel_bias + sim.sensors.flight_bias,
          .gyro_bias = sim.sensors.gyro_bias + sim.sensors.gyro_drift};
}

PageCourse page_course(const PilotConfig& pilot) {
  PageCourse course;
  course.map = pilot.track;
  course.speed = pilot.plan.speed;
  course.is_truth = false;
  const Track& map = pilot.track;
  for (const MapGate& gate : map.gates)
    course.world.gates.push_back(
        {.p_EG = gate.p_EG, .yaw_EG = gate.yaw_EG, .side = gate.side, .bar = gate.bar});
  for (const MapObstacle& box : map.obstacles)
    course.world.obstacles.push_back(
        {.center = box.center, .size = box.size, .heading = box.heading, .top = box.height});
  course.world.room_center = map.room_center;
  course.world.room_size = {map.room_size.x(), map.room_size.y(), map.ceiling};
  return course;
}

FlightPage::FlightPage(std::string page, PageCourse course, std::filesystem::path film)
    : page_{std::move(page)}, course_{std::move(course)}, film_path_{std::move(film)} {
  rows_.reserve(kMostRows);
  for (const sim::WorldGate& gate : course_.world.gates)
    to_gate_.push_back(rotation_z(-gate.yaw_EG));
}

void FlightPage::record(const Tick& tick) {
  record(PageTick{.sensors = tick.sensors,
                  .command = tick.command,
                  .pilot = tick.pilot,
                  .p_EB = tick.truth.p_EB,
                  .v_E = tick.truth.v_E,
                  .attitude = tick.truth.attitude,
                  .wind_E = tick.truth.wind_E,
                  .exposed = tick.exposed});
}

void FlightPage::record(const PageTick& tick) {
  const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
  if (!plan_) plan_ = tick.pilot.plan();
  if (!course_.is_truth)
    count_gates(tick, now);
  else if (tick.p_EB)
    follow_truth(*tick.p_EB, tick, now);
  if (tick.sensors.image || tick.sensors.seen) look(tick, now);
  if (now < next_row_) return;
  next_row_ = std::max(next_row_ + row_period_, now);
  rows_.push_back(row_of(tick, now));
  if (rows_.size() < kMostRows) return;
  for (std::size_t i = 0; 2 * i < rows_.size(); ++i) rows_[i] = rows_[2 * i];
  rows_.resize((rows_.size() + 1) / 2);
  row_period_ *= 2.0;
}

std::optional<Eigen::Vector3d> FlightPage::in_target_gate(const PageTick& tick,
                                                          const Eigen::Vector3d& p_EB) const {
  const auto target = static_cast<std::size_t>(tick.pilot.target_gate());
  if (target >= to_gate_.size()) return std::nullopt;
  return Eigen::Vector3d{to_gate_[target] * (p_EB - course_.world.gates[target].p_EG)};
}

FlightPage::Row FlightPage::row_of(const PageTick& tick, double now) const {
  const Estimate own = tick.pilot.estimate();
  const Estimate& e = tick.estimate ? *tick.estimate : own;
  const Navigator& navigator = tick.pilot.navigator();
  const DragFilter& filter = navigator.filter();
  const Eigen::Matrix3d l = e.covariance_GB.llt().matrixL();
  const auto nothing = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

  Row row{};
  std::size_t next = 0;
  const auto put = [&](double value) {
    const double steps = value / kNames[next].unit;
    row[next++] = std::isfinite(steps) ? std::llround(std::clamp(steps, -1e12, 1e12)) : kMissing;
  };
  const auto put_vector = [&](const Eigen::Vector3d& v) {
    for (const double value : v) put(value);
  };
  const auto put_attitude = [&](const Attitude& a) { put_vector({a.roll, a.pitch, a.yaw}); };
  put(now);
  put_vector(tick.p_EB.value_or(nothing));
  put_vector(e.p_EB);
  put_vector(tick.v_E.value_or(nothing));
  put_vector(e.v_E);
  if (tick.attitude)
    put_attitude(*tick.attitude);
  else
    put_vector(nothing);
  put_attitude(e.attitude);
  put_vector(e.accel_bias);
  put_vector(e.gyro_bias);
  const auto truth = tick.p_EB ? in_target_gate(tick, *tick.p_EB) : std::nullopt;
  put_vector(truth ? Eigen::Vector3d{*truth - e.p_GB} : Eigen::Vector3d{nothing});
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) put(l(r, c));
  put_vector(tick.v_E
                 ? Eigen::Vector3d{rotation_EB(e.attitude).matrix.transpose() * (*tick.v_E - e.v_E)}
                 : Eigen::Vector3d{nothing});
  if (tick.estimate) {  // the pilot's filter does not know how sure another one is
    for (int i = 0; i < 8; ++i) put(nothing.x());
  } else {
    const auto sigma = [&](int state) { return std::sqrt(filter.covariance()(state, state)); };
    const Eigen::Vector2d drag = filter.params().model.drag.cwiseAbs();
    put_vector({sigma(drag_model::kBiasX) / drag.x(), sigma(drag_model::kBiasY) / drag.y(),
                sigma(drag_model::kVz)});  // Eq. (14): what the bias does to drag's velocity
    put_vector({sigma(drag_model::kBiasX), sigma(drag_model::kBiasY), sigma(drag_model::kBiasZ)});
    put(navigator.ahrs().tilt_sigma());
    put(navigator.ahrs().heading_sigma());
  }
  const Eigen::Vector2d calm = nothing.head<2>();
  for (const double wind : tick.wind_E.value_or(calm)) put(wind);
  const AttitudeCommand& command = tick.command.attitude;
  put_vector({command.roll, command.pitch, command.yaw});
  put(command.thrust);
  put(static_cast<double>(tick.pilot.phase().index()));
  put(tick.pilot.target_gate());
  put(e.gates_passed);
  return row;
}

void FlightPage::follow_truth(const Eigen::Vector3d& p_EB, const PageTick& tick, double now) {
  const auto& gates = course_.world.gates;
  if (before_ && !gates.empty()) {
    const std::size_t next = passes_.size() % gates.size();
    const sim::WorldGate& gate = gates[next];
    const Eigen::Matrix3d& to_gate = to_gate_[next];
    const Eigen::Vector3d from = to_gate * (*before_ - gate.p_EG),
                          to = to_gate * (p_EB - gate.p_EG);
    if (from.x() < 0.0 && to.x() >= 0.0 && to.tail<2>().cwiseAbs().maxCoeff() < 0.5 * gate.side) {
      const double part = from.x() / (from.x() - to.x());
      passes_.push_back(
          {before_time_ + part * (now - before_time_), tick.v_E ? tick.v_E->norm() : 0.0});
    }
  }
  before_ = p_EB;
  before_time_ = now;
}

void FlightPage::count_gates(const PageTick& tick, double now) {
  const Estimate e = tick.pilot.estimate();
  for (; passed_ < e.gates_passed; ++passed_) passes_.push_back({now, e.v_E.norm()});
}

void FlightPage::look(const PageTick& tick, double now) {
  const bool taken = looks_seen_++ % look_step_ == 0;
  if (!taken) return;
  Look look{.time = now,
            .exposed = tick.exposed.value_or(now),
            .target = tick.pilot.target_gate(),
            .sighting = tick.pilot.sighting(),
            .jpeg = {},
            .filmed = {},
            .fix_error = {}};
  const auto target = static_cast<std::size_t>(look.target);
  if (tick.p_EB && target < course_.world.gates.size())
    look.distance = (course_.world.gates[target].p_EG - *tick.p_EB).norm();
  if (tick.p_EB && look.sighting.fix)
    if (const auto truth = in_target_gate(tick, *tick.p_EB))
      look.fix_error = *truth - *in_target_gate(tick, look.sighting.fix->p_EB);
  if (tick.sensors.image && !tick.sensors.image->empty()) {
    picture_width_ = tick.sensors.image->width();
    picture_height_ = tick.sensors.image->height();
    if (film_path_.empty())
      take_picture(look, *tick.sensors.image);
    else
      film(look, *tick.sensors.image);
  }
  looks_.push_back(std::move(look));
  if (looks_.size() < kMostLooks) return;
  for (std::size_t i = 0; 2 * i < looks_.size(); ++i) looks_[i] = looks_[2 * i];
  looks_.resize((looks_.size() + 1) / 2);
  look_step_ *= 2;
}

/// A page without its film is better than no flight: what fails here is said in the page.
void FlightPage::film(Look& look, const Image& image) try {
  if (film_failed_) return;
  if (!film_) film_.emplace(film_path_, image, pictures_expected());
  film_->add(image);
  look.filmed = filmed_++;
} catch (const std::runtime_error&) {
  film_failed_ = true;
}

/// By the way planned and the speed asked for; half as much again for the ground and for searches.
double FlightPage::pictures_expected() const {
  if (course_.pictures > 0) return static_cast<double>(course_.pictures);
  double lap = 0.0;
  for (const Path& leg : plan_->legs) lap += leg.length();
  const double way = plan_->start.length() + lap * course_.map.laps;
  return course_.pictures_per_second * (10.0 + 1.2 * way / std::max(0.1, course_.speed));
}

void FlightPage::take_picture(Look& look, const Image& image) {
  if (jpegs_seen_++ % jpeg_step_ != 0) return;
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
  const sim::World& world = course_.world;
  Json gates = Json::array(), obstacles = Json::array(), decoys = Json::array();
  for (std::size_t i = 0; i < world.gates.size(); ++i) {
    const sim::WorldGate& gate = world.gates[i];
    Json json{{"position", place(gate.p_EG)},
              {"heading", rounded(gate.yaw_EG)},
              {"side", rounded(gate.side)},
              {"bar", rounded(gate.bar)}};
    if (course_.is_truth && i < course_.map.gates.size()) {
      const MapGate& map = course_.map.gates[i];
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
  Json json{{"room_center", {rounded(world.room_center.x()), rounded(world.room_center.y())}},
            {"room_size", place(world.room_size)},
            {"laps", course_.map.laps},
            {"speed_mps", rounded(course_.speed)},
            {"gates", std::move(gates)},
            {"obstacles", std::move(obstacles)},
            {"decoys", std::move(decoys)},
            {"plan", std::move(plan)}};
  if (course_.accel_bias) json["accel_bias_mps2"] = place(*course_.accel_bias);
  if (course_.gyro_bias) {
    json["gyro_bias_radps"] = Json::array();
    for (const double bias : *course_.gyro_bias)
      json["gyro_bias_radps"].push_back(rounded(bias, kHundredth));
  }
  return json;
}

/// {"t_s":{"unit":0.0001,"steps":[..]}, ..}: each number is what is added to the one before; null
/// where there is none. A column in which there is nothing at all is left out.
std::string FlightPage::columns(std::size_t row_step) const {
  std::string text = "{";
  for (std::size_t c = 0; c < kColumns; ++c) {
    if (!rows_.empty() &&
        std::all_of(rows_.begin(), rows_.end(), [&](const Row& row) { return row[c] == kMissing; }))
      continue;
    if (text.size() > 1) text += ',';
    text += '"' + std::string{kNames[c].name} + "\":{\"unit\":" + text_of(kNames[c].unit) +
            ",\"steps\":[";
    std::int64_t before = 0;
    std::array<char, 24> digits{};
    for (std::size_t i = 0; i < rows_.size(); i += row_step) {
      if (i > 0) text += ',';
      if (rows_[i][c] == kMissing) {
        text += "null";
        continue;
      }
      const auto end =
          std::to_chars(digits.data(), digits.data() + digits.size(), rows_[i][c] - before);
      text.append(digits.data(), end.ptr);
      before = rows_[i][c];
    }
    text += "]}";
  }
  return text + "}";
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
    if (look.filmed) json["picture"] = *look.filmed;
    if (s.offered) json["offered"] = true;
    if (s.source != Sighting::Source::kNone) {
      json["source"] = name_of(s.source);
      json["used"] = s.used;
      json["nis"] = rounded(s.nis);
      json["dof"] = s.nis_dof;
    }
    if (look.fix_error) json["fix"] = place(*look.fix_error);
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
  const std::size_t gates = course_.world.gates.size();
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
      if (seen->distance > 0.0) json["seen_from"] = rounded(seen->distance);
    }
    if (through) {
      json["t"] = rounded(passes_[i].time, kTenth);
      if (passes_[i].speed > 0.0) json["speed"] = rounded(passes_[i].speed);
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

std::string FlightPage::html(const Json& summary, const std::string& verdict) {
  if (film_ && !film_failed_) try {
      film_bytes_ = film_->finish();
    } catch (const std::runtime_error&) {
      film_failed_ = true;
    }
  film_.reset();
  Json flight{{"format", 2},
              {"verdict", verdict},
              {"summary", summary},
              {"phases", phase_names()},
              {"camera", {picture_width_, picture_height_}},
              {"course", course()},
              {"passes", gate_passes(summary)}};
  if (!film_bytes_.empty()) flight["film"] = {{"rate", OnboardFilm::kRate}, {"pictures", filmed_}};
  if (film_failed_) flight["film_failed"] = true;
  const std::string film = film_bytes_.empty() ? std::string{}
                                               : "<script type=\"text/plain\" id=\"film\">" +
                                                     base64(film_bytes_) + "</script>\n";
  const auto fill = [&](std::size_t step) {
    flight["looks"] = looks(step);
    std::string told = in_a_script(flight);
    told.pop_back();  // the brace: columns are the largest part, and written by hand
    return with_elements(page_,
                         "<script type=\"application/json\" id=\"flight\">" + told +
                             ",\"columns\":" + columns(film.empty() ? 1 : step) +
                             "}</script>\n<script type=\"application/json\" id=\"pictures\">" +
                             pictures(step) + "</script>\n" + film);
  };
  std::string html = fill(1);
  for (std::size_t step = 2; html.size() > kMostBytes && step <= looks_.size(); step *= 2)
    html = fill(step);
  return html;
}

}  // namespace gatefly::io
