// SPDX-License-Identifier: Apache-2.0
// pack_flight FOLDER TAPE OUTPUTS FROM_US TRACK [CONFIG | section.key=value]...
//
// A recorded flight as one file that a program without libraries can read (fly_tape.c), its stamps in
// whole microseconds from FROM_US on; and what the pilot in C++ makes of it, tick after tick.
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "gatefly/config/pilot_files.hpp"
#include "gatefly/files/csv.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/race/pilot.hpp"

namespace {

using namespace gatefly;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <class Value>
void put(std::ostream& file, Value value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

/// UYVY of a picture with a colour for each pixel: of two neighbours the first one's.
std::vector<std::uint8_t> uyvy_of(const gatefly::files::ImageFile& picture) {
  if (picture.format == PixelFormat::kUyvy) return picture.bytes;
  const Image stored = picture.view(0);
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < stored.height(); ++v)
    for (int u = 0; u + 1 < stored.width(); u += 2) {
      const Yuv left = stored.at(u, v), right = stored.at(u + 1, v);
      bytes.insert(bytes.end(), {left.u, left.y, left.v, right.y});
    }
  return bytes;
}

struct Tick {
  std::uint64_t time_us;
  Sensors sensors;
  std::int64_t picture;
};

void write_tape(std::ostream& file, const std::vector<Tick>& ticks, std::uint32_t width,
                std::uint32_t height, const std::vector<std::vector<std::uint8_t>>& pictures) {
  file.write("GFTAPE1", 8);
  for (const auto count : {static_cast<std::uint32_t>(ticks.size()),
                           static_cast<std::uint32_t>(pictures.size()), width, height})
    put(file, count);
  for (const Tick& tick : ticks) {
    const Sensors& s = tick.sensors;
    put(file, tick.time_us), put(file, tick.picture);
    for (int i = 0; i < 3; ++i) put(file, s.imu.gyro_B[i]);
    for (int i = 0; i < 3; ++i) put(file, s.imu.accel_B[i]);
    put(file, s.sonar.value_or(kNone)), put(file, s.baro.value_or(kNone));
    put(file, s.looks_on ? 1.0 : 0.0), put(file, s.lifted ? 1.0 : 0.0);
    for (std::size_t i = 0; i < 4; ++i) put(file, s.motors ? (*s.motors)[i] : kNone);
  }
  for (const auto& picture : pictures)
    file.write(reinterpret_cast<const char*>(picture.data()),
               static_cast<std::streamsize>(picture.size()));
}

void write_outputs(std::ostream& file, const Command& c, const Pilot& pilot) {
  const Estimate e = pilot.estimate();
  for (const double value : {c.attitude.roll, c.attitude.pitch, c.attitude.yaw, c.attitude.yaw_rate,
                             c.attitude.thrust, c.motors[0], c.motors[1], c.motors[2], c.motors[3]})
    put(file, value);
  for (const Eigen::Vector3d& value : {c.rates_B, e.p_EB, e.v_E})
    for (int i = 0; i < 3; ++i) put(file, value[i]);
  for (const double value : {e.attitude.roll, e.attitude.pitch, e.attitude.yaw}) put(file, value);
  for (int i = 0; i < 3; ++i) put(file, e.p_GB[i]);
  for (int i = 0; i < 3; ++i) put(file, std::sqrt(std::max(0.0, e.covariance_GB(i, i))));
  put(file, static_cast<double>(pilot.phase().index())),
      put(file, static_cast<double>(e.gates_passed));
}

gatefly::config::PilotSources sources(const std::vector<std::string>& arguments) {
  gatefly::config::PilotSources from;
  from.track = arguments.front();
  for (std::size_t i = 1; i < arguments.size(); ++i)
    (arguments[i].find('=') == std::string::npos ? from.configs : from.settings)
        .push_back(arguments[i]);
  return from;
}

void pack(const std::vector<std::string>& arguments) {
  const gatefly::config::PilotFiles files =
      gatefly::config::read_pilot_files(sources({arguments.begin() + 4, arguments.end()}));
  const gatefly::flight_log::FlightFolder folder =
      gatefly::flight_log::read_flight_folder(arguments[0]);
  const std::uint64_t from = std::stoull(arguments[3]);

  std::vector<std::vector<std::uint8_t>> pictures;
  const auto source =
      flight_log::where_pictures_are(folder) == flight_log::Pictures::kFilm
          ? flight_log::pictures_in_film(folder, files.stored_width, files.stored_height)
          : flight_log::pictures_in_files(folder, files.stored_width, files.stored_height);
  std::vector<Tick> ticks;
  for (const auto& recorded : flight_log::ticks_of(folder, flight_log::SonarStandIn{})) {
    Tick tick{from + static_cast<std::uint64_t>((recorded.sensors.time.count() + 500) / 1000),
              recorded.sensors, -1};
    if (recorded.picture) {
      tick.picture = static_cast<std::int64_t>(pictures.size());
      pictures.push_back(uyvy_of(source(*recorded.picture)));
    }
    ticks.push_back(tick);
  }
  std::ofstream tape{arguments[1], std::ios::binary}, outputs{arguments[2], std::ios::binary};
  write_tape(tape, ticks, static_cast<std::uint32_t>(files.stored_width),
             static_cast<std::uint32_t>(files.stored_height), pictures);

  Pilot pilot{files.pilot};
  for (const Tick& tick : ticks) {
    Sensors sensors = tick.sensors;
    sensors.time = std::chrono::microseconds{tick.time_us};
    if (tick.picture >= 0)
      sensors.image =
          Image{pictures[static_cast<std::size_t>(tick.picture)].data(), PixelFormat::kUyvy,
                files.stored_width, files.stored_height, files.stored_rotation_deg};
    const Command command = pilot.step(sensors);
    write_outputs(outputs, command, pilot);
  }
  if (!tape.flush() || !outputs.flush()) throw std::runtime_error("cannot write the tape");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 6) throw std::runtime_error("usage: see pack_flight.cpp");
  pack({argv + 1, argv + argc});
} catch (const std::exception& error) {
  return std::cerr << error.what() << '\n', 2;
}
