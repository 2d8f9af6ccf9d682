// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "commands.hpp"
#include "render_again.hpp"

namespace gatefly::cli {
namespace {

// Those that take Ceres and OpenCV are left out of a companion's program.
#ifdef GATEFLY_LABORATORY
constexpr auto kCalibrate = declare_calibrate, kTune = declare_tune;
#else
constexpr void (*kCalibrate)(Command&) = nullptr;
constexpr void (*kTune)(Command&) = nullptr;
#endif

}  // namespace

std::span<const CommandHere> commands_here() {
  static constexpr std::array kHere{
      CommandHere{"replay", declare_replay},
      CommandHere{"detect", declare_detect},
      CommandHere{"score", declare_score},
      CommandHere{"calibrate", kCalibrate},
      CommandHere{"tune", kTune},
      CommandHere{"identify", declare_identify},
      CommandHere{"config", declare_config},
      CommandHere{"new", declare_new},
      CommandHere{"track", declare_track},
      CommandHere{"doctor", declare_doctor},
      CommandHere{"view", declare_view},
      CommandHere{"completion", declare_completion},
      CommandHere{"fly", nullptr},
      CommandHere{"campaign", nullptr},
      CommandHere{"render", nullptr},
      CommandHere{"reproduce", nullptr},
      CommandHere{"bench", nullptr},
      CommandHere{"map", declare_map},
      CommandHere{"run", declare_run},
      CommandHere{"bench-drone", declare_bench_drone},
      CommandHere{"link-sim", nullptr},
      CommandHere{"import", declare_import},
      CommandHere{"record", declare_record},
  };
  return kHere;
}

tasks::RenderAgain render_again() { return {}; }

}  // namespace gatefly::cli
