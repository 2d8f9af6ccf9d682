// SPDX-License-Identifier: Apache-2.0
#include "real.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "gatefly/config/config.hpp"
#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/part_params.hpp"
#include "gatefly/race/race_params.hpp"
#include "gatefly/sim/gates_in_view.hpp"

#include "eyes.hpp"

namespace gatefly::measuring {
namespace {

namespace lab = gatefly::experiments;

constexpr double kOfGate = 0.15;  // shares this much with a gate: it is a crooked frame of it

int number_of(const std::string& image) {
  const auto at = image.find_first_of("0123456789");
  return at == std::string::npos ? -1 : std::atoi(image.c_str() + at);
}

/// Big and square enough, and rolled no more than the drone ever is.
bool counts(const Quad& gate) {
  const double most = SpeedParams{}.max_roll;
  const Eigen::Vector2d along = gate[1] - gate[0] + gate[2] - gate[3];
  return sim::detectable(gate) && std::abs(gatefly::atan2(along.y(), along.x())) < most;
}

struct Labelled {
  std::string name;
  const Image image;
  const files::PictureToScore& truth;
};

LookoutParams params_of(const config::Config& config) {
  LookoutParams params = lookout_params(config.pilot);
  params.detector.min_score = GateDetectorParams{}.min_score;  // as it flies
  return params;
}

/// Pictures of one set, in their order; numbers that follow each other are one window.
class SetOfPictures {
 public:
  SetOfPictures(const config::Config& config, int nth, LooksOfBoth& looks)
      : nth_{nth}, looks_{looks} {
    const LookoutParams params = params_of(config);
    eyes_.emplace_back(kOurs, params), eyes_.emplace_back(kPaper, params);
    for (Looks& each : looks_) each.lights[nth] = {};
  }

  void look(const Labelled& picture) {
    const int number = number_of(picture.name);
    if (number != last_ + 1) {
      ++window_, first_ = number;
      for (Eye& eye : eyes_) eye.forget();
    }
    last_ = number;
    std::optional<Quad> target;
    if (!picture.truth.gates.empty())
      target = clockwise_from_top_left(files::polygon(picture.truth.gates.front()));
    for (std::size_t d = 0; d < kDetectors; ++d)
      judge(eyes_[d].look(picture.image, target), picture, target, looks_[d]);
  }

 private:
  void judge(const Answer& answer, const Labelled& picture, const std::optional<Quad>& target,
             Looks& looks) const {
    ++looks.pictures;
    std::vector<const GateDetection*> open;
    for (const GateDetection& gate : answer.gates) open.push_back(&gate);
    const auto claim = [&](Kind kind, double part) {
      Look look{.seed = nth_,
                .window = 10'000 * nth_ + window_,
                .step = last_ - first_,
                .side_px = side_of(*target),
                .truth = *target};
      const auto found = std::find_if(open.begin(), open.end(), [&](const GateDetection* d) {
        return overlaps(files::polygon(d->corners_px), *target, part);
      });
      if (found != open.end()) {
        look.hit = true, look.fitness = (*found)->fitness, look.seen = (*found)->corners_px;
        open.erase(found);
      }
      looks[kind].push_back(look);
    };
    if (target && counts(*target)) claim(Kind::kGate, kSame);
    std::erase_if(open, [&](const GateDetection* d) {
      return std::any_of(
          picture.truth.ignored.begin(), picture.truth.ignored.end(), [&](const Quad& other) {
            return overlaps(files::polygon(d->corners_px), files::polygon(other), 0.3);
          });
    });
    if (target && counts(*target)) claim(Kind::kCrooked, kOfGate);
    if (target && !counts(*target))
      std::erase_if(open, [&](const GateDetection* d) {
        return shared_area(files::polygon(d->corners_px), *target) > 0.0;
      });
    for (const GateDetection* gate : open)
      looks.alarms.push_back({.seed = nth_,
                              .window = 10'000 * nth_ + window_,
                              .step = last_ - first_,
                              .fitness = gate->fitness,
                              .side_px = side_of(gate->corners_px)});
  }

  int nth_;
  LooksOfBoth& looks_;
  std::vector<Eye> eyes_;
  int window_ = 0, first_ = 0, last_ = -10;
};

void look_at_set(const std::string& name, const lab::Options& options, int nth,
                 LooksOfBoth& looks) {
  const lab::OwnSet set = lab::own_set(name, options);
  SetOfPictures looking{set.config, nth, looks};
  for (std::size_t i = 0; i < set.size(); ++i)
    looking.look({set.names[i], set.picture(i).image, set.picture(i).truth});
}

/// One approach to a gate; before picture 18 the drone stands on the floor.
void look_at_flight(const lab::Options& options, int nth, LooksOfBoth& looks) {
  constexpr int kInTheAir = 18;
  const lab::LabelledSet set{lab::data_folder("tudelft_bebop_flights", options) / "flight_11"};
  const std::vector<std::string> configs{"flights"};
  const config::Config config = config::load_config(config::config_files(configs));
  SetOfPictures looking{config, nth, looks};
  for (std::size_t i = 0; i < set.size(); ++i) {
    const files::LabelledPicture& label = set.labels.pictures[i];
    if (number_of(label.image) < kInTheAir) continue;
    const files::PictureToScore truth{.gates = label.gates, .ignored = {}, .detections = {}};
    looking.look({label.image, set.picture(i), truth});
  }
}

}  // namespace

RealLooks look_at_real(const std::string& data) {
  const lab::Options options{.data = data};
  RealLooks looks;
  int nth = 0;
  for (const char* name : {"basement32_hq", "cyberzoo", "distance51"})
    look_at_set(name, options, nth++, looks.clear);
  look_at_flight(options, nth++, looks.clear);
  look_at_set("basement580", options, 0, looks.video);
  return looks;
}

}  // namespace gatefly::measuring
