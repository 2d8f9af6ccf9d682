// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/detection_stages.hpp"

#include <utility>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/detection/paper/paper_detector.hpp"
#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/detection/search/part_search.hpp"
#include "gatefly/detection/search/snake_search.hpp"
#include "gatefly/experiments/bench/opencv_baseline.hpp"

namespace gatefly::bench {
namespace {

constexpr const char* kBaseline = "opencv";

/// Compilers may not leave out what computes this.
template <class T>
void keep(const T& result) {
  asm volatile("" : : "g"(&result) : "memory");
}

/// A search with detect(image, color model).
template <class Search, class Params>
auto with_model(const Params& params, const ColorModel& color) {
  return [search = std::make_shared<Search>(params), color,
          toned = std::make_shared<PictureColor>()](const Picture& picture) {
    toned->set(color, tone_of(picture.view(), color));
    keep(search->detect(picture.view(), *toned));
  };
}

}  // namespace

std::vector<Stage> detection_stages(std::shared_ptr<const std::vector<Picture>> pictures,
                                    const PilotConfig& config) {
  std::vector<Stage> stages;
  const auto add = [&](const std::string& name, const std::string& what, auto look) {
    stages.push_back({.name = name,
                      .what = what,
                      .inputs = pictures->size(),
                      .call = [pictures, look](std::size_t i) { look((*pictures)[i]); },
                      .baseline = has_opencv() && name != kBaseline ? kBaseline : ""});
  };
  if (has_opencv())
    add(kBaseline, "UYVY, BGR, HSV, inRange, findContours, approxPolyDP",
        [](const Picture& p) { keep(opencv_quads(p)); });
  add("snakes", "our fast search", with_model<SnakeSearch>(config.detector, config.gate_color));
  add("careful", "our search of the whole picture",
      with_model<CarefulSearch>(config.detector, config.gate_color));
  add("ours", "the careful one when the fast one is not sure",
      [detector = std::make_shared<GateDetector>(config.detector),
       color = config.gate_color](const Picture& p) { keep(detector->look(p.view(), color)); });
  add("parts", "gates that the border cuts",
      with_model<PartSearch>(config.detector, config.gate_color));
  add("flown", "Li18's detector as flown", [](const Picture& p) {
    Rng rng{1};
    keep(detect_as_flown(p.view(), {}, rng));
  });
  add("paper", "Li18's detector as in its ROC study", [](const Picture& p) {
    Rng rng{1};
    keep(detect_as_paper(p.view(), {}, rng));
  });
  return stages;
}

}  // namespace gatefly::bench
