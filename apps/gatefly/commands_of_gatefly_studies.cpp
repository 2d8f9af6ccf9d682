// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "commands.hpp"

namespace gatefly::cli {

std::span<const CommandHere> commands_here() {
  static constexpr std::array kHere{
      CommandHere{"reproduce", declare_reproduce},
      CommandHere{"bench", declare_bench},
  };
  return kHere;
}

}  // namespace gatefly::cli
