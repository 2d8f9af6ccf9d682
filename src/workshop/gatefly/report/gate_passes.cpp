// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/gate_passes.hpp"

#include <algorithm>

#include "gatefly/report/page_numbers.hpp"

namespace gatefly::report {
namespace {

using Json = nlohmann::ordered_json;

/// The first look after `from` that saw the target `gate`.
std::span<const Look>::iterator first_seen(std::span<const Look> looks, int gate, double from,
                                           double until) {
  return std::find_if(looks.begin(), looks.end(), [&](const Look& look) {
    return look.time > from && look.time <= until && look.target == gate &&
           look.sighting.source != Sighting::Source::kNone;
  });
}

}  // namespace

void GatePasses::add(const PageTick& tick, const PageCourse& course, double now) {
  if (!course.is_truth)
    follow_pilot(tick, now);
  else if (tick.p_EB)
    follow_truth(tick, course.world, now);
}

void GatePasses::follow_truth(const PageTick& tick, const world::World& world, double now) {
  const Eigen::Vector3d& p_EB = *tick.p_EB;
  if (before_ && !world.gates.empty()) {
    const std::size_t next = passes_.size() % world.gates.size();
    const auto gate = static_cast<int>(next);
    const Eigen::Vector3d from = *in_gate(world, gate, *before_), to = *in_gate(world, gate, p_EB);
    if (from.x() < 0.0 && to.x() >= 0.0 &&
        to.tail<2>().cwiseAbs().maxCoeff() < 0.5 * world.gates[next].side) {
      const double part = from.x() / (from.x() - to.x());
      passes_.push_back(
          {before_time_ + part * (now - before_time_), tick.v_E ? tick.v_E->norm() : 0.0});
    }
  }
  before_ = p_EB;
  before_time_ = now;
}

void GatePasses::follow_pilot(const PageTick& tick, double now) {
  const Estimate e = tick.pilot.estimate();
  for (; passed_ < e.gates_passed; ++passed_) passes_.push_back({now, e.v_E.norm()});
}

Json GatePasses::json(const PageCourse& course, std::span<const Look> looks,
                      const Json& summary) const {
  Json list = Json::array();
  const std::size_t gates = course.world.gates.size();
  if (gates == 0) return list;
  const auto passed = summary.value("gates_passed", std::size_t{0}),
             total = summary.value("gates_total", std::size_t{0});
  const Json offsets = summary.value("gate_offsets_m", Json::array());
  double from = 0.0;
  for (std::size_t i = 0; i < std::min(passed + 1, total); ++i) {
    const bool through = i < passed && i < passes_.size();
    const double until = through ? passes_[i].time : 1e9;
    Json json{{"gate", i % gates}, {"lap", i / gates}};
    const auto seen = first_seen(looks, static_cast<int>(i % gates), from, until);
    if (seen != looks.end()) {
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

}  // namespace gatefly::report
