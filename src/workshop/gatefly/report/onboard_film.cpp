// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/onboard_film.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "gatefly/files/subprocess.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::report {
namespace {

constexpr int kLargestFilmSide = 320;  // [px]
constexpr double kAimed = 0.9;         // of kMostBytes: the encoder does not hit its rate exactly
constexpr double kBest = 600e3;        // more shows nothing more [bit/s]
constexpr double kKeyEvery = 10;       // a jump decodes this many pictures at most

/// Side of a picture with so many pixels a line; even, as the encoder wants it.
int side_of(int pixels, int step) { return ((pixels + step - 1) / step + 1) & ~1; }

int step_of(const Image& image) {
  return (std::max(image.width(), image.height()) + kLargestFilmSide - 1) / kLargestFilmSide;
}

std::vector<std::string> vp8(double bits_per_second) {
  const std::string rate = std::to_string(static_cast<long>(bits_per_second));
  return {"-c:v",
          "libvpx",
          "-deadline",
          "good",
          "-cpu-used",
          "4",
          "-auto-alt-ref",
          "0",
          "-lag-in-frames",
          "0",
          "-g",
          std::to_string(static_cast<int>(kKeyEvery)),
          "-b:v",
          rate,
          "-maxrate",
          rate,
          "-bufsize",
          rate,
          "-pix_fmt",
          "yuv420p",
          "-an",
          "-f",
          "webm"};
}

double rate_for(double pictures) {
  const double seconds = std::max(1.0, pictures) / OnboardFilm::kRate;
  return std::min(kBest, kAimed * 8.0 * OnboardFilm::kMostBytes / seconds);
}

std::vector<std::string> coding_of(double bits_per_second) {
  std::vector<std::string> coding{"-vf", "scale=in_range=pc:out_range=tv"};
  const std::vector<std::string> encoder = vp8(bits_per_second);
  coding.insert(coding.end(), encoder.begin(), encoder.end());
  return coding;
}

/// Runs ffmpeg to its end. @return 0 when it went well
int ffmpeg(std::vector<std::string> words) {
  words.insert(words.begin(), {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y"});
  pid_t pid = -1;
  const int error = files::start(std::move(words), {}, pid);
  return error != 0 ? error : files::wait_for(pid);
}

}  // namespace

bool OnboardFilm::possible() {
  return ffmpeg({"-f", "lavfi", "-i", "color=size=16x16", "-frames:v", "1", "-c:v", "libvpx", "-f",
                 "null", "-"}) == 0;
}

OnboardFilm::OnboardFilm(std::filesystem::path path, const Image& first, double pictures)
    : path_{std::move(path)},
      width_{side_of(first.width(), step_of(first))},
      height_{side_of(first.height(), step_of(first))},
      step_{step_of(first)},
      from_width_{first.width()},
      from_height_{first.height()},
      bits_per_second_{rate_for(pictures)},
      file_{path_,
            {.pixels = "yuv444p", .width = width_, .height = height_, .per_second = kRate},
            coding_of(bits_per_second_)},
      bytes_(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

void OnboardFilm::add(const Image& picture) {
  if (picture.width() != from_width_ || picture.height() != from_height_)
    throw std::runtime_error("a picture of another size than the first");
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  const int count = (from_width_ + step_ - 1) / step_;
  std::uint8_t* y = bytes_.data();
  for (int line = 0; line < height_; ++line, y += width_) {
    const int v = std::min(line * step_, from_height_ - 1);
    std::uint8_t* at = y;
    picture.visit_row(0, v, step_, count, [&](Yuv color) {
      at[0] = color.y, at[pixels] = color.u, at[2 * pixels] = color.v;
      ++at;
    });
    if (count < width_)  // the edge, once more
      for (std::size_t plane = 0; plane < 3; ++plane) at[plane * pixels] = at[plane * pixels - 1];
  }
  file_.add(bytes_);
}

std::string OnboardFilm::finish() {
  file_.finish();
  std::string film = files::read_file(path_);
  for (int again = 0; film.size() > kMostBytes && again < 3; ++again) {
    const double part = kAimed * static_cast<double>(kMostBytes) / static_cast<double>(film.size());
    film = smaller(bits_per_second_ *= part);
  }
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  if (film.size() > kMostBytes) throw std::runtime_error("the onboard film is too large");
  return film;
}

std::string OnboardFilm::smaller(double bits_per_second) const {
  const std::string coarse = path_.string() + ".partial";
  std::vector<std::string> words{"-i", "file:" + path_.string()};
  const std::vector<std::string> encoder = vp8(bits_per_second);
  words.insert(words.end(), encoder.begin(), encoder.end());
  words.push_back("file:" + coarse);
  if (ffmpeg(std::move(words)) != 0) throw std::runtime_error("ffmpeg: the onboard film failed");
  std::string film = files::read_file(coarse);
  std::error_code ignored;
  std::filesystem::remove(coarse, ignored);
  return film;
}

}  // namespace gatefly::report
