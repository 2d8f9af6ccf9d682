// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/foreign_logs/imported_folder.hpp"
#include "gatefly/flight_log/foreign_logs/plausibility.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using files::fixed;
using foreign_logs::CopiedPictures;
using foreign_logs::ForeignFlight;
using foreign_logs::Plausibility;

constexpr const char* kMappings = "configs/import";

struct ImportOptions {
  CommonOptions common;
  std::string log, mapping, out, pictures, track;
  std::optional<double> clock_offset_s, delay_ms;
  std::optional<int> laps;
  bool json = false;
};

/// The mapping that a log's name asks for.
std::string usual_mapping(const fs::path& log) {
  std::error_code error;
  if (fs::is_directory(log, error)) return "ros-folder";
  std::string ending = log.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (ending == ".csv") return "betaflight-blackbox";
  if (ending == ".ulg") return "px4-ulog";
  if (ending == ".bbl" || ending == ".bfl")
    throw std::runtime_error(log.string() +
                             ": is a blackbox as it was recorded; its table is what Betaflight's "
                             "blackbox_decode makes of it");
  if (ending == ".bag" || ending == ".db3" || ending == ".mcap")
    throw std::runtime_error(log.string() +
                             ": is a bag; extract it to a folder with imu.csv and images/");
  throw std::runtime_error(log.string() + ": what wrote it? Say so by --mapping (there are: " +
                           files::joined(files::toml_names(kMappings)) + ")");
}

/// Track and configuration for the folder; the rate of the IMU is the log's, unless somebody says another.
std::map<std::string, std::string> inputs_of(const ImportOptions& options, double hz) {
  if (options.track.empty()) return {};
  const fs::path file = config::find_track(options.track);
  CommonOptions given = options.common;
  const config::Config config = load(given);
  const config::TrackFile track = config::read_track(file, config.gate);
  const auto sets_rate = [](const std::string& setting) {
    return setting.find("vehicle.imu_hz") != std::string::npos;
  };
  const bool said = std::any_of(given.settings.begin(), given.settings.end(), sets_rate);
  constexpr double kSame = 0.02;
  if (!said && std::abs(config.pilot.imu_hz / hz - 1.0) > kSame)
    given.settings.push_back("vehicle.imu_hz=" + files::text_of(hz, 4));
  const config::Config flown = config::on_course(load(given), track);
  return tasks::flight_inputs(given, flown, file, options.laps.value_or(track.track.laps));
}

nlohmann::ordered_json summary_of(const ImportOptions& options, const fs::path& mapping,
                                  const ForeignFlight& flight, const Plausibility& found,
                                  const CopiedPictures& pictures) {
  nlohmann::ordered_json told{{"kind", "import"},
                              {"log", fs::path{options.log}.filename().string()},
                              {"mapping", mapping.filename().string()},
                              {"version", GATEFLY_VERSION},
                              {"flight_time_s", flight.seconds()},
                              {"rows", flight.times.size()},
                              {"imu_hz", flight.hz()},
                              {"detection", {{"frames", pictures.copied}}},
                              {"pictures_outside", flight.pictures_outside},
                              {"pictures_unreadable", pictures.unreadable.size()},
                              {"checked", found.checked},
                              {"not_checked", found.unknown},
                              {"notes", flight.notes}};
  for (const auto& [column, source] : flight.sources) told["columns"][column] = source;
  return told;
}

void print(const ImportOptions& options, const ForeignFlight& flight, const Plausibility& found,
           const CopiedPictures& pictures) {
  const auto line = [](const char* name, const std::string& text) {
    std::cout << "  " << std::left << std::setw(14) << name << text << '\n';
  };
  std::cout << options.log << ": " << files::amount(flight.times.size(), "row") << ", "
            << fixed(flight.seconds(), 1) << " s, IMU at " << fixed(flight.hz(), 0) << " Hz\n";
  std::vector<std::string> beside;
  for (const auto& [column, source] : flight.sources)
    if (!column.starts_with("gyro_") && !column.starts_with("acc_")) beside.push_back(column);
  if (!beside.empty()) line("also", files::joined(beside));
  line("pictures",
       std::to_string(pictures.copied) + (flight.pictures_outside > 0
                                              ? ", " + std::to_string(flight.pictures_outside) +
                                                    " before or after the log left out"
                                              : ""));
  for (const std::string& text : found.checked) line("checked", text);
  for (const std::string& text : found.unknown) line("not checked", text);
  line("files", (fs::path{options.out} / "").string());
}

/// gatefly import: exit 0 done, 2 unusable input, or pictures that could not be read; 130 Ctrl-C.
int import(const ImportOptions& options) {
  const fs::path mapping_file = files::find_toml(
      options.mapping.empty() ? usual_mapping(options.log) : options.mapping, kMappings);
  foreign_logs::check_import_folder(options.out);
  const foreign_logs::Mapping mapping = foreign_logs::read_mapping(mapping_file);
  const ForeignFlight flight =
      foreign_logs::read_foreign_log(mapping, options.log,
                                     {.pictures = options.pictures,
                                      .clock_offset_s = options.clock_offset_s,
                                      .delay_ms = options.delay_ms});
  const Plausibility found = foreign_logs::plausibility_of(flight);
  if (!found.wrong.empty())
    throw std::runtime_error(options.log + ": " + files::joined(found.wrong, "; ") + " (" +
                             mapping_file.string() + " says units, axes and signs)");
  const auto inputs = inputs_of(options, flight.hz());
  catch_interrupt();
  nlohmann::ordered_json told;
  const CopiedPictures pictures = foreign_logs::write_imported(
      flight, options.out, inputs,
      [&](const CopiedPictures& copied) {
        told = summary_of(options, mapping_file, flight, found, copied);
        return files::json_text(told);
      },
      stop_if_interrupted);
  for (const std::string& note : flight.notes) std::cerr << "gatefly import: " << note << '\n';
  for (const std::string& picture : pictures.unreadable)
    std::cerr << "gatefly import: left out: " << picture << '\n';
  if (options.json)
    std::cout << files::json_text(told);
  else if (!options.common.quiet)
    print(options, flight, found, pictures);
  return pictures.unreadable.empty() ? kDone : kUnusable;
}

}  // namespace

void declare_import(Command& command) {
  auto options = std::make_shared<ImportOptions>();
  command.footer(
      "Example:\n  gatefly import LOG00001.01.csv --out out/flight      # then: gatefly replay "
      "out/flight --track mine.toml\n"
      "  gatefly import flight.ulg --pictures cam0 --clock-offset-s -1.25 --track oval --out "
      "out/flight\n\n"
      "The mapping file says which column is what, in which unit, along which axis. What cannot be "
      "so is refused: an\n"
      "accelerometer that does not read 9.81 m/s^2 upwards at rest, a gyro that turns otherwise "
      "than the log's attitude.\n"
      "Exit code 0: done; 2: unusable arguments or log, nothing is written; or pictures that could "
      "not be read were\n"
      "left out; 130: Ctrl-C.");
  command
      .option("LOG", options->log,
              "a table (Betaflight's blackbox_decode), PX4's ULog, or the extracted folder of a "
              "ROS bag")
      .required()
      .path();
  command.option("--out", options->out, "folder for the flight").required().path("DIR");
  command
      .option("--mapping", options->mapping,
              "a name in configs/import/ or a file [by the log's name: .csv betaflight-blackbox, "
              ".ulg px4-ulog, a folder ros-folder]")
      .path("FILE");
  command
      .option("--pictures", options->pictures,
              "folder of pictures with their stamps in their names [the mapping's]")
      .path("DIR");
  command
      .option("--clock-offset-s", options->clock_offset_s,
              "from the pictures' clock to the log's: what is added to a picture's stamp")
      .type_name("S");
  command
      .option(
          "--delay-ms", options->delay_ms,
          "from a picture's stamp to its arrival at the pilot; 0: it is stamped when it arrives")
      .between(0.0, 10000.0);
  command
      .option("--track", options->track,
              "kept in the folder with --config and --set, so that replay takes them from there")
      .path("FILE");
  command.option("--laps", options->laps, "instead of the track's own number").between(1, 100);
  command.flag("--json", options->json, "print summary.json instead of a screen");
  add_common(command, options->common);
  command.runs([options] { return import(*options); });
}

}  // namespace gatefly::cli
