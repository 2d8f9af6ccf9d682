// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/identification/drag_fit.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using identification::DragFit;

struct IdentifyOptions {
  CommonOptions common;
  std::vector<std::string> flights;
  std::string data;
  bool json = false;
};

struct Identified {
  std::string name;
  DragFit fit;
};

nlohmann::ordered_json as_json(const DragFit& fit) {
  return {{"k_x_1ps", fit.drag.x()},           {"k_x_sigma", fit.drag_sigma.x()},
          {"k_y_1ps", fit.drag.y()},           {"k_y_sigma", fit.drag_sigma.y()},
          {"accel_bias_x_mps2", fit.bias.x()}, {"accel_bias_y_mps2", fit.bias.y()}};
}

/// A folder of flights stands for the flights in it.
std::vector<fs::path> flight_folders(const IdentifyOptions& options) {
  std::vector<fs::path> folders;
  for (const std::string& given : options.flights) {
    const fs::path path = data_at(given, options.data);
    if (!fs::is_directory(path)) throw std::runtime_error(given + ": there is no such folder");
    if (io::log_in(path)) {
      folders.push_back(path);
      continue;
    }
    const std::size_t before = folders.size();
    for (const auto& entry : fs::directory_iterator(path))
      if (io::log_in(entry.path())) folders.push_back(entry.path());
    if (folders.size() == before)
      throw std::runtime_error(given + ": there is no log_si.csv in it, nor in its folders");
    std::sort(folders.begin() + static_cast<std::ptrdiff_t>(before), folders.end());
  }
  return folders;
}

void print(const std::vector<Identified>& all, const DragFit& mean) {
  const auto row = [](const std::string& name, const DragFit& fit, bool single) {
    std::cout << std::left << std::setw(12) << name << std::right << std::fixed
              << std::setprecision(2) << std::setw(7) << fit.drag.x() << " ± "
              << 1.96 * fit.drag_sigma.x() << std::setw(8) << fit.drag.y() << " ± "
              << 1.96 * fit.drag_sigma.y() << std::setw(8) << fit.bias.x() << std::setw(7)
              << fit.bias.y();
    if (single)
      std::cout << std::setprecision(1) << std::setw(9) << fit.heading_offset / kDegree
                << std::setprecision(2) << std::setw(9) << fit.rms;
    std::cout << '\n';
  };
  std::cout << "flight       k_x [1/s] 95 %   k_y [1/s] 95 %    bias x, y     heading   misfit\n"
               "                                                 [m/s²]           [°]      [m]\n";
  for (const Identified& one : all) row(one.name, one.fit, true);
  if (all.size() > 1) row("mean", mean, false);
}

int identify(const IdentifyOptions& options) {
  (void)load(options.common);
  std::vector<Identified> all;
  bool some_without = false;
  int unusable = 0;
  for (const fs::path& folder : flight_folders(options)) {
    std::optional<DragFit> fit;
    try {
      fit = identification::fit_drag(io::read_flight_folder(folder));
    } catch (const std::runtime_error& error) {
      ++unusable;
      std::cerr << "gatefly identify: " << io::reason_of(error) << '\n';
      continue;
    }
    const std::string name = fs::weakly_canonical(folder).filename().string();
    if (fit) {
      all.push_back({name, *fit});
    } else {
      some_without = true;
      std::cerr << "gatefly identify: " << folder.string()
                << ": no second above 0.9 m with true position, velocity and attitude; left out\n";
    }
  }
  if (all.empty()) return unusable > 0 ? kUnusable : kAnswerIsNo;
  std::vector<DragFit> fits;
  for (const Identified& one : all) fits.push_back(one.fit);
  const DragFit mean = identification::mean_of(fits);
  if (options.json) {
    nlohmann::ordered_json answer{{"mean", as_json(mean)},
                                  {"flights", nlohmann::ordered_json::array()}};
    for (const Identified& one : all) {
      nlohmann::ordered_json flight = as_json(one.fit);
      flight["flight"] = one.name, flight["heading_offset_deg"] = one.fit.heading_offset / kDegree;
      flight["misfit_m"] = one.fit.rms, flight["pieces"] = one.fit.pieces;
      answer["flights"].push_back(flight);
    }
    std::cout << io::json_text(answer);
  } else {
    print(all, mean);
  }
  return unusable > 0 ? kUnusable : some_without ? kAnswerIsNo : kDone;
}

}  // namespace

void declare_identify(Command& command) {
  auto options = std::make_shared<IdentifyOptions>();
  command.footer(
      "Example:\n  gatefly identify tudelft_bebop_flights\n\n"
      "Needs true positions and velocities (ot_*) and the autopilot's attitude (ahrs_*) in "
      "log_si.csv.\n"
      "Exit code 0: all flights identified; 1: some were not; 2: unusable arguments or log; 130: "
      "Ctrl-C.");
  command.option("DIR", options->flights, "flight folders, or folders of them").required().path();
  command
      .option("--data", options->data, "folder of real data [$GATEFLY_DATA, else ../shared/data]")
      .path("DIR");
  command.flag("--json", options->json, "numbers for programs");
  add_common(command, options->common);
  command.runs([options] { return identify(*options); });
}

}  // namespace gatefly::cli
