// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/flight_inputs.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/json_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::tasks {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTrack = "track.toml";
constexpr const char* kSettings = "settings.txt";
constexpr const char* kSummary = "summary.json";
constexpr const char* kColors = "colors.toml";
constexpr const char* kTableKey = "color.table";
constexpr std::string_view kLaps = "laps=";

std::string config_name(std::size_t number) { return "config-" + std::to_string(number) + ".toml"; }

/// Lines of settings.txt, the laps apart.
struct Settings {
  std::vector<std::string> keys;
  std::optional<int> laps;
};

Settings read_settings(const fs::path& directory) {
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 20;
  Settings settings;
  if (!fs::exists(directory / kSettings)) return settings;
  std::istringstream lines(files::read_file(directory / kSettings, kMostBytes));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(kLaps)) {
      if (!line.empty()) settings.keys.push_back(line);
      continue;
    }
    int laps = 0;
    const char* const end = line.data() + line.size();
    const auto [rest, error] = std::from_chars(line.data() + kLaps.size(), end, laps);
    if (error != std::errc{} || rest != end || laps < 1 || laps > 100)
      throw std::runtime_error((directory / kSettings).string() + ": " + files::one_line(line) +
                               ", must be a whole number in 1..100");
    settings.laps = laps;
  }
  return settings;
}

/// fly's report on its flight; nothing where the file is not there or damaged: only checked
/// against.
class FlightSummary {
 public:
  explicit FlightSummary(const fs::path& directory) {
    if (!fs::exists(directory / kSummary)) return;
    try {
      summary_ = files::read_json(directory / kSummary);
    } catch (const std::runtime_error&) {
      return;
    }
    if (summary_.contains("config"))
      summary_["config"] = config::with_current_names(summary_["config"]);
  }
  /// Null where it says nothing.
  [[nodiscard]] nlohmann::json at(const std::string& pointer) const {
    const nlohmann::json::json_pointer place{pointer};
    return summary_.contains(place) ? summary_.at(place) : nlohmann::json{};
  }
  [[nodiscard]] std::optional<double> number(const std::string& pointer) const {
    const auto value = at(pointer);
    return value.is_number() ? std::optional{value.get<double>()} : std::nullopt;
  }

 private:
  nlohmann::json summary_;
};

}  // namespace

std::map<std::string, std::string> flight_inputs(const ConfigArguments& options,
                                                 const config::Config& config,
                                                 const fs::path& track, int laps) {
  std::map<std::string, std::string> inputs{{kTrack, files::read_file(track)}};
  std::size_t number = 0;
  for (const auto& given : config::config_files(options.configs))
    inputs[config_name(number++)] = files::read_file(given);
  const bool has_table = !config.gate.color_table.empty();
  if (has_table) {  // beside the last configuration, whichever file named it
    inputs[kColors] = files::read_file(config.gate.color_table);
    inputs[config_name(number)] = std::string{"[color]\ntable = \""} + kColors + "\"\n";
  }
  std::string& settings = inputs[kSettings];
  for (const auto& setting : options.settings)
    if (!has_table || setting.find(kTableKey) != setting.find_first_not_of(" \t"))
      settings += setting + "\n";
  settings += std::string{kLaps} + std::to_string(laps) + "\n";
  return inputs;
}

bool is_simulated(const fs::path& directory) {
  return fs::exists(directory / kTrack) || fs::exists(directory / kSettings);
}

void expect_whole(const fs::path& directory, const flight_log::FlightFolder& folder) {
  const FlightSummary flown(directory);
  if (flown.at("/vision") == "ideal")  // what it saw was drawn and is not kept
    throw std::runtime_error(
        directory.string() +
        ": flown with --vision ideal, has no pictures to replay; fly it with --vision rendered");
  for (const std::string& name :
       {std::string{kTrack}, std::string{kSettings}, config_name(0), std::string{"images.csv"}})
    if (!fs::exists(directory / name))
      throw std::runtime_error((directory / name).string() +
                               ": is missing, gatefly fly has put it there");
  const auto frames = flown.number("/detection/frames"), seconds = flown.number("/flight_time_s");
  if (!frames && folder.images.empty())
    throw std::runtime_error(
        (directory / "images.csv").string() +
        ": lists no picture, and summary.json does not say that there was none");
  if (frames && *frames != static_cast<double>(folder.images.size()))
    throw std::runtime_error((directory / "images.csv").string() + ": has " +
                             std::to_string(folder.images.size()) + " rows, the flight had " +
                             files::text_of(*frames) + " pictures (summary.json)");
  const double last = std::chrono::duration<double>(folder.samples.back().time).count();
  if (seconds && std::abs(*seconds - last) > 1e-6)
    throw std::runtime_error(folder.log.string() + ": ends at " + files::text_of(last, 6) +
                             " s, the flight at " + files::text_of(*seconds, 6) +
                             " s (summary.json)");
}

config::Config config_of_flight(const fs::path& directory, const ConfigArguments& user) {
  std::vector<fs::path> files;
  for (std::size_t i = 0; fs::exists(directory / config_name(i)); ++i)
    files.push_back(directory / config_name(i));
  const auto given = config::config_files(user.configs);
  files.insert(files.end(), given.begin() + 1, given.end());  // the default is the flight's own
  std::vector<std::string> settings = read_settings(directory).keys;
  try {  // the flight's own first: what is wrong in them is no --set of the user's
    (void)config::load_config(files, settings);
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    if (!what.starts_with("--set")) throw;
    throw std::runtime_error((directory / kSettings).string() + what.substr(5));
  }
  settings.insert(settings.end(), user.settings.begin(), user.settings.end());
  return config::load_config(files, settings);
}

std::optional<int> laps_of_flight(const fs::path& directory) {
  return read_settings(directory).laps;
}

std::uint64_t seed_of_flight(const fs::path& directory) {
  const fs::path file = directory / kSummary;
  // Not FlightSummary, which takes a damaged file for one that says nothing.
  nlohmann::json summary;
  if (fs::exists(file)) summary = files::read_json(file);
  const nlohmann::json seed =
      summary.is_object() ? summary.value("seed", nlohmann::json{}) : nlohmann::json{};
  if (!seed.is_number_unsigned())
    throw std::runtime_error(file.string() +
                             ": does not say the flight's seed, without which its pictures cannot "
                             "be rendered again");
  return seed.get<std::uint64_t>();
}

std::vector<MapGate> true_gates_of_flight(const fs::path& directory) {
  const nlohmann::json stood = FlightSummary{directory}.at("/true_gates");
  std::vector<MapGate> gates;
  if (!stood.is_array()) return gates;
  for (const auto& gate : stood) {
    const auto p = gate.is_object() ? gate.value("position_m", nlohmann::json{}) : nlohmann::json{};
    const auto heading = gate.is_object() ? gate.value("heading_deg", nlohmann::json{}) : p;
    const auto is_number = [](const nlohmann::json& value) { return value.is_number(); };
    if (!p.is_array() || p.size() != 3 || !std::all_of(p.begin(), p.end(), is_number) ||
        !heading.is_number())
      return {};
    MapGate& stands = gates.emplace_back();
    stands.p_EG = {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
    stands.yaw_EG = heading.get<double>() * kDegree;
  }
  return gates;
}

std::string version_of_flight(const fs::path& directory) {
  const nlohmann::json version = FlightSummary{directory}.at("/version");
  return version.is_string() ? version.get<std::string>() : "";
}

std::string difference_in(const config::Config& config, const fs::path& directory) {
  const FlightSummary flown(directory);
  const nlohmann::json now = config::as_json(config);
  for (const auto& [section, keys] : now.items()) {
    if (section == "randomize" || section == "faults") continue;  // the simulator's alone
    for (const auto& [key, value] : keys.items()) {
      const std::string name = section + "." + key;
      const nlohmann::json was = flown.at("/config/" + section + "/" + key);
      if (name != kTableKey && !was.is_null() && was != value)
        return name + " is " + files::shown(value) + ", was " + files::shown(was) + " in flight";
    }
  }
  return "";
}

}  // namespace gatefly::tasks
