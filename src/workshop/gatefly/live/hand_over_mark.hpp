// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "gatefly/live/drone_file.hpp"

// The mark that a passed hand-over test leaves in drone.toml, bound to every constant in it and to the program.

namespace gatefly::live {

/// A hash of all constants of a drone.toml and of the program, to which a hand-over test is bound; 16 hexadecimal digits.
[[nodiscard]] std::string hand_over_mark(const DroneFile& drone, const std::string& program);

/// The text of a drone.toml with another mark in [hand_over_test], or without that table where `mark` is "".
/// @throws std::runtime_error one line, when the table is written in a way that cannot be replaced.
[[nodiscard]] std::string with_hand_over_mark(const DroneFile& drone, const std::string& text,
                                              const std::string& mark);

/// A program by its bytes; the one that runs by default.
[[nodiscard]] std::string program_mark(const std::filesystem::path& program = "/proc/self/exe");

/// Whether a hand-over test of these constants and this program has passed. Nobody hands over a TS-002 simulator's drone: always.
[[nodiscard]] bool hand_over_tested(const DroneFile& drone, const std::string& program);

}  // namespace gatefly::live
