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
  // Reset on fork: programs that this thread starts, GStreamer or ffmpeg, keep the normal priority.
  return sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &param) == 0;
}

bool hold_memory() {
  if (mlockall(MCL_CURRENT) != 0) return false;
  // Under a limit, locking future pages as well would make later allocations fail.
  rlimit limit{};
  const bool no_limit =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  if (no_limit) (void)mlockall(MCL_CURRENT | MCL_FUTURE);
  return true;
}

}  // namespace gatefly::live
