// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/gate_survey.hpp"
#include "gatefly/experiments/logged_motion.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/replay.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::experiments {

/// A recorded flight as the pilot would have had it.
struct Flight {
  std::string name;
  flight_log::FlightFolder folder;
  std::vector<flight_log::RecordedTick> ticks;
  /// Motion capture, and attitudes of our AHRS that starts at heading 0.
  LoggedMotion motion;
  std::vector<GatePicture> seen;  ///< Whole gates, in the air.
};

/// The pilot of a configuration for flights without a track: anywhere, in the air when somebody
/// else wants.
[[nodiscard]] PilotConfig pilot_for_recordings(const config::Config& config);

/// All flight_* of a folder. @throws std::runtime_error when there is none, or as the files'
/// readers.
[[nodiscard]] std::vector<Flight> flights_in(const std::filesystem::path& folder,
                                             const config::Config& config, const PilotConfig& pilot,
                                             const Options& options);

/// Flights whose gate can be located, and where.
struct Located {
  std::vector<Flight> flights;
  std::vector<std::size_t> gate_of;  ///< For each flight: which of survey.gates.
  Survey survey;                     ///< Survey of all of them.

  [[nodiscard]] bool shared(std::size_t flight) const {
    return std::count(gate_of.begin(), gate_of.end(), gate_of[flight]) > 1;
  }
};

/// Takes from `flights` those whose gate can be located: five pictures or more that agree.
[[nodiscard]] Located located(std::vector<Flight>& flights, const PilotConfig& pilot);

/// The same survey with the attitudes that the log's own AHRS wrote.
[[nodiscard]] Located with_logged_attitudes(Located found, const PilotConfig& pilot);

/// Gate and airframe as the other flights have them; heading of the frame and tilt are this
/// flight's own. A gate that no other flight went to is its own, too.
[[nodiscard]] Survey by_the_others(const Located& found, std::size_t i, const PilotConfig& pilot);

/// A pilot that knows what a survey found.
[[nodiscard]] PilotConfig told(PilotConfig pilot, const Survey& survey, std::size_t gate,
                               std::size_t flight);

/// A pilot that knows the gate, and of the flight what its own log and the data sheet say: heading,
/// camera and delay are for its filter to find.
[[nodiscard]] PilotConfig told_the_gate(PilotConfig pilot, const SurveyedGate& gate,
                                        const Flight& flight);

/// Distance between expected and seen corners in all pictures, RMS [px].
[[nodiscard]] double misfit_px(const Located& found, const PilotConfig& pilot);

/// Heading that the log begins with [rad].
[[nodiscard]] double log_yaw(const Flight& flight);

}  // namespace gatefly::experiments
