// SPDX-License-Identifier: Apache-2.0
// Our AHRS, as flown, beside a plain Mahony filter: hand-held with a true attitude, in turns, on
// real flights.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "gatefly/baseline/imu15.hpp"
#include "gatefly/baseline/mahony.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/experiments/attitude_trial.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/files/csv.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/identification/drag_fit.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kShown = 0.1;           // between two points of a plot [s]
constexpr double kBeforeMovement = 1.0;  // the rest ends so long before it [s]
constexpr double kLogRest = 0.7;         // of every flight's log, before the motors start [s]
// as gates give them [s], [m], [rad]
constexpr double kCorrections = 1.0 / 15, kAltitudeSigma = 0.05, kHeadingSigma = 0.05;
constexpr double kReferenceSigma = 0.01;  // of a position of motion capture [m]
constexpr double kLeastFlight = 3.0;      // to be scored [s]
constexpr double kWithin95 = 2.4477;      // of two errors, in σ

/// Squared errors [rad²] and what was claimed.
struct Errors {
  double square = 0.0, claimed = 0.0, most = 0.0;
  int n = 0, within = 0;

  void add(double error, double sigma) {
    square += error * error, claimed += sigma * sigma, most = std::max(most, std::abs(error)), ++n;
    within += std::abs(error) < kWithin95 * sigma;
  }
  [[nodiscard]] double rms_deg() const { return std::sqrt(square / n) / kDegree; }
  [[nodiscard]] double claimed_deg() const { return std::sqrt(2.0 * claimed / n) / kDegree; }
};

std::string degrees(double value) { return io::text_of(value, 3) + "°"; }

/// Both errors [deg] over time, ours and Mahony's.
struct Trace {
  explicit Trace(std::string title, std::string y = "inclination error [°]")
      : plot{.title = std::move(title),
             .x_label = "time [s]",
             .y_label = std::move(y),
             .series = {{.name = "Mahony, Kp 0.5", .color = io::kLight.gate_solid},
                        {.name = "ours, as flown"}},
             .y_from_0 = false} {}

  void add(double t, double ours, double mahony) {
    if (t < next) return;
    next = t + kShown;
    plot.series[0].points.emplace_back(t, mahony / kDegree),
        plot.series[1].points.emplace_back(t, ours / kDegree);
  }

  io::Plot plot;
  double next = -1.0;
};

// ---- hand-held, with a true attitude (BROAD) ----

struct Held {
  double t = 0.0;
  Imu imu;
  Eigen::Vector3d up_B = Eigen::Vector3d::Zero();
  bool moves = false;
};

// The sensor's axes are like ENU where ours are like NED: y and z change sign.
std::vector<Held> read_held(const fs::path& file) {
  const io::Csv csv(file);
  const auto column = [&](const char* name) { return csv.numbers(name); };
  const auto t = column("t_s"), moves = column("movement");
  const std::array gyro{column("gyr_x_radps"), column("gyr_y_radps"), column("gyr_z_radps")};
  const std::array accel{column("acc_x_mps2"), column("acc_y_mps2"), column("acc_z_mps2")};
  const std::array q{column("opt_qw"), column("opt_qx"), column("opt_qy"), column("opt_qz")};
  std::vector<Held> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (i > 0 && !(t[i] > t[i - 1]))
      throw std::runtime_error(csv.place(i, "t_s") + ": time must grow");
    Held row;
    row.t = t[i], row.moves = moves[i] == 1.0;
    row.imu = {{gyro[0][i], -gyro[1][i], -gyro[2][i]}, {accel[0][i], -accel[1][i], -accel[2][i]}};
    if (!row.imu.gyro_B.allFinite() || !row.imu.accel_B.allFinite())
      throw std::runtime_error(csv.place(i) + ": a number is missing");
    const Eigen::Vector3d up =
        Eigen::Quaterniond{q[0][i], q[1][i], q[2][i], q[3][i]}.normalized().inverse() *
        Eigen::Vector3d::UnitZ();
    row.up_B = {up.x(), -up.y(), -up.z()};
    rows.push_back(row);
  }
  if (std::none_of(rows.begin(), rows.end(), [](const Held& row) { return row.moves; }))
    throw std::runtime_error(file.string() + ": no row has movement 1");
  return rows;
}

double inclination_error(const RotationEB& R, const Eigen::Vector3d& up_B) {
  const Eigen::Vector3d up = -R.matrix.row(2).transpose();
  return std::atan2(up.cross(up_B).norm(), up.dot(up_B));
}

struct HeldErrors {
  Errors ours, mahony;
  Trace trace;
};

HeldErrors held(const fs::path& file) {
  const std::vector<Held> rows = read_held(file);
  const double moved =
      std::find_if(rows.begin(), rows.end(), [](const Held& row) { return row.moves; })->t;
  HeldErrors result{{}, {}, Trace(file.stem().string())};
  Navigator ours{{}};
  baseline::Mahony mahony;
  ours.start(Eigen::Vector3d::Zero(), 0.0);
  double before = rows.front().t;
  for (const Held& row : rows) {
    const double dt = row.t - before;
    before = row.t;
    if (row.t < moved - kBeforeMovement)
      ours.rest(row.imu, row.t);
    else
      ours.predict_attitude(row.imu, row.t);
    mahony.update(row.imu, dt);
    if (!row.moves || !row.up_B.allFinite()) continue;
    const double e = inclination_error(ours.ahrs().R_EB(), row.up_B),
                 m = inclination_error(mahony.R_EB(), row.up_B);
    result.ours.add(e, ours.ahrs().tilt_sigma()), result.mahony.add(m, 0.0);
    result.trace.add(row.t, e, m);
  }
  return result;
}

// ---- simulated coordinated turns ----

struct Turns {
  Errors ours, mahony;  ///< Of roll, while turning.
  Trace trace{"Coordinated turns, r 1.5 m, 1.6 m/s, seed 1", "roll error [°]"};
};

Turns turns(const TurnCourse& course, int seeds) {
  Turns result;
  for (int seed = 1; seed <= seeds; ++seed) {
    Navigator ours{{}};
    baseline::Mahony mahony;
    double t = 0.0, next = 0.0;
    for (const Moment& moment : coordinated_turns(course, static_cast<std::uint64_t>(seed))) {
      if (t == 0.0) ours.start({0, 0, moment.z}, 0.0);
      t += moment.dt;
      if (moment.rests)
        ours.rest(moment.imu, t);
      else
        ours.predict(moment.imu, t);
      if (t >= next) ours.correct_height(-moment.z, kAltitudeSigma), next = t + kCorrections;
      mahony.update(moment.imu, moment.dt);
      const double e = ours.ahrs().attitude().roll - moment.truth.roll,
                   m = mahony.attitude().roll - moment.truth.roll;
      if (moment.turns) result.ours.add(e, ours.ahrs().tilt_sigma()), result.mahony.add(m, 0.0);
      if (seed == 1) result.trace.add(t, e, m);
    }
  }
  return result;
}

// ---- real flights ----

/// Roll and pitch beside the reference; a constant difference (pad, bias, mounting) is told apart.
struct Differences {
  std::vector<Eigen::Vector2d> all;

  void add(const Attitude& a, const Attitude& reference) {
    all.emplace_back(a.roll - reference.roll, a.pitch - reference.pitch);
  }
  [[nodiscard]] Eigen::Vector2d offset() const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const auto& d : all) sum += d;
    return sum / static_cast<double>(all.size());
  }
  [[nodiscard]] double rms_deg() const {
    double sum = 0.0;
    for (const auto& d : all) sum += (d - offset()).squaredNorm();
    return std::sqrt(0.5 * sum / static_cast<double>(all.size())) / kDegree;
  }
};

struct Flown {
  std::string name;
  Differences ours, mahony, authors;
  double reference_sigma_deg = 0.0;
  Trace trace;
};

// What motion capture's positions say about the tilt: an inertial filter that is told all of them.
Flown flown(const std::string& name, const io::FlightFolder& flight, double heading_offset) {
  const auto rows = identification::airborne(flight);
  Flown result{name, {},  {},
               {},   0.0, Trace(name + ", beside motion capture", "roll difference [°]")};
  const auto yaw_of = [&](const io::FlightSample& s) {
    return wrap_angle(s.ahrs->yaw + heading_offset);
  };
  Navigator ours{{}};
  baseline::Mahony mahony;
  mahony.start({0.0, 0.0, yaw_of(flight.samples.front())});
  baseline::Imu15 reference{{}};
  double before = 0.0, next = kLogRest;
  Eigen::Vector3d last_p = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rows.last; ++i) {
    const io::FlightSample& s = flight.samples[i];
    const double t = seconds(s.time), dt = i > 0 ? t - before : 0.0;
    before = t;
    if (!s.true_p_EB || !s.ahrs) continue;
    mahony.update(s.imu, dt);
    if (t < kLogRest) {
      if (ours.time() == 0.0) ours.start(*s.true_p_EB, yaw_of(flight.samples.front()));
      ours.rest(s.imu, t);
      reference.start(*s.true_p_EB, {s.ahrs->roll, s.ahrs->pitch, yaw_of(s)},
                      ours.ahrs().accel_bias(), ours.ahrs().gyro_bias());
      continue;
    }
    ours.predict(s.imu, t);
    reference.predict(s.imu, dt);
    if (*s.true_p_EB != last_p)
      reference.correct_position(*s.true_p_EB, Eigen::Vector3d::Constant(kReferenceSigma)),
          last_p = *s.true_p_EB;
    if (t >= next) {
      next = t + kCorrections;
      reference.correct_heading(yaw_of(s), kHeadingSigma);
      ours.correct_height(-s.true_p_EB->z(), kAltitudeSigma);
      ours.correct_heading(wrap_angle(yaw_of(s) - ours.ahrs().attitude().yaw),
                           kHeadingSigma * kHeadingSigma);
    }
    if (i < rows.first) continue;
    const Attitude truth = reference.attitude();
    result.ours.add(ours.ahrs().attitude(), truth), result.mahony.add(mahony.attitude(), truth),
        result.authors.add(*s.ahrs, truth);
    result.trace.add(t, ours.ahrs().attitude().roll - truth.roll,
                     mahony.attitude().roll - truth.roll);
    result.reference_sigma_deg =
        std::sqrt(reference.covariance()(baseline::Imu15::kTheta, baseline::Imu15::kTheta)) /
        kDegree;
  }
  return result;
}

struct Report {
  Result result{.table = {},
                .json = {},
                .csv = "kind,name,ours_rms_deg,mahony_rms_deg,authors_rms_deg,ours_claimed_deg\n",
                .picture = io::Canvas(1, 1)};
  std::vector<io::Plot> plots;

  void row(const std::string& kind, const std::string& name, double ours, double mahony,
           const std::string& authors, const std::string& claimed) {
    result.csv += kind + "," + name + "," + io::text_of(ours, 4) + "," + io::text_of(mahony, 4) +
                  "," + authors + "," + claimed + "\n";
    result.table.push_back({name, "",
                            degrees(ours) + " (Mahony " + degrees(mahony) +
                                (authors.empty() ? "" : ", autopilot " + authors + "°") + ")"});
  }
};

void add_held(Report& report, const fs::path& folder, const Options& options) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  if (files.empty()) throw std::runtime_error(folder.string() + ": there is no CSV file in it");
  std::sort(files.begin(), files.end());
  auto& json = report.result.json["broad"] = ordered_json::object();
  for (const fs::path& file : files) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.1, file.stem().string());
    const HeldErrors c = held(file);
    json[file.stem().string()] = {{"inclination_rmse_deg", c.ours.rms_deg()},
                                  {"mahony_rmse_deg", c.mahony.rms_deg()},
                                  {"max_deg", c.ours.most / kDegree},
                                  {"claimed_rms_deg", c.ours.claimed_deg()},
                                  {"within_95", static_cast<double>(c.ours.within) / c.ours.n}};
    report.row("broad", file.stem().string(), c.ours.rms_deg(), c.mahony.rms_deg(), "",
               io::text_of(c.ours.claimed_deg(), 4));
    report.plots.push_back(c.trace.plot);
  }
}

void add_turns(Report& report, const Options& options) {
  const int seeds = options.quick ? 4 : 20;
  auto& json = report.result.json["turns"] = {
      {"radius_m", TurnCourse{}.radius}, {"speed_mps", TurnCourse{}.speed}, {"seeds", seeds}};
  for (const int in_a_row : {1, 4}) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.4, "turns");
    const Turns t = turns({.turns = in_a_row, .level = "race"}, seeds);
    const std::string name = in_a_row == 1 ? "one" : "four";
    const double claimed = t.ours.claimed_deg() / std::sqrt(2.0);
    json[name] = {{"roll_rmse_deg", t.ours.rms_deg()},
                  {"roll_max_deg", t.ours.most / kDegree},
                  {"mahony_rmse_deg", t.mahony.rms_deg()},
                  {"mahony_max_deg", t.mahony.most / kDegree},
                  {"claimed_deg", claimed}};
    report.row("turns", "roll, " + name + " of 180°, " + std::to_string(seeds) + " seeds",
               t.ours.rms_deg(), t.mahony.rms_deg(), "", io::text_of(claimed, 4));
    report.result.table.push_back(
        {"  at most", "",
         degrees(t.ours.most / kDegree) + " (Mahony " + degrees(t.mahony.most / kDegree) + ")"});
    if (in_a_row == 4) report.plots.push_back(t.trace.plot);
  }
}

void add_flights(Report& report, const fs::path& folder, const Options& options) {
  std::vector<fs::path> flights;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with("flight_"))
      flights.push_back(entry.path());
  if (flights.empty())
    throw std::runtime_error(folder.string() + ": there is no folder flight_* in it");
  std::sort(flights.begin(), flights.end());
  auto& json = report.result.json["flights"] = ordered_json::object();
  io::Plot plot{.title = "Real flights: roll and pitch, RMS",
                .x_label = "number of the flight",
                .y_label = "difference to motion capture [°]"};
  plot.series = {
      {.name = "Mahony, Kp 0.5", .color = io::kLight.gate_solid, .line = false},
      {.name = "ours, as flown", .line = false},
      {.name = "the Bebop's autopilot", .color = io::kLight.flown, .line = false, .rings = true}};
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (options.stopped()) throw Stopped{};
    const std::string name = flights[i].filename().string();
    options.progress(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(flights.size()),
                     name);
    const io::FlightFolder flight = io::read_flight_folder(flights[i]);
    const auto fit = identification::fit_drag(flight);
    if (!fit) continue;
    const Flown f = flown(name, flight, fit->heading_offset);
    if (static_cast<double>(f.ours.all.size()) < 512.0 * kLeastFlight) continue;
    const auto told = [](const Differences& d) {
      return ordered_json{{"rms_deg", d.rms_deg()},
                          {"offset_deg", {d.offset().x() / kDegree, d.offset().y() / kDegree}}};
    };
    json[name] = {{"ours", told(f.ours)},
                  {"mahony", told(f.mahony)},
                  {"autopilot", told(f.authors)},
                  {"reference_sigma_deg", f.reference_sigma_deg}};
    report.row("flight", name, f.ours.rms_deg(), f.mahony.rms_deg(),
               io::text_of(f.authors.rms_deg(), 3), "");
    const double number = std::stod("0" + name.substr(std::string("flight_").size()));
    plot.series[0].points.emplace_back(number, f.mahony.rms_deg()),
        plot.series[1].points.emplace_back(number, f.ours.rms_deg());
    plot.series[2].points.emplace_back(number, f.authors.rms_deg());
    if (report.plots.size() == 4) report.plots.push_back(f.trace.plot);
  }
  report.plots.push_back(plot);
}

}  // namespace

Result ahrs_real(const Options& options) {
  const fs::path held_folder = data_folder("broad_ahrs", options),
                 flights = data_folder("tudelft_bebop_flights", options);
  Report report;
  add_held(report, held_folder, options);
  add_turns(report, options);
  add_flights(report, flights, options);
  report.result.picture = io::draw_sheet(report.plots, 2);
  return std::move(report.result);
}

}  // namespace gatefly::experiments
