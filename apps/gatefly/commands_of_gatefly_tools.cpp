// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "gatefly/simulated_race/rendered_again.hpp"

#include "commands.hpp"
#include "render_again.hpp"
#include "smoothing.hpp"

namespace gatefly::cli {

std::span<const CommandHere> commands_here() {
  static constexpr std::array kHere{
      CommandHere{"replay", declare_replay, "--smooth"},
      CommandHere{"detect", declare_detect},
      CommandHere{"score", declare_score},
      CommandHere{"campaign", declare_campaign},
      CommandHere{"new", declare_new},
      CommandHere{"track", declare_track},
      CommandHere{"view", declare_view},
      CommandHere{"render", declare_render},
      CommandHere{"completion", declare_completion},
  };
  return kHere;
}

tasks::RenderAgain render_again() { return simulated_race::rendered_again; }

std::unique_ptr<FlightSmoother> flight_smoother() { return nullptr; }

}  // namespace gatefly::cli
