// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <iostream>
#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "gatefly/closed_loop/race.hpp"
#include "gatefly/sim/randomize.hpp"
#include "gatefly/smoothing/smoother.hpp"
#include "gatefly/geometry/attitude.hpp"

#include "support/race_setup.hpp"

namespace gatefly {
namespace {

struct Row { double t; Eigen::Vector3d truth, filter, pilot; Eigen::Vector3d p_GB; int target; double nees;};

void study(std::uint64_t seed, const char* name) {
  const io::Config config = io::load_config(io::config_files({}));
  const io::TrackFile file = io::read_track(io::find_track(name));
  closed_loop::RaceConfig race;
  race.vision = closed_loop::Vision::kIdeal;
  race.pilot = config.pilot;
  race.pilot.track = file.track;
  race.pilot.filter_model = FilterModel::kOurs;
  race.sim = sim::drawn(io::simulator_config(config, file), file.randomize, seed);
  smoothing::IntakeWatch watch;
  std::vector<Row> rows;
  auto r = closed_loop::fly(race, [&](const Tick& t) {
    const auto* f = t.pilot.navigator().error_state();
    if (f && f->has_started()) {
      watch.update(*f, t.sensors.image || t.sensors.seen);
      const auto e = t.pilot.estimate();
      const Eigen::Matrix3d P = f->covariance().topLeftCorner<3,3>();
      const Eigen::Vector3d d = t.truth.p_EB - f->now().p_EB;
      rows.push_back({1e-9*double(t.sensors.time.count()), t.truth.p_EB, f->now().p_EB, e.p_EB, e.p_GB, t.pilot.target_gate(), d.dot(P.ldlt().solve(d))});
    }
    return true; });
  const auto t0 = std::chrono::steady_clock::now();
  const auto s = smoothing::smooth(watch.intake());
  const double secs = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  double ff=0, ss=0, pp=0, gf=0, gs=0, nf=0; int n=0;
  std::vector<Eigen::Vector3d> A,B,C;
  for (const Row& row : rows) {
    if (r.gate_offsets.empty() ) break;
    const auto x = smoothing::at(s, row.t);
    ff += (row.filter-row.truth).squaredNorm(); pp += (row.pilot-row.truth).squaredNorm();
    ss += (x.p_EB-row.truth).squaredNorm(); nf += row.nees/3;
    const auto& g = race.sim.world.gates[size_t(row.target)];
    const Eigen::Vector3d true_GB = rotation_z(-g.yaw_EG)*(row.truth-g.p_EG);
    gf += (row.p_GB-true_GB).squaredNorm();
    const auto& b = s.gates[size_t(row.target)];
    gs += (rotation_z(-b.yaw_EG)*(x.p_EB-b.p_EG)-true_GB).squaredNorm();
    ++n;
  }
  double ns=0; int k=0;
  for (const auto& c : s.certainties) {
    const double t = s.path[c.moment].time;
    const auto row = std::lower_bound(rows.begin(), rows.end(), t, [](const Row& a, double b){return a.t<b;});
    if (row == rows.end()) continue;
    const Eigen::Vector3d d = row->truth - s.path[c.moment].x.p_EB;
    ns += d.dot(c.P.topLeftCorner<3,3>().ldlt().solve(d))/3; ++k;
  }
  auto q=[&](double v){return std::sqrt(v/n);};
  std::cout << seed << " " << r.stop_reason << " ticks " << watch.intake().ticks.size() << " passes " << s.passes << " settled " << s.settled << " " << secs << " s; earth pilot " << q(pp) << " filter " << q(ff) << " smooth " << q(ss) << " gate " << q(gf) << " " << q(gs) << " nees/3 " << nf/n << " " << ns/k << std::endl;
}

TEST(Study, It) {
  for (int i = 1801; i <= 1808; ++i) study(i, getenv("TRACK") ? getenv("TRACK") : "showroom");
}

}  // namespace
}  // namespace gatefly
