// SPDX-License-Identifier: Apache-2.0
// Recorded flights give the estimates that they gave before. README.md says how to renew them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/files/csv.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/replay.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/recorded_flight.hpp"

namespace gatefly {
namespace {

namespace fs = std::filesystem;

constexpr double kPeriod = 0.2;  // of a trace [s]
struct Quantity {
  const char* name;
  double tolerance;
  double (*of)(const Estimate&);
};
// Other compilers and JPEG decoders differ by less.
constexpr double kPlace = 0.002, kSpeed = 0.004, kAngle = 0.05;  // [m], [m/s], [deg]
const std::array<Quantity, 9> kQuantities{
    {{"x_m", kPlace, [](const Estimate& e) { return e.p_EB.x(); }},
     {"y_m", kPlace, [](const Estimate& e) { return e.p_EB.y(); }},
     {"z_m", kPlace, [](const Estimate& e) { return e.p_EB.z(); }},
     {"vx_mps", kSpeed, [](const Estimate& e) { return e.v_E.x(); }},
     {"vy_mps", kSpeed, [](const Estimate& e) { return e.v_E.y(); }},
     {"vz_mps", kSpeed, [](const Estimate& e) { return e.v_E.z(); }},
     {"roll_deg", kAngle, [](const Estimate& e) { return e.attitude.roll / kDegree; }},
     {"pitch_deg", kAngle, [](const Estimate& e) { return e.attitude.pitch / kDegree; }},
     {"yaw_deg", kAngle, [](const Estimate& e) { return e.attitude.yaw / kDegree; }}}};

struct TracePoint {
  double t;
  std::array<double, kQuantities.size()> values;
};

std::vector<TracePoint> trace_of(const flight_log::ReplayResult& result) {
  std::vector<TracePoint> trace;
  for (const auto& row : result.estimates) {
    if (row.t < static_cast<double>(trace.size()) * kPeriod) continue;
    TracePoint point{.t = row.t, .values = {}};
    for (std::size_t k = 0; k < kQuantities.size(); ++k)
      point.values[k] = kQuantities[k].of(row.estimate);
    trace.push_back(point);
  }
  return trace;
}

fs::path expected(const std::string& name) {
  return support::source_folder() / "tests" / "replay" / (name + ".expected.csv");
}

void renew(const std::string& name, const std::vector<TracePoint>& trace) {
  std::string csv = "t_s";
  for (const Quantity& quantity : kQuantities) csv += std::string{","} + quantity.name;
  csv += "\n";
  for (const TracePoint& point : trace) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3f", point.t);
    csv += text.data();
    for (const double value : point.values)
      std::snprintf(text.data(), text.size(), ",%.4f", value), csv += text.data();
    csv += "\n";
  }
  files::write_file(expected(name), csv);
}

void expect_the_trace(const std::string& name, const flight_log::ReplayResult& result) {
  EXPECT_TRUE(result.finite);
  const std::vector<TracePoint> trace = trace_of(result);
  ASSERT_GT(trace.size(), 30u);
  if (std::getenv("GATEFLY_RENEW_TRACES") != nullptr) {
    renew(name, trace);
    GTEST_SKIP() << expected(name) << " is renewed";
  }
  const files::Csv csv(expected(name));
  ASSERT_EQ(csv.rows(), trace.size());
  for (std::size_t k = 0; k < kQuantities.size(); ++k) {
    const Quantity& quantity = kQuantities[k];
    const std::vector<double> column = csv.numbers(quantity.name);
    double worst = 0.0, at = 0.0;
    for (std::size_t i = 0; i < trace.size(); ++i) {
      double difference = trace[i].values[k] - column[i];
      if (quantity.tolerance == kAngle) difference = wrap_angle(difference * kDegree) / kDegree;
      if (std::abs(difference) > worst) worst = std::abs(difference), at = trace[i].t;
    }
    EXPECT_LE(worst, quantity.tolerance) << name << ", " << quantity.name << " at " << at
                                         << " s; on purpose? tests/replay/README.md";
  }
}

TEST(GoldenReplay, TheShippedSimulatedFlightGivesItsTrace) {
  const auto result =
      support::replayed_simulated(support::source_folder() / "tests" / "replay" / "oval_flight");
  EXPECT_EQ(result.gates_passed, 1);
  EXPECT_GE(std::count_if(result.pictures.begin(), result.pictures.end(),
                          [](const auto& row) { return row.sighting.fix.has_value(); }),
            10);
  expect_the_trace("oval_flight", result);
}

class GoldenRealReplay : public ::testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(GoldenRealReplay, GivesItsTrace) {
  const auto& [name, heading_offset_deg] = GetParam();
  const fs::path directory = support::real_flights() / name;
  if (!fs::exists(directory))
    GTEST_SKIP() << "no real flights at " << directory << " (set GATEFLY_DATA)";
  expect_the_trace(name, support::replayed_real(directory, heading_offset_deg));
}

// Heading offsets by `gatefly identify` and, for 11, reprojection.
INSTANTIATE_TEST_SUITE_P(TwoFlights, GoldenRealReplay,
                         ::testing::Values(std::pair{"flight_07", 18.5},
                                           std::pair{"flight_11", 11.5}),
                         [](const auto& each) { return std::string{each.param.first}; });

}  // namespace
}  // namespace gatefly
