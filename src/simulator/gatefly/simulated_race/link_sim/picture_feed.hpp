// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gatefly/live/clock.hpp"
#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/simulated_race/link_sim/datagrams.hpp"
#include "gatefly/simulated_race/link_sim/troubled_line.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::link_sim {

/// The camera of the drone: exposes at its rate, renders in a thread of its own, and sends each picture when it is due, as slices
/// of a JPEG [TS-002].
///
/// While a picture is rendered the newest one waits; one that a newer one has replaced is left out, and counted. The slices' stamps
/// are of the exposure: they tell how late each is.
class PictureFeed {
 public:
  /// @param while_baking  may throw to stop. @throws std::runtime_error as CameraRenderer does.
  PictureFeed(const world::SimConfig& config, Datagrams to, const NetworkTroubles& troubles,
              const std::function<void()>& while_baking);
  ~PictureFeed();
  PictureFeed(const PictureFeed&) = delete;
  PictureFeed& operator=(const PictureFeed&) = delete;

  /// The body's pose, after every step of the physics, whose time 0 was at `start`; sends the pictures that are due.
  void remember(const sim::BodyPose& pose, live::Moment start);
  /// No more pictures, as of a camera that hangs.
  void freeze() { frozen_ = true; }
  [[nodiscard]] long sent() const { return sent_; }
  [[nodiscard]] long left_out() const { return left_out_; }
  /// Sent later than they were due, because rendering took too long.
  [[nodiscard]] long late() const { return late_; }

 private:
  struct Exposure {
    std::uint32_t frame = 0;
    double start = 0.0;  ///< [s]
    live::Moment due;
    std::vector<sim::BodyPose> poses;
  };
  /// A picture on its way.
  struct Rendered {
    std::uint32_t frame = 0;
    double start = 0.0;  ///< [s]
    live::Moment due;
    std::string jpeg;
  };
  void work();
  [[nodiscard]] Rendered picture_of(const Exposure& exposure);
  void send(const Rendered& picture);
  void send_due();

  world::SimConfig config_;
  sim::CameraRenderer renderer_;
  TroubledLine to_;
  sim::Stream schedule_;
  double span_, next_start_ = 0.2;
  std::uint32_t frame_ = 0;
  std::vector<sim::BodyPose> history_;
  std::vector<std::uint8_t> uyvy_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Exposure> next_;
  std::deque<Rendered> rendered_;  ///< Not yet sent.
  bool over_ = false, frozen_ = false;
  std::atomic<long> sent_ = 0, left_out_ = 0, late_ = 0;
  std::thread thread_;
};

}  // namespace gatefly::link_sim
