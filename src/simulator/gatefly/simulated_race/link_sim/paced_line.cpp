// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/paced_line.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>

#include <poll.h>

#include "gatefly/live/port.hpp"

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

/// One direction: what it may carry grows with time, ten bits a byte, and what is not used is lost.
class Direction {
 public:
  Direction(live::Port& from, live::Port& to, int baud, StickGaps* watch = nullptr)
      : from_{from}, to_{to}, bytes_per_second_{baud / 10.0}, watch_{watch} {}

  /// False when an end is gone.
  bool carry(double elapsed) {
    constexpr double kHeld = 0.01;  // what a UART's buffer evens out [s]
    allowed_ =
        std::min(allowed_ + elapsed * bytes_per_second_, std::max(1.0, kHeld * bytes_per_second_));
    std::array<std::uint8_t, 4096> room{};
    const auto most = std::min(room.size(), static_cast<std::size_t>(allowed_));
    if (most == 0) return true;
    const auto got = from_.read(std::span{room}.first(most), live::Clock::now());
    if (!got) return false;
    allowed_ -= static_cast<double>(*got);
    if (watch_ != nullptr) watch_->take(link::Bytes{room}.first(*got), live::Clock::now());
    return *got == 0 || to_.write(link::Bytes{room}.first(*got), live::Clock::now() + 10ms);
  }

 private:
  live::Port &from_, &to_;
  double bytes_per_second_, allowed_ = 0.0;
  StickGaps* watch_;
};

}  // namespace

void StickGaps::take(link::Bytes bytes, live::Moment now) {
  const std::lock_guard lock{mutex_};
  stream_.feed(bytes, [&](const msp::Frame& frame) {
    if (frame.id != msp::kSetRawRc || frame.direction != msp::Direction::kToController) return;
    if (last_) longest_ = std::max(longest_, now - *last_);
    last_ = now;
  });
}

double StickGaps::longest(live::Moment now) {
  const std::lock_guard lock{mutex_};
  if (!last_) return 0.0;
  return std::chrono::duration<double>(std::max(std::exchange(longest_, {}), now - *last_)).count();
}

PacedLine::PacedLine(int port, int controller, int baud)
    : door_{port}, controller_port_{controller}, baud_{baud} {
  thread_ = std::thread{[this] { work(); }};
}

PacedLine::~PacedLine() {
  over_ = true;
  thread_.join();
}

void PacedLine::work() {
  while (!over_) {
    pollfd waiting{door_.fd(), POLLIN, 0};
    if (poll(&waiting, 1, 50) <= 0) continue;
    std::optional<live::Port> client = door_.caller();
    if (!client) continue;
    try {
      live::Port controller =
          live::Port::tcp("127.0.0.1", controller_port_, live::Clock::now() + 1s);
      connected_ = true;
      carry(*client, controller);
      connected_ = false;
    } catch (const std::runtime_error&) {
      // Nobody is there: the client is hung up on.
    }
  }
}

void PacedLine::carry(live::Port& client, live::Port& controller) {
  Direction there{client, controller, baud_, &stick_gaps_}, back{controller, client, baud_};
  for (auto last = steady_clock::now(); !over_; std::this_thread::sleep_for(500us)) {
    const auto now = steady_clock::now();
    const double elapsed = std::chrono::duration<double>(now - last).count();
    last = now;
    if (!cut_ && (!there.carry(elapsed) || !back.carry(elapsed))) return;
    (void)door_.caller();  // a second one is hung up on
  }
}

}  // namespace gatefly::link_sim
