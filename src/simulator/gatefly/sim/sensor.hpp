// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gatefly/sim/shading.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Effects behind the lens: softness, glare, exposure, noise, clipping, colour, gamma, UYVY.
///
/// The constants are fitted by eye and by histogram to the real pictures of the Bebop: blacks at
/// about 70, whites at 235, a cyan cast, red fringes, glare around lamps.
class Sensor {
 public:
  Sensor(const world::CameraTruth& camera, const world::LightConditions& light, std::uint64_t seed);

  /// Sets the exposure for a first frame from a few radiances that are spread over the picture.
  void meter(std::span<const Float4> radiances);

  /// How long each line is exposed at present [s].
  [[nodiscard]] double exposure() const { return exposure_; }

  /// Turns a picture of radiances (stored order; spoilt) into bytes, then adapts the exposure.
  ///
  /// @param frame  with the pixel the key of its noise.
  /// @param t      when the picture was taken [s]; only differences between frames matter.
  void develop(std::uint32_t frame, double t, std::vector<Float4>& radiance,
               std::vector<std::uint8_t>& uyvy);

 private:
  void set_exposure(double brightness);
  void displace_red(std::vector<Float4>& picture) const;
  void smooth_chroma();
  void bloom(std::vector<Float4>& picture);
  void gather_glare(const std::vector<Float4>& picture);
  [[nodiscard]] Float4 glare(int x, int y) const;
  [[nodiscard]] Float4 developed(Float4 signal) const;
  [[nodiscard]] Float4 noise(std::uint32_t frame, std::uint32_t pixel) const;
  void adapt(double t, double mean);

  int width_, height_;  // stored
  int glare_width_, glare_height_;
  double longest_exposure_, target_, noise_scale_;
  float saturation_, red_shift_;
  int chroma_smoothing_;
  bool fast_;  // without bloom, fringes and glare
  Float4 tint_{};
  std::uint64_t seed_;
  double brightness_ = 1.0, exposure_, gain_ = 1.0;
  double last_t_ = 0.0;
  bool running_ = false;
  std::vector<float> vignette_;
  std::vector<Float4> line_, glare_, scratch_, chroma_;
  std::array<float, 4097> tone_{};
};

}  // namespace gatefly::sim
