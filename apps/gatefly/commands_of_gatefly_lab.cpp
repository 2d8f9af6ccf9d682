// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "gatefly/simulated_race/rendered_again.hpp"

#include "commands.hpp"
#include "render_again.hpp"

namespace gatefly::cli {

std::span<const CommandHere> commands_here() {
  static constexpr std::array kHere{
      CommandHere{"calibrate", declare_calibrate},
      CommandHere{"tune", declare_tune},
      CommandHere{"identify", declare_identify},
      CommandHere{"map", declare_map},
      CommandHere{"run", declare_run},
      CommandHere{"bench-drone", declare_bench_drone},
      CommandHere{"link-sim", declare_link_sim},
      CommandHere{"import", declare_import},
      CommandHere{"record", declare_record},
      CommandHere{"replay", declare_replay},  // with --smooth
  };
  return kHere;
}

tasks::RenderAgain render_again() { return simulated_race::rendered_again; }

}  // namespace gatefly::cli
