// SPDX-License-Identifier: Apache-2.0
#include "track_list.hpp"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/config/track_file.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::cli {
namespace {

/// A track as the list has it; `wrong` when it cannot be read.
struct ShippedTrack {
  std::string name, wrong;
  int gates = 0, laps = 0;
  Eigen::Vector3d room = Eigen::Vector3d::Zero();
  std::string camera;  ///< Made for it; else the configuration's own does.
};

ShippedTrack listed(const std::string& name, const std::vector<std::string>& cameras) {
  ShippedTrack track{.name = name, .wrong = {}, .camera = {}};
  try {
    const config::TrackFile file = config::read_track(config::find_track(name));
    track.gates = static_cast<int>(file.track.gates.size());
    track.laps = file.track.laps;
    track.room = file.world.room_size;
    if (std::find(cameras.begin(), cameras.end(), name) != cameras.end()) track.camera = name;
  } catch (const std::exception& error) {
    track.wrong = files::reason_of(error);
  }
  return track;
}

std::string size_of(const ShippedTrack& track) {
  return files::text_of(track.room.x(), 3) + " x " + files::text_of(track.room.y(), 3) + " x " +
         files::text_of(track.room.z(), 3);
}

void print(const std::vector<ShippedTrack>& tracks, const std::string& camera) {
  const auto line = [](const std::string& name, const std::string& gates, const std::string& laps,
                       const std::string& room, const std::string& with) {
    std::cout << std::left << std::setw(16) << name << std::right << std::setw(5) << gates
              << std::setw(6) << laps << "  " << std::left << std::setw(18) << room << with << '\n';
  };
  line("track", "gates", "laps", "room [m]", "camera");
  for (const ShippedTrack& track : tracks) {
    if (track.wrong.empty())
      line(track.name, std::to_string(track.gates), std::to_string(track.laps), size_of(track),
           camera + (track.camera.empty() ? "" : "; made for --camera " + track.camera));
    else
      std::cout << std::left << std::setw(16) << track.name << "cannot be read: " << track.wrong
                << '\n';
  }
}

nlohmann::ordered_json as_json(const std::vector<ShippedTrack>& tracks, const std::string& camera) {
  auto list = nlohmann::ordered_json::array();
  for (const ShippedTrack& track : tracks) {
    nlohmann::ordered_json json{{"name", track.name}};
    if (track.wrong.empty()) {
      json["gates"] = track.gates;
      json["laps"] = track.laps;
      json["room_m"] = {track.room.x(), track.room.y(), track.room.z()};
      json["camera"] = track.camera.empty() ? camera : track.camera;
    } else {
      json["error"] = track.wrong;
    }
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace

int list_tracks(const CommonOptions& options, bool json) {
  const config::Config config = load(options);
  // Without a camera the defaults fly, which are the Bebop's.
  const auto named = config.set_by.find("camera.model");
  const std::string camera =
      named == config.set_by.end() ? "bebop" : named->second.substr(0, named->second.rfind(':'));
  const auto cameras = files::toml_names("cameras");
  std::vector<ShippedTrack> tracks;
  for (const std::string& name : files::toml_names("tracks"))
    tracks.push_back(listed(name, cameras));
  if (json)
    std::cout << as_json(tracks, camera).dump(2) << '\n';
  else
    print(tracks, camera);
  return kDone;
}

}  // namespace gatefly::cli
