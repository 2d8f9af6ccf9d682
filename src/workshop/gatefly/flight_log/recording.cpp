// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/recording.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "gatefly/files/video_reader.hpp"
#include "gatefly/files/xxh64.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::flight_log {
namespace {

bool has_height(const FlightFolder& folder) {
  return std::any_of(folder.samples.begin(), folder.samples.end(),
                     [](const FlightSample& s) { return s.sonar || s.baro; });
}

/// How upright the drone is by the log: the cosine of its tilt.
double upright(const FlightSample& sample) {
  const auto attitude = sample.true_attitude ? sample.true_attitude : sample.ahrs;
  return attitude ? rotation_EB(*attitude).matrix(2, 2) : 1.0;
}

void add_sonar(std::vector<RecordedTick>& ticks, const FlightFolder& folder,
               const SonarStandIn& sonar) {
  std::optional<double> last;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const FlightSample& sample = folder.samples[i];
    const double t = std::chrono::duration<double>(sample.time).count();
    const bool is_new = i == 0 || sample.true_p_EB != folder.samples[i - 1].true_p_EB;
    const bool is_due = !last || t >= *last + sonar.period;
    if (!sample.true_p_EB || !(sonar.period > 0.0 ? is_due : is_new)) continue;
    last = t;
    const double height = -sample.true_p_EB->z() + (sonar.noise ? sonar.noise() : 0.0);
    const double up = upright(sample);
    if (height > 0.0 && up > 0.0) ticks[i].sensors.sonar = height / up;
  }
}

/// The row in which another pilot's flight takes off: thrust is asked for, or it climbs. Ours says so
/// itself.
std::optional<std::size_t> take_off_row(const FlightFolder& folder) {
  constexpr double kClimbed = 0.10;  // [m]
  std::optional<double> ground;
  for (std::size_t i = 0; i < folder.samples.size(); ++i) {
    const FlightSample& sample = folder.samples[i];
    if (sample.est_p_EB) return std::nullopt;  // our own
    if (sample.thrust && *sample.thrust > 0.0) return i;
    const auto height = sample.true_p_EB ? std::optional{-sample.true_p_EB->z()} : sample.sonar;
    if (!height) continue;
    if (!ground) ground = height;
    if (*height - *ground > kClimbed) return i;
  }
  return std::nullopt;
}

/// A log that says when it took off rests for as long before as a pilot needs, and no longer.
void hold_until_rest(std::vector<RecordedTick>& ticks, const FlightFolder& folder) {
  constexpr std::chrono::milliseconds kRest{1300};  // as PilotLoop's
  const auto& samples = folder.samples;
  const auto off = std::find_if(samples.begin(), samples.end(),
                                [](const FlightSample& s) { return s.lifted == true; });
  const auto is_ours = [](const FlightSample& s) { return s.est_p_EB.has_value(); };
  if (off == samples.end() || std::any_of(samples.begin(), samples.end(), is_ours)) return;
  for (RecordedTick& tick : ticks) tick.held = tick.sensors.time < off->time - kRest;
}

}  // namespace

std::vector<RecordedTick> ticks_of(const FlightFolder& folder, const SonarStandIn& sonar) {
  std::vector<RecordedTick> ticks = ticks_of(folder);
  if (!has_height(folder)) add_sonar(ticks, folder, sonar);
  return ticks;
}

std::vector<RecordedTick> ticks_of(const FlightFolder& folder) {
  std::vector<RecordedTick> ticks;
  ticks.reserve(folder.samples.size());
  for (const FlightSample& sample : folder.samples)
    ticks.push_back({.sensors = {.time = sample.time,
                                 .imu = sample.imu,
                                 .navigation_imu = sample.navigation_imu,
                                 .sonar = sample.sonar,
                                 .baro = sample.baro},
                     .picture = std::nullopt,
                     .p_EB = sample.true_p_EB});
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    Sensors& sensors = ticks[i].sensors;
    sensors.looks_on = true;
    sensors.lifted = folder.samples[i].lifted.value_or(false);
    if (!folder.samples[i].motors) continue;
    sensors.motors = i > 0 ? folder.samples[i - 1].motors : std::array<double, 4>{};
  }
  if (const auto row = take_off_row(folder)) ticks[*row].sensors.lifted = true;
  hold_until_rest(ticks, folder);
  for (std::size_t i = 0; i < folder.images.size(); ++i) {
    const FlightImage& image = folder.images[i];
    if (image.log_row >= ticks.size())
      throw std::invalid_argument(image.path.string() + ": arrives in row " +
                                  std::to_string(image.log_row) + " of a log of " +
                                  std::to_string(ticks.size()));
    ticks[image.log_row].picture = i;
    ticks[image.log_row].sensors.picture_late = seconds(image.late);
  }
  return ticks;
}

namespace {

/// The lens and the mount are those of one size of picture.
void expect_size(const files::ImageFile& picture, const std::string& where, int width, int height) {
  if (picture.stored_width == width && picture.stored_height == height) return;
  throw std::runtime_error(where + std::to_string(picture.stored_width) + " x " +
                           std::to_string(picture.stored_height) + ", the camera's as stored " +
                           std::to_string(width) + " x " + std::to_string(height) +
                           " (camera.size_px)");
}

}  // namespace

PictureSource pictures_in_files(const FlightFolder& folder, int stored_width, int stored_height) {
  return [&folder, stored_width, stored_height,
          file = files::ImageFile{}](std::size_t i) mutable -> const files::ImageFile& {
    const std::filesystem::path& path = folder.images.at(i).path;
    file = files::read_image(path, stored_width, stored_height);
    expect_size(file, path.string() + ": is ", stored_width, stored_height);
    return file;
  };
}

PictureSource pictures_in_film(const FlightFolder& folder, int stored_width, int stored_height) {
  struct Film {
    std::filesystem::path path;
    std::unique_ptr<files::VideoReader> reader;
    std::size_t next = 0;
    files::ImageFile picture;
  };
  const auto film = std::make_shared<Film>();
  film->path = folder.directory / kFrameFilm;
  return [&folder, film, stored_width, stored_height](std::size_t i) -> const files::ImageFile& {
    if (!film->reader || i + 1 < film->next) {
      film->reader =
          std::make_unique<files::VideoReader>(film->path, files::VideoReader::As::kUyvy);
      film->next = 0;
    }
    for (; film->next <= i; ++film->next) {
      auto picture = film->reader->next();
      if (!picture)
        throw std::runtime_error(film->path.string() + ": ends after " +
                                 std::to_string(film->next) + " pictures, images.csv has " +
                                 std::to_string(folder.images.size()));
      expect_size(*picture, film->path.string() + ": its pictures are ", stored_width,
                  stored_height);
      film->picture = std::move(*picture);
    }
    return film->picture;
  };
}

Pictures where_pictures_are(const FlightFolder& folder) {
  if (folder.images.empty()) return Pictures::kNone;
  if (std::filesystem::exists(folder.directory / kFrameFilm)) return Pictures::kFilm;
  const auto has_hash = [](const FlightImage& image) { return image.xxh64.has_value(); };
  const auto is_there = [](const FlightImage& image) {
    return std::filesystem::exists(image.path);
  };
  const bool hashed = std::all_of(folder.images.begin(), folder.images.end(), has_hash);
  const bool kept = !hashed || std::any_of(folder.images.begin(), folder.images.end(), is_there);
  return kept ? Pictures::kFiles : Pictures::kHashes;
}

PictureSource checked(PictureSource source, const FlightFolder& folder, HashCheck& check) {
  return [source = std::move(source), &folder, &check](std::size_t i) -> const files::ImageFile& {
    const files::ImageFile& picture = source(i);
    const auto& expected = folder.images.at(i).xxh64;
    if (!expected) return picture;
    ++check.checked;
    if (files::xxh64(picture.bytes) != *expected) {
      ++check.others;
      if (!check.first_other) check.first_other = i;
    }
    return picture;
  };
}

std::function<Image(std::size_t)> upright(PictureSource source, int rotation_deg) {
  return [source = std::move(source), rotation_deg](std::size_t i) {
    return source(i).view(rotation_deg);
  };
}

}  // namespace gatefly::flight_log
