// SPDX-License-Identifier: Apache-2.0
// What a detector does in whole races, as ideal vision needs it: hits by distance, corner errors,
// false alarms.
//
//   ninja -C build/release detector_statistics
//   build/release/detector_statistics TRACK FIRST_SEED RUNS [rendered|ideal]
//
// With `ideal` it measures ideal vision by the same rules: both should print about the same.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "gatefly/closed_loop/race.hpp"
#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/sim/randomize.hpp"
#include "gatefly/sim/solids.hpp"

namespace {

using namespace gatefly;

struct Rate {
  int tries = 0, hits = 0;
  void count(bool hit) { ++tries, hits += hit; }
  void print(const char* what) const {
    std::printf("%-28s %6d of %6d  %.3f\n", what, hits, tries,
                tries > 0 ? static_cast<double>(hits) / tries : 0.0);
  }
};

/// Robust width, and how many lie outside of it.
struct Errors {
  std::vector<double> px;
  void print(const char* what) {
    if (px.empty()) return;
    const auto quantile = [](std::vector<double> v, double q) {
      std::sort(v.begin(), v.end());
      return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
    };
    const double middle = quantile(px, 0.5);
    std::vector<double> off;
    for (const double e : px) off.push_back(std::abs(e - middle));
    const double sigma = 1.4826 * quantile(off, 0.5);
    const auto beyond = [&](double limit) {
      return static_cast<double>(
                 std::count_if(off.begin(), off.end(), [&](double e) { return e > limit; })) /
             static_cast<double>(off.size());
    };
    std::printf(
        "%-28s %6zu  median %+.2f  robust sigma %.2f  beyond 3 sigma %.3f, 5 px %.3f, 10 px %.3f  "
        "99 %% %.1f px\n",
        what, px.size(), middle, sigma, beyond(3 * sigma), beyond(5.0), beyond(10.0),
        quantile(off, 0.99));
  }
};

constexpr double kBin = 0.5;  // [m]

struct Statistics {
  std::vector<Rate> by_distance = std::vector<Rate>(24);
  Rate lower_corners, bars, false_alarms;
  Errors corner_u, corner_v, common_u, common_v, growth, lower_u, lower_v, bar_u;

  void add(const std::vector<sim::GateView>& views, const Sighting& seen, int target);
  void print();
};

void Statistics::add(const std::vector<sim::GateView>& views, const Sighting& seen, int target) {
  for (const sim::GateView& view : views) {
    if (view.whole && sim::detectable(view.corners_px)) {
      const auto found = std::find_if(
          seen.detections.begin(), seen.detections.end(),
          [&](const GateDetection& d) { return overlaps(d.corners_px, view.corners_px, 0.5); });
      const bool hit = found != seen.detections.end();
      by_distance[std::min<std::size_t>(by_distance.size() - 1,
                                        static_cast<std::size_t>(view.distance / kBin))]
          .count(hit);
      if (hit) {
        const Eigen::Vector2d common = center(found->corners_px) - center(view.corners_px);
        common_u.px.push_back(common.x()), common_v.px.push_back(common.y());
        for (std::size_t i = 0; i < 4; ++i) {
          const Eigen::Vector2d error = found->corners_px[i] - view.corners_px[i];
          corner_u.px.push_back(error.x()), corner_v.px.push_back(error.y());
        }
        growth.px.push_back(std::sqrt(std::abs(area(found->corners_px))) -
                            std::sqrt(std::abs(area(view.corners_px))));
      }
    }
    // The pilot asks for these two only when nothing better corrected it.
    if (view.gate != target || seen.used >= 0) continue;
    if (view.only_lower_corners && view.distance < 3.3) {
      const bool hit = seen.lower_corners &&
                       (seen.lower_corners->bottom_left_px - view.corners_px[3]).norm() < 20.0 &&
                       (seen.lower_corners->bottom_right_px - view.corners_px[2]).norm() < 20.0;
      lower_corners.count(hit);
      if (hit) {
        const Eigen::Vector2d left = seen.lower_corners->bottom_left_px - view.corners_px[3],
                              right = seen.lower_corners->bottom_right_px - view.corners_px[2];
        for (const auto& e : {left, right})
          lower_u.px.push_back(e.x()), lower_v.px.push_back(e.y());
      }
    }
    if (view.bars_px && view.distance < 1.7 && seen.source != Sighting::Source::kCorners) {
      const auto& [left, right] = *view.bars_px;
      const bool hit = seen.bars && std::abs(seen.bars->left_px.x() - left.x()) < 20.0 &&
                       std::abs(seen.bars->right_px.x() - right.x()) < 20.0;
      bars.count(hit);
      if (hit)
        bar_u.px.push_back(seen.bars->left_px.x() - left.x()),
            bar_u.px.push_back(seen.bars->right_px.x() - right.x());
    }
  }
  int alarms = 0;
  for (const GateDetection& d : seen.detections)
    alarms += std::none_of(views.begin(), views.end(), [&](const sim::GateView& v) {
      return overlaps(d.corners_px, v.corners_px, 0.3);
    });
  false_alarms.tries += 1, false_alarms.hits += alarms;
}

void Statistics::print() {
  for (std::size_t i = 0; i < by_distance.size(); ++i) {
    char what[40];
    std::snprintf(what, sizeof what, "whole gate %4.1f to %4.1f m", kBin * static_cast<double>(i),
                  kBin * static_cast<double>(i + 1));
    if (by_distance[i].tries > 0) by_distance[i].print(what);
  }
  false_alarms.print("false alarms / picture");
  lower_corners.print("cut off above, below 3.3 m");
  bars.print("side bars, below 1.7 m");
  corner_u.print("corner u");
  corner_v.print("corner v");
  common_u.print("gate's middle u");
  common_v.print("gate's middle v");
  growth.print("gate's side");
  lower_u.print("lower corners u");
  lower_v.print("lower corners v");
  bar_u.print("bar u");
}

void fly(const std::string& track, std::uint64_t seed, bool ideal, Statistics& statistics) {
  const io::Config config = io::load_config(io::config_files({}));
  const io::TrackFile file = io::read_track(io::find_track(track));
  closed_loop::RaceConfig race;
  race.vision = ideal ? closed_loop::Vision::kIdeal : closed_loop::Vision::kRendered;
  race.pilot = config.pilot;
  race.pilot.track = file.track;
  race.sim = sim::drawn(io::simulator_config(config, file), file.randomize, seed);
  const sim::SolidSight sight{race.sim.world};
  std::vector<sim::BodyPose> history;
  const auto result = closed_loop::fly(race, [&](const Tick& tick) {
    history.push_back({1e-9 * static_cast<double>(tick.sensors.time.count()), tick.truth.p_EB,
                       sim::q_EB_of(tick.truth.attitude)});
    const Phase& phase = tick.pilot.phase();
    const bool looks = !std::holds_alternative<OnGround>(phase) &&
                       !std::holds_alternative<Land>(phase) &&
                       !std::holds_alternative<Landed>(phase);
    if (tick.exposed && looks)
      statistics.add(
          sim::gates_in_view(race.sim.world, race.sim.camera, sight, *tick.exposed, history),
          tick.pilot.sighting(), tick.pilot.target_gate());
    return true;
  });
  std::fprintf(stderr, "%s %llu: %s\n", track.c_str(), static_cast<unsigned long long>(seed),
               result.stop_reason.c_str());
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s TRACK FIRST_SEED RUNS [rendered|ideal]\n", argv[0]);
    return 2;
  }
  Statistics statistics;
  const std::uint64_t first = std::strtoull(argv[2], nullptr, 10),
                      runs = std::strtoull(argv[3], nullptr, 10);
  for (std::uint64_t seed = first; seed < first + runs; ++seed)
    fly(argv[1], seed, argc > 4 && std::string{argv[4]} == "ideal", statistics);
  statistics.print();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "detector_statistics: %s\n", error.what());
  return 2;
}
