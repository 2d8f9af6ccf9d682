// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/flight_video.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/simulated_race/results/result_card.hpp"
#include "gatefly/simulated_race/results/time_strip.hpp"

namespace gatefly::simulated_race {
namespace {

constexpr int kWidth = 1600, kHeight = 900;  // [px]
constexpr int kPicturesPerSecond = 20;
constexpr double kMargin = 16.0, kHead = 70.0, kLegend = 34.0;  // [px]
constexpr double kStatusHeight = 44.0;                          // [px]
constexpr double kBright = 7.0;   // the way flown in these last seconds is drawn brightest
constexpr double kHold = 5.0;     // of the last frame [s]
constexpr double kContact = 2.0;  // of the contact, before the card covers it [s]

drawing::Box left_column(bool pictures) {
  return {.x = kMargin,
          .y = kHead,
          .width = pictures ? 945.0 : 470.0,
          .height = kHeight - kHead - kMargin};
}

/// The picture three times as large; without pictures, a line that says so.
double view_height(bool pictures) { return pictures ? 480.0 : 60.0; }

drawing::Box right_of(const drawing::Box& left) {
  const double x = left.right() + kMargin;
  return {.x = x, .y = left.y, .width = kWidth - kMargin - x, .height = left.height};
}

/// The map's place in its panel: room around it, the legend below.
drawing::Box inside(const drawing::Box& panel) {
  return {.x = panel.x + 20,
          .y = panel.y + 16,
          .width = panel.width - 40,
          .height = panel.height - 30 - kLegend};
}

const char* source_in_words(Sighting::Source source) {
  switch (source) {
    case Sighting::Source::kCorners:
      return "position from corners";
    case Sighting::Source::kBars:
      return "position from side bars";
    case Sighting::Source::kNone:
      break;
  }
  return "IMU only";
}

/// Everything that the detector reported in one picture; what the pilot used is drawn strongest.
void draw_sighting(drawing::Canvas& canvas, const Sighting& sighting, double scale, double height) {
  const auto at = [scale](const Eigen::Vector2d& px) {
    return Eigen::Vector2d{scale * (px.array() + 0.5)};
  };
  int rank = 0;
  for (const GateDetection& gate : sighting.detections) {
    const bool used = rank++ == sighting.used;
    drawing::draw_detection(
        canvas, gate, {0, 0}, scale,
        {.color = drawing::kDark.found.faded(used ? 1.0 : 0.6), .width = used ? 3.5 : 1.8});
  }
  const drawing::Stroke stroke{.color = drawing::kDark.found, .width = 3.5};
  if (sighting.lower_corners) {
    const Eigen::Vector2d left = at(sighting.lower_corners->bottom_left_px),
                          right = at(sighting.lower_corners->bottom_right_px);
    const Eigen::Vector2d up{0, -0.35 * (right - left).norm()};
    const std::array<Eigen::Vector2d, 4> feet{left + up, left, right, right + up};
    canvas.polyline(feet, stroke);
  }
  if (!sighting.bars) return;
  for (const Eigen::Vector2d& bar : {at(sighting.bars->left_px), at(sighting.bars->right_px)})
    canvas.line({bar.x(), 0.06 * height}, {bar.x(), 0.94 * height}, stroke);
}

}  // namespace

FlightVideo::FlightVideo(const std::filesystem::path& mp4, const RaceConfig& race,
                         std::string title, bool pictures)
    : race_{race},
      title_{std::move(title)},
      pictures_{pictures},
      left_{left_column(pictures)},
      map_box_{right_of(left_)},
      map_{inside(map_box_), race},
      file_{mp4, kWidth, kHeight, kPicturesPerSecond},
      backdrop_{kWidth, kHeight, drawing::kDark.page},
      frame_{kWidth, kHeight, drawing::kDark.page},
      view_{static_cast<int>(left_.width), static_cast<int>(view_height(pictures)),
            drawing::kDark.panel} {}

void FlightVideo::start(const flight_log::Tick& tick) {
  backdrop_.text({kMargin + 2, 38}, "gatefly",
                 {.color = drawing::kDark.gate, .size = 25, .bold = true});
  backdrop_.text({kMargin + 130, 38}, title_, {.color = drawing::kDark.ink, .size = 25});
  backdrop_.fill(map_box_, drawing::kDark.panel, 8.0);
  map_.draw_course(backdrop_, tick.pilot.plan());
  map_.draw_legend(backdrop_, {map_box_.x + 20, map_box_.bottom() - 0.5 * kLegend - 2});
  const std::string waiting = pictures_ ? "no picture yet" : "ideal vision: there are no pictures";
  view_.text({0.5 * view_.width(), 0.5 * view_.height() + 5}, waiting,
             {.color = drawing::kDark.muted, .size = 18, .align = drawing::Align::kCenter});
}

void FlightVideo::look(const flight_log::Tick& tick) {
  const Image& image = *tick.sensors.image;
  picture_size_ = Eigen::Vector2d{image.width(), image.height()};
  const double fits =
      std::min(view_.width() / picture_size_->x(), view_.height() / picture_size_->y());
  const double scale = fits >= 1.0 ? std::floor(fits) : fits;
  const Eigen::Vector2d size = scale * *picture_size_;

  drawing::Canvas picture(static_cast<int>(size.x()), static_cast<int>(size.y()));
  picture.image(image, {0, 0}, scale, true);
  if (!contact_) draw_sighting(picture, tick.pilot.sighting(), scale, size.y());
  view_.fill({.x = 0, .y = 0, .width = 1.0 * view_.width(), .height = 1.0 * view_.height()},
             drawing::kDark.panel);
  view_.paste(picture, {std::floor(0.5 * (view_.width() - size.x())),
                        std::floor(0.5 * (view_.height() - size.y()))});
}

void FlightVideo::record(const flight_log::Tick& tick) {
  const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
  if (moments_.empty()) start(tick);
  if (pictures_ && tick.sensors.image) look(tick);
  source_ = tick.pilot.sighting().source;
  const Estimate estimate = tick.pilot.estimate();
  while (static_cast<int>(passes_.size()) < estimate.gates_passed) passes_.push_back(now);

  add_frames(tick);
}

void FlightVideo::add_frames(const flight_log::Tick& tick) {
  const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
  const Estimate estimate = tick.pilot.estimate();
  last_ = {now, tick.truth.p_EB, estimate.p_EB, tick.truth.v_E.norm(), estimate.v_E.norm()};
  while (now * kPicturesPerSecond >= static_cast<double>(moments_.size())) {
    moments_.push_back(last_);
    draw(tick);
    if (contact_) draw_contact();
    file_.add(frame_);
  }
}

void FlightVideo::record_fall(const flight_log::Tick& tick, const RaceResult& result) {
  if (moments_.empty() || !result.crash_time) return;
  touch(result);
  if (pictures_ && tick.sensors.image) look(tick);
  add_frames(tick);
}

void FlightVideo::draw(const flight_log::Tick& tick) {
  if (moments_.size() > 1) {
    const Moment &from = moments_[moments_.size() - 2], &to = moments_.back();
    backdrop_.clip(inside(map_box_));
    map_.draw_flown(backdrop_, from, to, 0.6);
    map_.draw_estimate(backdrop_, from, to);
    backdrop_.unclip();
  }
  frame_.paste(backdrop_, {0, 0});
  draw_head(tick);
  frame_.paste(view_, {left_.x, left_.y});
  const drawing::Box status{.x = left_.x,
                            .y = left_.y + view_height(pictures_),
                            .width = left_.width,
                            .height = kStatusHeight};
  draw_status(tick, status);
  const double strips = status.bottom() + 12.0;
  draw_strips(tick, {left_.x, strips, left_.width, left_.bottom() - strips});
  draw_map(tick);
}

void FlightVideo::draw_strips(const flight_log::Tick& tick, const drawing::Box& box) {
  const StripCurve height{"height above the floor",
                          "m",
                          [](const Moment& m) { return -m.true_p_EB.z(); },
                          [](const Moment& m) { return -m.est_p_EB.z(); },
                          2.0,
                          true};
  const StripCurve speed{"speed", "m/s", [](const Moment& m) { return m.true_speed; },
                         [](const Moment& m) { return m.est_speed; }, 2.0};
  const auto& gates = race_.sim.world.gates;
  const auto at = [&](double time, std::size_t index) -> PassedGate {
    const world::WorldGate& gate = gates[index % gates.size()];
    const double half = 0.5 * gate.side - gate.bar;
    return {time, -gate.p_EG.z() - half, -gate.p_EG.z() + half, color_of(gate)};
  };
  std::vector<PassedGate> passes;
  std::optional<PassedGate> next;
  if (!gates.empty()) {
    for (std::size_t i = 0; i < passes_.size(); ++i) passes.push_back(at(passes_[i], i));
    if (!tick.pilot.finished() && tick.pilot.target_gate() >= 0)
      next = at(0.0, static_cast<std::size_t>(tick.pilot.target_gate()));
  }
  // Beside each other below a picture, else above each other.
  const double width = pictures_ ? 0.5 * (box.width - 12.0) : box.width,
               rows = pictures_ ? box.height : 0.5 * (box.height - 12.0);
  TimeStrip({box.x, box.y, width, rows}, height, moments_, kPicturesPerSecond)
      .draw(frame_, passes, next);
  TimeStrip({box.right() - width, box.bottom() - rows, width, rows}, speed, moments_,
            kPicturesPerSecond)
      .draw(frame_, passes, next);
}

void FlightVideo::draw_head(const flight_log::Tick& tick) {
  const int gates = static_cast<int>(race_.pilot.track.gates.size()),
            total = gates * race_.pilot.track.laps;
  const int passed = tick.pilot.estimate().gates_passed;
  const int lap = std::min(passed / std::max(gates, 1) + 1, race_.pilot.track.laps);
  frame_.text(
      {kWidth - kMargin - 2, 40}, files::fixed(moments_.back().time, 1) + " s",
      {.color = drawing::kDark.ink, .size = 30, .align = drawing::Align::kRight, .bold = true});
  const std::string progress = "gates " + std::to_string(passed) + " of " + std::to_string(total) +
                               "     lap " + std::to_string(lap) + " of " +
                               std::to_string(race_.pilot.track.laps);
  frame_.text({kWidth - kMargin - 160, 38}, progress,
              {.color = drawing::kDark.muted, .size = 20, .align = drawing::Align::kRight});

  // One mark for each gate of the race.
  const auto& world = race_.sim.world.gates;
  const auto gate_color = [&](int i) {
    return world.empty() ? drawing::kDark.gate
                         : color_of(world[static_cast<std::size_t>(i) % world.size()]);
  };
  const double width = (kWidth - 2.0 * kMargin + 4.0) / std::max(total, 1);
  for (int i = 0; i < total; ++i)
    frame_.fill(
        {.x = kMargin + i * width, .y = 54, .width = std::max(1.0, width - 4.0), .height = 5},
        i < passed ? gate_color(i) : drawing::kDark.rule, 2.0);
}

void FlightVideo::draw_status(const flight_log::Tick& tick, const drawing::Box& box) {
  frame_.fill(box, drawing::kDark.panel);
  const double line = box.y + 29;
  const std::string phase = gatefly::name_of(tick.pilot.phase());
  const double width = 116.0;
  frame_.fill({.x = box.x + 10, .y = box.y + 8, .width = width, .height = 29}, drawing::kDark.ink,
              5.0);
  frame_.text(
      {box.x + 10 + 0.5 * width, line}, phase,
      {.color = drawing::kDark.page, .size = 17, .align = drawing::Align::kCenter, .bold = true});
  const std::string next = "to gate " + std::to_string(tick.pilot.target_gate() + 1);
  frame_.text({box.x + width + 28, line}, tick.pilot.finished() ? "all gates passed" : next,
              {.color = drawing::kDark.gate, .size = 18, .bold = true});
  if (!pictures_) return;
  const bool fix = source_ != Sighting::Source::kNone;
  const std::string source = source_in_words(source_);
  const drawing::Lettering lettering{.color = fix ? drawing::kDark.found : drawing::kDark.muted,
                                     .size = 18,
                                     .align = drawing::Align::kRight};
  frame_.text({box.right() - 14, line}, source, lettering);
  frame_.disc({box.right() - 26 - frame_.text_width(source, lettering), line - 6}, 6.0,
              lettering.color);
}

void FlightVideo::draw_view(const flight_log::Tick& tick) {
  const double row = 0.5 * picture_size_->y();
  const CameraRig& rig = race_.pilot.camera;
  const auto left = rig.lens.bearing({0.0, row}),
             right = rig.lens.bearing({picture_size_->x() - 1.0, row});
  if (!left || !right) return;
  const Eigen::Matrix3d R_EC = rotation_EB(tick.truth.attitude).matrix * rig.R_BC.matrix;
  const Eigen::Vector3d left_E = R_EC * *left, right_E = R_EC * *right;
  map_.draw_view(frame_, tick.truth.p_EB.head<2>(), left_E.head<2>(), right_E.head<2>());
}

void FlightVideo::draw_map(const flight_log::Tick& tick) {
  frame_.clip(inside(map_box_));
  if (picture_size_) draw_view(tick);
  if (!tick.pilot.finished()) map_.draw_target(frame_, tick.pilot.target_gate());
  const auto recent = static_cast<std::size_t>(kBright * kPicturesPerSecond);
  const std::size_t first = moments_.size() > recent ? moments_.size() - recent : 1;
  for (std::size_t i = first; i < moments_.size(); ++i) {
    const double age = static_cast<double>(moments_.size() - i) / static_cast<double>(recent);
    map_.draw_flown(frame_, moments_[i - 1], moments_[i], 1.0 - 0.4 * age);
  }
  map_.draw_drone(frame_, moments_.back(), tick.truth.attitude.yaw);
  frame_.unclip();
}

/// From now on there is a contact to be shown, where the drone is.
void FlightVideo::touch(const RaceResult& result) {
  if (contact_) return;
  const std::string object = result.why_lost ? result.why_lost->object : result.crash_object;
  contact_ = {last_, files::fixed(*result.crash_time, 1) + " s, contact: " + object};
  source_ = Sighting::Source::kNone;
}

void FlightVideo::draw_contact() {
  constexpr double kHeight = 44.0;  // [px]
  frame_.clip(inside(map_box_));
  map_.draw_flown(frame_, moments_.back(), last_, 1.0);
  map_.draw_contact(frame_, contact_->moment);
  frame_.unclip();
  const double line = left_.y + view_height(pictures_);
  frame_.fill({.x = left_.x, .y = line - kHeight, .width = left_.width, .height = kHeight},
              drawing::kDark.bad);
  frame_.text(
      {left_.x + 0.5 * left_.width, line - 15}, contact_->text,
      {.color = drawing::kDark.page, .size = 20, .align = drawing::Align::kCenter, .bold = true});
  ++contact_->frames;
}

void FlightVideo::finish(const RaceResult& result, const std::string& verdict) {
  if (!moments_.empty() && result.crash_time) {
    touch(result);
    draw_contact();
    const auto shown = static_cast<std::size_t>(kContact * kPicturesPerSecond);
    for (std::size_t i = contact_->frames; i <= shown; ++i) file_.add(frame_);
  }
  if (!moments_.empty()) draw_result_card(frame_, result, verdict);
  for (int i = 0; i < kHold * kPicturesPerSecond; ++i) file_.add(frame_);
  file_.finish();
}

}  // namespace gatefly::simulated_race
