// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly::live {

/// Threads that must not be late, the more urgent ones higher. All go before programs that are in no hurry.
enum class Urgency : int { kCamera = 10, kPilot = 20, kLink = 30, kKeeper = 40 };

/// The calling thread goes first from now on (SCHED_FIFO). @return false: the system does not allow it (RLIMIT_RTPRIO, CAP_SYS_NICE), and
/// nothing has changed.
bool go_first(Urgency urgency);

/// No page of this process is ever fetched from a disk again. @return false: the system does not allow it (RLIMIT_MEMLOCK), and nothing has
/// changed.
bool hold_memory();

}  // namespace gatefly::live
