// SPDX-License-Identifier: Apache-2.0
// A clock that goes slowly, for programs that a machine is too slow for in real time: LD_PRELOAD=libslow_clock.so SLOW_CLOCK=0.5 has a program count half a
// second for each that passes, and sleep twice as long. So do programs that it starts: put it before tests/cli/over_the_link.py.
//
// For gatefly, Betaflight's simulator and Python, which wait by these functions: ways to wait that are not among them (conditions, usleep, ppoll, epoll) are
// as long as ever, so that it is of no use to PX4 and ArduCopter. The monotonic clocks only: times of day are what they are.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <limits>

#include <dlfcn.h>
#include <poll.h>
#include <sys/select.h>

namespace {

// Functions of the C library that this one stands before.
struct Real {
  decltype(&clock_gettime) clock;
  decltype(&nanosleep) sleep;
  decltype(&clock_nanosleep) sleep_by;
  decltype(&poll) wait;
  decltype(&select) wait_any;
  double pace = 1.0;
};

template <class Function>
void find(Function& function, const char* name) {
  function = reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

const Real& real() {
  static const Real found = [] {
    Real all{};
    find(all.clock, "clock_gettime");
    find(all.sleep, "nanosleep");
    find(all.sleep_by, "clock_nanosleep");
    find(all.wait, "poll");
    find(all.wait_any, "select");
    const char* const told = std::getenv("SLOW_CLOCK");
    const double asked = told != nullptr ? std::atof(told) : 1.0;
    all.pace = asked >= 0.01 && asked <= 1.0 ? asked : 1.0;
    return all;
  }();
  return found;
}

bool is_slow(clockid_t id) {
  return id == CLOCK_MONOTONIC || id == CLOCK_MONOTONIC_RAW || id == CLOCK_BOOTTIME;
}

timespec scaled(const timespec& t, double factor) {
  const double seconds = static_cast<double>(t.tv_sec) * factor;
  const auto whole = static_cast<std::int64_t>(seconds);
  const auto rest = static_cast<std::int64_t>((seconds - static_cast<double>(whole)) * 1e9 +
                                              static_cast<double>(t.tv_nsec) * factor);
  return {whole + rest / 1'000'000'000, rest % 1'000'000'000};
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t id, timespec* now) noexcept {
  const int failed = real().clock(id, now);
  if (failed == 0 && is_slow(id)) *now = scaled(*now, real().pace);
  return failed;
}

int nanosleep(const timespec* wanted, timespec* left) {
  const timespec longer = scaled(*wanted, 1.0 / real().pace);
  const int failed = real().sleep(&longer, left);
  if (failed != 0 && left != nullptr) *left = scaled(*left, real().pace);
  return failed;
}

int clock_nanosleep(clockid_t id, int flags, const timespec* wanted, timespec* left) {
  const bool until = (flags & TIMER_ABSTIME) != 0;
  const timespec longer = until && !is_slow(id) ? *wanted : scaled(*wanted, 1.0 / real().pace);
  const int failed = real().sleep_by(id, flags, &longer, left);
  if (failed != 0 && left != nullptr && !until) *left = scaled(*left, real().pace);
  return failed;
}

int poll(pollfd* files, nfds_t count, int milliseconds) {
  constexpr double kLongest = std::numeric_limits<int>::max();
  const int longer = milliseconds > 0
                         ? static_cast<int>(std::min(milliseconds / real().pace, kLongest))
                         : milliseconds;
  return real().wait(files, count, longer);
}

int select(int count, fd_set* in, fd_set* out, fd_set* odd, timeval* limit) {
  if (limit == nullptr) return real().wait_any(count, in, out, odd, nullptr);
  const timespec longer = scaled({limit->tv_sec, limit->tv_usec * 1000}, 1.0 / real().pace);
  timeval until{longer.tv_sec, longer.tv_nsec / 1000};
  const int ready = real().wait_any(count, in, out, odd, &until);
  const timespec left = scaled({until.tv_sec, until.tv_usec * 1000}, real().pace);
  *limit = {left.tv_sec, left.tv_nsec / 1000};  // as Linux does
  return ready;
}

}  // extern "C"
