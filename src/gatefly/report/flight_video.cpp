// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_video.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::io {
namespace {

constexpr int kWidth = 1280, kHeight = 720;  // [px]
constexpr int kPicturesPerSecond = 20;
constexpr double kMargin = 16.0, kHead = 62.0, kLegend = 34.0;  // [px]
constexpr double kStatusHeight = 40.0;                          // [px]
constexpr double kBright = 7.0;   // the way flown in these last seconds is drawn brightest
constexpr double kWindow = 30.0;  // of the strips [s]
constexpr double kHold = 2.0;     // of the last frame [s]

Box left_column(bool pictures) {
  return {.x = kMargin,
          .y = kHead,
          .width = pictures ? 632.0 : 360.0,
          .height = kHeight - kHead - kMargin};
}

/// The picture twice as large; without pictures, a line that says so.
double view_height(bool pictures) { return pictures ? 320.0 : 56.0; }

Box right_of(const Box& left) {
  const double x = left.right() + kMargin;
  return {.x = x, .y = left.y, .width = kWidth - kMargin - x, .height = left.height};
}

/// Where the map goes in its panel: room around it, the legend below.
Box inside(const Box& panel) {
  return {.x = panel.x + 20,
          .y = panel.y + 16,
          .width = panel.width - 40,
          .height = panel.height - 30 - kLegend};
}

/// What to draw over time: the truth and what the pilot believed.
struct Curve {
  std::string name, unit;
  std::function<double(const Moment&)> truth, estimate;
  double at_least;  ///< Upper end of the scale, when nothing is higher.
};

/// The last half minute of a curve, in a panel of its own.
class Strip {
 public:
  /// @param moments  at least one; must outlive the strip, as `curve` must.
  Strip(const Box& panel, const Curve& curve, std::span<const Moment> moments)
      : panel_{panel},
        curve_{curve},
        moments_{moments},
        area_{.x = panel.x + 34,
              .y = panel.y + 30,
              .width = panel.width - 46,
              .height = panel.height - 42} {
    end_ = std::max(kWindow, moments.back().time);
    top_ = curve.at_least;
    for (const Moment& m : moments) top_ = std::max(top_, std::ceil(curve.truth(m)));
    constexpr auto kShown = static_cast<std::size_t>(kWindow * kPicturesPerSecond);
    if (moments.size() > kShown) moments_ = moments.last(kShown);
  }

  void draw(Canvas& canvas, std::span<const double> passes) const {
    canvas.fill(panel_, kDark.panel, 8.0);
    canvas.text({panel_.x + 12, panel_.y + 20}, curve_.name, {.color = kDark.muted, .size = 13});
    canvas.text({panel_.right() - 12, panel_.y + 20},
                fixed(curve_.truth(moments_.back()), 2) + " " + curve_.unit,
                {.color = kDark.ink, .size = 14, .align = Align::kRight, .bold = true});
    for (double level = 0.0; level <= top_ + 1e-9; level += 1.0) {
      const double y = at(end_, level).y();
      canvas.line({area_.x, y}, {area_.right(), y},
                  {.color = kDark.grid, .width = 1.0});
      canvas.text({area_.x - 8, y + 4}, fixed(level, 0),
                  {.color = kDark.muted, .size = 11, .align = Align::kRight});
    }
    canvas.clip({.x = area_.x - 2,
                 .y = area_.y - 6,
                 .width = area_.width + 4,
                 .height = area_.height + 12});
    for (const double pass : passes)
      canvas.line(at(pass, 0.0), at(pass, top_), {.color = kDark.gate_solid.faded(0.55), .width = 1.5});
    trace(canvas, curve_.estimate, {.color = kDark.estimate, .width = 1.1});
    trace(canvas, curve_.truth, {.color = kDark.flown, .width = 2.2});
    canvas.unclip();
    canvas.disc(at(moments_.back().time, curve_.truth(moments_.back())), 3.5, kDark.ink);
  }

 private:
  [[nodiscard]] Eigen::Vector2d at(double time, double value) const {
    return {area_.right() - (end_ - time) / kWindow * area_.width,
            area_.bottom() - value / top_ * area_.height};
  }
  void trace(Canvas& canvas, const std::function<double(const Moment&)>& value,
             const Stroke& stroke) const {
    std::vector<Eigen::Vector2d> points;
    for (const Moment& m : moments_) points.push_back(at(m.time, value(m)));
    canvas.polyline(points, stroke);
  }

  Box panel_;
  const Curve& curve_;
  std::span<const Moment> moments_;
  Box area_;
  double end_ = kWindow, top_ = 1.0;
};

void draw_strips(Canvas& canvas, const Box& box, std::span<const Moment> moments,
                 std::span<const double> passes) {
  const Curve height{"height", "m", [](const Moment& m) { return -m.true_p_EB.z(); },
                     [](const Moment& m) { return -m.est_p_EB.z(); }, 2.0};
  const Curve speed{"speed", "m/s", [](const Moment& m) { return m.true_speed; },
                    [](const Moment& m) { return m.est_speed; }, 2.0};
  const double half = 0.5 * (box.height - 12.0);
  Strip({box.x, box.y, box.width, half}, height, moments).draw(canvas, passes);
  Strip({box.x, box.bottom() - half, box.width, half}, speed, moments).draw(canvas, passes);
}

const char* name_of(Sighting::Source source) {
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
void draw_sighting(Canvas& canvas, const Sighting& sighting, double scale, double height) {
  const auto at = [scale](const Eigen::Vector2d& px) {
    return Eigen::Vector2d{scale * (px.array() + 0.5)};
  };
  int rank = 0;
  for (const GateDetection& gate : sighting.detections) {
    const bool used = rank++ == sighting.used;
    draw_detection(canvas, gate, {0, 0}, scale,
                   {.color = kDark.found.faded(used ? 1.0 : 0.6), .width = used ? 2.5 : 1.2});
  }
  const Stroke stroke{.color = kDark.found, .width = 2.5};
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

FlightVideo::FlightVideo(const std::filesystem::path& mp4, const closed_loop::RaceConfig& race,
                         std::string title, bool pictures)
    : race_{race},
      title_{std::move(title)},
      pictures_{pictures},
      left_{left_column(pictures)},
      map_box_{right_of(left_)},
      map_{inside(map_box_), race},
      file_{mp4, kWidth, kHeight, kPicturesPerSecond},
      backdrop_{kWidth, kHeight},
      frame_{kWidth, kHeight},
      view_{static_cast<int>(left_.width), static_cast<int>(view_height(pictures)), kDark.panel} {}

void FlightVideo::start(const Tick& tick) {
  backdrop_.text({kMargin + 2, 32}, "gatefly", {.color = kDark.gate_solid, .size = 20, .bold = true});
  backdrop_.text({kMargin + 104, 32}, title_, {.color = kDark.ink, .size = 20});
  backdrop_.fill(map_box_, kDark.panel, 8.0);
  map_.draw_course(backdrop_, tick.pilot.plan());
  map_.draw_legend(backdrop_, {map_box_.x + 20, map_box_.bottom() - 0.5 * kLegend - 2});
  const std::string waiting = pictures_ ? "no picture yet" : "ideal vision: there are no pictures";
  view_.text({0.5 * view_.width(), 0.5 * view_.height() + 5}, waiting,
             {.color = kDark.muted, .size = 15, .align = Align::kCenter});
}

void FlightVideo::look(const Tick& tick) {
  const Image& image = *tick.sensors.image;
  picture_size_ = Eigen::Vector2d{image.width(), image.height()};
  const double fits =
      std::min(view_.width() / picture_size_->x(), view_.height() / picture_size_->y());
  const double scale = fits >= 1.0 ? std::floor(fits) : fits;
  const Eigen::Vector2d size = scale * *picture_size_;

  Canvas picture(static_cast<int>(size.x()), static_cast<int>(size.y()));
  picture.image(image, {0, 0}, scale);
  draw_sighting(picture, tick.pilot.sighting(), scale, size.y());
  view_.fill({.x = 0, .y = 0, .width = 1.0 * view_.width(), .height = 1.0 * view_.height()},
             kDark.panel);
  view_.paste(picture, {std::floor(0.5 * (view_.width() - size.x())),
                        std::floor(0.5 * (view_.height() - size.y()))});
}

void FlightVideo::record(const Tick& tick) {
  const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
  if (moments_.empty()) start(tick);
  if (pictures_ && tick.sensors.image) look(tick);
  source_ = tick.pilot.sighting().source;
  const Estimate estimate = tick.pilot.estimate();
  while (static_cast<int>(passes_.size()) < estimate.gates_passed) passes_.push_back(now);

  while (now * kPicturesPerSecond >= static_cast<double>(moments_.size())) {
    moments_.push_back(
        {now, tick.truth.p_EB, estimate.p_EB, tick.truth.v_E.norm(), estimate.v_E.norm()});
    draw(tick);
    file_.add(frame_);
  }
}

void FlightVideo::draw(const Tick& tick) {
  if (moments_.size() > 1) {
    const Moment &from = moments_[moments_.size() - 2], &to = moments_.back();
    map_.draw_flown(backdrop_, from, to, 0.4);
    map_.draw_estimate(backdrop_, from, to);
  }
  frame_.paste(backdrop_, {0, 0});
  draw_head(tick);
  frame_.paste(view_, {left_.x, left_.y});
  const Box status{.x = left_.x,
                   .y = left_.y + view_height(pictures_),
                   .width = left_.width,
                   .height = kStatusHeight};
  draw_status(tick, status);
  const double strips = status.bottom() + 12.0;
  draw_strips(frame_, {left_.x, strips, left_.width, left_.bottom() - strips}, moments_, passes_);
  draw_map(tick);
}

void FlightVideo::draw_head(const Tick& tick) {
  const int gates = static_cast<int>(race_.pilot.track.gates.size()),
            total = gates * race_.pilot.track.laps;
  const int passed = tick.pilot.estimate().gates_passed;
  const int lap = std::min(passed / std::max(gates, 1) + 1, race_.pilot.track.laps);
  frame_.text({kWidth - kMargin - 2, 33}, fixed(moments_.back().time, 1) + " s",
              {.color = kDark.ink, .size = 24, .align = Align::kRight, .bold = true});
  const std::string progress = "gates " + std::to_string(passed) + " of " + std::to_string(total) +
                               "     lap " + std::to_string(lap) + " of " +
                               std::to_string(race_.pilot.track.laps);
  frame_.text({kWidth - kMargin - 130, 32}, progress,
              {.color = kDark.muted, .size = 16, .align = Align::kRight});

  // One mark for each gate of the race.
  const double width = (kWidth - 2.0 * kMargin + 4.0) / std::max(total, 1);
  for (int i = 0; i < total; ++i)
    frame_.fill(
        {.x = kMargin + i * width, .y = 46, .width = std::max(1.0, width - 4.0), .height = 4},
        i < passed ? kDark.gate_solid : kDark.solid, 2.0);
}

void FlightVideo::draw_status(const Tick& tick, const Box& box) {
  frame_.fill(box, kDark.panel);
  const double line = box.y + 26;
  const std::string phase = gatefly::name_of(tick.pilot.phase());
  const Lettering plate{
      .color = kDark.page, .size = 14, .align = Align::kCenter, .bold = true};
  const double width = 92.0;
  frame_.fill({.x = box.x + 10, .y = box.y + 8, .width = width, .height = 25}, kDark.ink, 5.0);
  frame_.text({box.x + 10 + 0.5 * width, line}, phase, plate);
  const std::string next = "to gate " + std::to_string(tick.pilot.target_gate() + 1);
  frame_.text({box.x + width + 26, line}, tick.pilot.finished() ? "all gates passed" : next,
              {.color = kDark.gate_solid, .size = 15, .bold = true});
  if (!pictures_) return;
  frame_.text({box.x + 0.5 * box.width, line}, fixed(moments_.back().true_speed, 1) + " m/s",
              {.color = kDark.ink, .size = 15, .align = Align::kCenter});
  const bool fix = source_ != Sighting::Source::kNone;
  const std::string source = name_of(source_);
  const Lettering lettering{
      .color = fix ? kDark.found : kDark.muted, .size = 14, .align = Align::kRight};
  frame_.text({box.right() - 12, line}, source, lettering);
  frame_.disc({box.right() - 22 - frame_.text_width(source, lettering), line - 5}, 5.0,
              lettering.color);
}

void FlightVideo::draw_view(const Tick& tick) {
  const double row = 0.5 * picture_size_->y();
  const CameraRig& rig = race_.pilot.camera;
  const auto left = rig.lens.bearing({0.0, row}),
             right = rig.lens.bearing({picture_size_->x() - 1.0, row});
  if (!left || !right) return;
  const Eigen::Matrix3d R_EC = rotation_EB(tick.truth.attitude).matrix * rig.R_BC.matrix;
  const Eigen::Vector3d left_E = R_EC * *left, right_E = R_EC * *right;
  map_.draw_view(frame_, tick.truth.p_EB.head<2>(), left_E.head<2>(), right_E.head<2>());
}

void FlightVideo::draw_map(const Tick& tick) {
  frame_.clip(inside(map_box_));
  if (picture_size_) draw_view(tick);
  if (!tick.pilot.finished()) map_.draw_target(frame_, tick.pilot.target_gate());
  const auto recent = static_cast<std::size_t>(kBright * kPicturesPerSecond);
  const std::size_t first = moments_.size() > recent ? moments_.size() - recent : 1;
  for (std::size_t i = first; i < moments_.size(); ++i) {
    const double age = static_cast<double>(moments_.size() - i) / static_cast<double>(recent);
    map_.draw_flown(frame_, moments_[i - 1], moments_[i], 1.0 - 0.6 * age);
  }
  map_.draw_drone(frame_, moments_.back(), tick.truth.attitude.yaw);
  frame_.unclip();
}

void FlightVideo::finish(const std::string& outcome) {
  Lettering lettering{.color = kDark.ink, .size = 18, .align = Align::kCenter, .bold = true};
  const double widest = map_box_.width - 80.0;
  lettering.size *= std::min(1.0, widest / frame_.text_width(outcome, lettering));
  const double width = frame_.text_width(outcome, lettering) + 48;
  const double middle = map_box_.x + 0.5 * map_box_.width;
  const Box plate{.x = middle - 0.5 * width, .y = map_box_.y + 8, .width = width, .height = 46};
  frame_.fill(plate, kDark.ink.faded(0.25), 8.0);
  frame_.fill({plate.x + 1.5, plate.y + 1.5, plate.width - 3, plate.height - 3},
              kDark.page.faded(0.92), 7.0);
  frame_.text({middle, plate.y + 30}, outcome, lettering);
  for (int i = 0; i < kHold * kPicturesPerSecond; ++i) file_.add(frame_);
  file_.finish();
}

}  // namespace gatefly::io
