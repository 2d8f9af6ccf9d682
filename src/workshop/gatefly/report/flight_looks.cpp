// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_looks.hpp"

#include <algorithm>
#include <array>

#include "gatefly/files/base64.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/report/page_numbers.hpp"

namespace gatefly::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLooks = 4000;           // three minutes at 20 Hz
constexpr std::size_t kMostJpegBytes = 1'850'000;  // 2.5 MB as base64
constexpr int kJpegQuality = 45;
constexpr int kLargestSide = 320;  // of a picture in the page [px]

template <class Points>
Json pixels(const Points& points) {
  Json json = Json::array();
  for (const Eigen::Vector2d& p : points) {
    json.push_back(rounded(p.x(), 0.1));
    json.push_back(rounded(p.y(), 0.1));
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

/// All but the picture itself.
Look looked(const PageTick& tick, const world::World& world, double now) {
  Look look{.time = now,
            .exposed = tick.exposed.value_or(now),
            .took = tick.took,
            .target = tick.pilot.target_gate(),
            .sighting = tick.pilot.sighting(),
            .jpeg = {},
            .filmed = {},
            .fix_error = {}};
  const auto target = static_cast<std::size_t>(look.target);
  if (!tick.p_EB || target >= world.gates.size()) return look;
  look.distance = (world.gates[target].p_EG - *tick.p_EB).norm();
  if (look.sighting.fix)
    look.fix_error = *in_gate(world, look.target, *tick.p_EB) -
                     *in_gate(world, look.target, look.sighting.fix->p_EB);
  return look;
}

/// The picture's detections, and the filter's use of them.
/// @param jpeg  its number among the page's JPEGs.
Json as_json(const Look& look, std::optional<std::size_t> jpeg) {
  const Sighting& s = look.sighting;
  Json json{{"t", rounded(look.time, kTenth)},
            {"exposed", rounded(look.exposed, kTenth)},
            {"target", look.target}};
  if (look.took) json["took_ms"] = rounded(1e3 * *look.took, 0.01);
  if (jpeg) json["picture"] = *jpeg;
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
      gates.push_back({{"px", pixels(gate.corners_px)}, {"fitness", rounded(gate.fitness, 0.01)}});
    json["gates"] = std::move(gates);
  }
  if (s.bars) json["bars"] = pixels(std::array{s.bars->left_px, s.bars->right_px});
  if (s.lower_corners)
    json["lower"] =
        pixels(std::array{s.lower_corners->bottom_left_px, s.lower_corners->bottom_right_px});
  return json;
}

}  // namespace

void FlightLooks::add(const PageTick& tick, const PageCourse& course, const RacePlan& plan,
                      double now) {
  const bool taken = looks_seen_++ % look_step_ == 0;
  if (!taken) return;
  Look look = looked(tick, course.world, now);
  if (tick.sensors.image && !tick.sensors.image->empty()) {
    picture_width_ = tick.sensors.image->width();
    picture_height_ = tick.sensors.image->height();
    if (film_.wanted())
      look.filmed = film_.add(*tick.sensors.image, pictures_expected(course, plan));
    else
      take_picture(look, *tick.sensors.image);
  }
  looks_.push_back(std::move(look));
  if (looks_.size() < kMostLooks) return;
  for (std::size_t i = 0; 2 * i < looks_.size(); ++i) looks_[i] = looks_[2 * i];
  looks_.resize((looks_.size() + 1) / 2);
  look_step_ *= 2;
}

void FlightLooks::take_picture(Look& look, const Image& image) {
  if (jpegs_seen_++ % jpeg_step_ != 0) return;
  const int largest = std::max(image.width(), image.height());
  look.jpeg = files::small_jpeg(image, kJpegQuality, (largest + kLargestSide - 1) / kLargestSide);
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

Json FlightLooks::json(std::size_t picture_step) const {
  Json list = Json::array();
  std::size_t pictures = 0;
  for (const Look& look : looks_) {
    const bool shown = !look.jpeg.empty() && pictures++ % picture_step == 0;
    list.push_back(
        as_json(look, shown ? std::optional{(pictures - 1) / picture_step} : std::nullopt));
  }
  return list;
}

std::string FlightLooks::jpegs(std::size_t picture_step) const {
  std::string text = "[";
  std::size_t pictures = 0;
  for (const Look& look : looks_)
    if (!look.jpeg.empty() && pictures++ % picture_step == 0)
      text += (text.size() > 1 ? ",\"" : "\"") + files::base64(look.jpeg) + "\"";
  return text + "]";
}

}  // namespace gatefly::report
