// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "commands.hpp"

namespace gatefly::cli {

std::span<const CommandHere> commands_here() {
  static constexpr std::array kHere{CommandHere{"fly", declare_fly},
                                    CommandHere{"config", declare_config},
                                    CommandHere{"doctor", declare_doctor}};
  return kHere;
}

}  // namespace gatefly::cli
