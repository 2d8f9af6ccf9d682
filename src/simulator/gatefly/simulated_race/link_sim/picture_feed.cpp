// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/picture_feed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include <sched.h>

#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/link/jpeg_slices.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::link_sim {
namespace {

constexpr int kQuality = 90;             ///< Ours; TS-002 does not say.
constexpr std::size_t kDatagram = 1400;  ///< Fits into an Ethernet frame [bytes].
constexpr std::size_t kPoses = 512;      ///< Half a second.

/// Gives this thread the normal priority. All threads of a program that `chrt` starts are real-time: one that renders for long uses up what the kernel leaves
/// to them, and physics and controller stand for up to 100 ms with it, which throws the drone over.
void let_others_go_first() {
  const sched_param normal{};
  (void)sched_setscheduler(0, SCHED_OTHER, &normal);
}

}  // namespace

PictureFeed::PictureFeed(const world::SimConfig& config, Datagrams to,
                         const NetworkTroubles& troubles, const std::function<void()>& while_baking)
    : config_{config},
      renderer_{config.world,     config.camera,       config.light, config.seed,
                config.cache_dir, config.bake_threads, while_baking},
      to_{std::move(to), troubles, {config.seed, "network"}},
      schedule_{config.seed, "camera schedule"},
      span_{config.camera.readout + config.camera.exposure},
      thread_{[this] { work(); }} {
  history_.reserve(2 * kPoses);
}

PictureFeed::~PictureFeed() {
  {
    const std::lock_guard lock{mutex_};
    over_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void PictureFeed::remember(const sim::BodyPose& pose, live::Moment start) {
  if (history_.size() == 2 * kPoses) history_.erase(history_.begin(), history_.begin() + kPoses);
  history_.push_back(pose);
  send_due();
  if (pose.t < next_start_ + span_) return;
  // Physics waits for nobody who renders: what is not free now is in a millisecond.
  const std::unique_lock lock{mutex_, std::try_to_lock};
  if (!lock) return;
  const world::SensorTruth& truth = config_.sensors;
  const double began = next_start_, jitter = std::abs(schedule_.normal_cut(truth.latency_jitter));
  const bool lost = schedule_.uniform() < truth.frame_loss;
  next_start_ += 1.0 / truth.camera_hz;
  ++frame_;
  if (lost || frozen_) return;
  const auto first = std::find_if(history_.begin(), history_.end(),
                                  [&](const sim::BodyPose& p) { return p.t > began - 0.01; });
  const auto due = std::chrono::duration<double>(began + span_ + truth.camera_latency + jitter);
  left_out_ += next_.has_value();
  next_ = Exposure{.frame = frame_,
                   .start = began,
                   .due = start + std::chrono::duration_cast<live::Clock::duration>(due),
                   .poses = {first, history_.end()}};
  wake_.notify_one();
}

void PictureFeed::work() {
  let_others_go_first();
  for (;;) {
    Exposure exposure;
    {
      std::unique_lock lock{mutex_};
      wake_.wait(lock, [this] { return over_ || next_; });
      if (over_) return;
      exposure = std::move(*next_);
      next_.reset();
    }
    Rendered picture = picture_of(exposure);
    const std::lock_guard lock{mutex_};
    rendered_.push_back(std::move(picture));
  }
}

void PictureFeed::send_due() {
  for (;;) {
    Rendered picture;
    {
      const std::unique_lock lock{mutex_, std::try_to_lock};
      if (!lock || rendered_.empty() || rendered_.front().due > live::Clock::now()) return;
      picture = std::move(rendered_.front());
      rendered_.pop_front();
    }
    send(picture);
  }
}

PictureFeed::Rendered PictureFeed::picture_of(const Exposure& exposure) {
  const world::CameraTruth& camera = config_.camera;
  renderer_.render(exposure.frame, exposure.start, exposure.poses, uyvy_);
  // As stored: who receives it knows how the camera is mounted.
  const Image stored{uyvy_.data(), PixelFormat::kUyvy, camera.stored_width, camera.stored_height,
                     0};
  Rendered picture{exposure.frame, exposure.start, exposure.due,
                   files::jpeg_of(stored, kQuality, files::ChromaSampling::k420)};
  if (live::Clock::now() > exposure.due) ++late_;
  return picture;
}

void PictureFeed::send(const Rendered& picture) {
  std::array<std::uint8_t, kDatagram> room{};
  const link::Bytes bytes{reinterpret_cast<const std::uint8_t*>(picture.jpeg.data()),
                          picture.jpeg.size()};
  const std::chrono::nanoseconds taken{std::llround(1e9 * picture.start)};
  (void)jpeg_slices::each_slice(bytes, picture.frame, taken, room,
                                [&](link::Bytes datagram) { to_.send(datagram); });
  to_.flush();
  ++sent_;
}

}  // namespace gatefly::link_sim
