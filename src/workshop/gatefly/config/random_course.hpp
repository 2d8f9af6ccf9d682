// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace gatefly::config {

/// A track file of a course drawn at random: the same seed, the same text.
///
/// Six to twelve gates round a loop in a room of drawn size and look, in one course of three one gate
/// above another, up to six obstacles, a start before the first gate. course_problems() finds nothing
/// in it. Whether there is a way round is not asked: `gatefly track` answers that, with the reason.
[[nodiscard]] std::string random_course(std::uint64_t seed);

}  // namespace gatefly::config
