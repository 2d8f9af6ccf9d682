// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/chosen.hpp"

#include "gatefly/race/part_params.hpp"

namespace gatefly {
namespace {

std::variant<Lookout, PaperLookout, MapLookout> lookout_of(const PilotConfig& config) {
  if (config.pose_scheme == Scheme::kPaper) return PaperLookout{lookout_params(config)};
  if (filter_model(config) == FilterModel::kOurs) return MapLookout{lookout_params(config)};
  return Lookout{lookout_params(config)};
}

std::variant<Guidance, PaperGuidance> guidance_of(const PilotConfig& config) {
  if (config.control_scheme == Scheme::kOurs) return Guidance{guidance_params(config)};
  return PaperGuidance{config.paper_control, guidance_params(config), config.filter.model.drag.x(),
                       config.imu_hz};
}

}  // namespace

Course course_of(const PilotConfig& config) {
  if (config.control_scheme == Scheme::kPaper) return Course::by_exits(config.track);
  return {config.track, config.plan};
}

ChosenLookout::ChosenLookout(const PilotConfig& config) : lookout_{lookout_of(config)} {}

void ChosenLookout::look(const Sensors& sensors, bool looking, const Course& course,
                         Navigator& navigator) {
  std::visit([&](auto& each) { each.look(sensors, looking, course, navigator); }, lookout_);
}
const Sighting& ChosenLookout::sighting() const {
  return std::visit([](const auto& each) -> const Sighting& { return each.sighting(); }, lookout_);
}
bool ChosenLookout::would_show_whole(const MapGate& gate, const Eigen::Vector3d& p_GB) const {
  const auto* knows = std::get_if<MapLookout>(&lookout_);
  return knows == nullptr || knows->would_show_whole(gate, p_GB);
}
const eskf::Monitor* ChosenLookout::monitor() const {
  const auto* judges = std::get_if<MapLookout>(&lookout_);
  return judges != nullptr ? &judges->monitor() : nullptr;
}

ChosenGuidance::ChosenGuidance(const PilotConfig& config) : guidance_{guidance_of(config)} {}

AttitudeCommand ChosenGuidance::command(Phase& phase, const NavigationState& now,
                                        const Course& course) {
  return std::visit([&](auto& each) { return each.command(phase, now, course); }, guidance_);
}
void ChosenGuidance::reset() {
  std::visit([](auto& each) { each.reset(); }, guidance_);
}
bool ChosenGuidance::uses_pictures(const Phase& phase) const {
  return std::visit([&](const auto& each) { return each.uses_pictures(phase); }, guidance_);
}
double ChosenGuidance::entry_speed(const NavigationState& now) const {
  return std::visit([&](const auto& each) { return each.entry_speed(now); }, guidance_);
}
double ChosenGuidance::lateral_at_gate(const NavigationState& now, const Course& course) const {
  return std::visit([&](const auto& each) { return each.lateral_at_gate(now, course); }, guidance_);
}
bool ChosenGuidance::turn_ahead(const NavigationState& now, const Course& course) const {
  return std::visit([&](const auto& each) { return each.turn_ahead(now, course); }, guidance_);
}

}  // namespace gatefly
