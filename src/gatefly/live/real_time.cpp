// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/real_time.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace gatefly::live {

bool go_first(Urgency urgency) {
  sched_param param{};
  param.sched_priority = static_cast<int>(urgency);
  // What it starts, a GStreamer or an ffmpeg, is in no hurry.
  return sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &param) == 0;
}

bool hold_memory() {
  if (mlockall(MCL_CURRENT) != 0) return false;
  // Where there is a limit, memory that is asked for later must be had without being held.
  rlimit limit{};
  const bool no_limit =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  if (no_limit) (void)mlockall(MCL_CURRENT | MCL_FUTURE);
  return true;
}

}  // namespace gatefly::live
