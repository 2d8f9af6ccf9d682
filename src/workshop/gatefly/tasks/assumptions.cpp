// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/assumptions.hpp"

#include <filesystem>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::tasks {
namespace {

namespace fs = std::filesystem;

/// Key of a lens that somebody named; the default camera's is nobody's.
std::string key_of_lens(const config::Config& config) {
  for (const char* key :
       {"camera.model", "camera.focal_px", "camera.center_px", "camera.distortion"})
    if (who_set(config, key) != "default") return key;
  return "";
}

void add_lens(Assumptions& to, const config::Config& config) {
  to.sides = "straight";
  const std::string key = key_of_lens(config);
  if (key.empty()) {
    if (config.lens_angle < 0.0) return;
    to.lens = config.lens_angle > 0.0
                  ? "of " + files::text_of(config.lens_angle / kDegree, 4) + " degrees across"
                  : "straight";
    to.lens_by = who_set(config, "detector.lens_deg");
    if (config.lens_angle > 0.0) to.sides = "the lens bends them";
    return;
  }
  to.lens = config.camera.model + ", " + std::to_string(config.camera.width) + "x" +
            std::to_string(config.camera.height) + " px";
  to.lens_by = who_set(config, key);
  to.sides = "the lens bends them";
}

void add_color(Assumptions& to, const config::Config& config) {
  if (config.detector_mode != "ours" && config.detector_mode != "fast" &&
      config.detector_mode != "careful") {
    to.color = "and thresholds of detector.mode " + config.detector_mode;
    to.color_by = to.threshold_by = who_set(config, "detector.mode");
    return;
  }
  const auto& rgb = config.gate.rgb;
  to.color = config.gate.fitted_color
                 ? "as tuned in " + fs::path{config.gate.color_table}.filename().string()
                 : "as described by rgb " + files::text_of(rgb.x(), 3) + ", " +
                       files::text_of(rgb.y(), 3) + ", " + files::text_of(rgb.z(), 3);
  to.color_by = who_set(config, config.gate.fitted_color ? "color.table" : "color.rgb");
  to.min_score = config.pilot.detector.min_score;
  to.threshold_by = who_set(config, "detector.min_score");
}

}  // namespace

std::string who_set(const config::Config& config, const std::string& key) {
  const auto found = config.set_by.find(key);
  if (found == config.set_by.end()) return "default";
  if (found->second == "--set") return "--set";
  const fs::path file{found->second.substr(0, found->second.rfind(':'))};
  if (file.parent_path().filename() != "configs") return "config " + file.string();
  return file.stem() == "default" ? "default" : "config " + file.stem().string();
}

Assumptions assumptions_of(const config::Config& config) {
  Assumptions assumed;
  add_lens(assumed, config);
  add_color(assumed, config);
  return assumed;
}

std::string text_of(const Assumptions& assumed) {
  std::string text = assumed.lens.empty() ? "no lens named"
                                          : "lens " + assumed.lens + " (" + assumed.lens_by + ")";
  text += ", sides taken as " + assumed.sides + "; colour " + assumed.color + " (" +
          assumed.color_by + ")";
  if (assumed.min_score > 0.0)
    text +=
        "; min_score " + files::text_of(assumed.min_score, 3) + " (" + assumed.threshold_by + ")";
  return text;
}

nlohmann::ordered_json as_json(const Assumptions& assumed) {
  const auto told = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
  };
  return {{"lens",
           {{"is", told(assumed.lens)}, {"sides", assumed.sides}, {"by", told(assumed.lens_by)}}},
          {"color", {{"is", assumed.color}, {"by", assumed.color_by}}},
          {"threshold", {{"min_score", assumed.min_score}, {"by", assumed.threshold_by}}}};
}

}  // namespace gatefly::tasks
