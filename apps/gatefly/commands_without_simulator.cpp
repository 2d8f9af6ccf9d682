// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "commands.hpp"
#include "render_again.hpp"

namespace gatefly::cli {

std::span<const CommandHere> commands_here() {
  static constexpr std::array kHere{
      CommandHere{"replay", declare_replay}, CommandHere{"detect", declare_detect},
      CommandHere{"score", declare_score},   CommandHere{"calibrate", declare_calibrate},
      CommandHere{"tune", declare_tune},     CommandHere{"identify", declare_identify},
      CommandHere{"config", declare_config}, CommandHere{"new", declare_new},
      CommandHere{"track", declare_track},   CommandHere{"doctor", declare_doctor},
      CommandHere{"view", declare_view},     CommandHere{"completion", declare_completion},
      CommandHere{"fly", nullptr},           CommandHere{"campaign", nullptr},
      CommandHere{"render", nullptr},        CommandHere{"reproduce", nullptr},
      CommandHere{"bench", nullptr},         CommandHere{"map", declare_map},
      CommandHere{"run", declare_run},       CommandHere{"bench-drone", declare_bench_drone},
      CommandHere{"link-sim", nullptr},      CommandHere{"import", declare_import},
      CommandHere{"record", declare_record},
  };
  return kHere;
}

tasks::RenderAgain render_again() { return {}; }

}  // namespace gatefly::cli
