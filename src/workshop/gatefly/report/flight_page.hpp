// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/flight_log/tick.hpp"
#include "gatefly/report/flight_columns.hpp"
#include "gatefly/report/flight_looks.hpp"
#include "gatefly/report/gate_passes.hpp"
#include "gatefly/report/page_course.hpp"
#include "gatefly/report/page_tick.hpp"

namespace gatefly::report {

/// A flight as one page for a browser, report.html, collected while it is flown: what was, what the
/// pilot believed and what it saw, each with its time. Collects only; the flight is the same
/// without it.
///
/// Whatever is too much is thinned as it comes, so that a page never outgrows kMostBytes.
class FlightPage {
 public:
  static constexpr std::size_t kMostBytes = 5'000'000;

  /// @param page  shipped_page().
  /// @param film  where the onboard film may grow; "": no ffmpeg, so some of the pictures, as JPEGs.
  FlightPage(std::string page, PageCourse course, std::filesystem::path film = {});

  /// Every tick of the flight, in order.
  void record(const flight_log::Tick& tick);
  void record(const PageTick& tick);
  /// The last of them once more: the page goes on to it, and to the contact of a flight that is lost.
  void end(const flight_log::Tick& tick);
  void end(const PageTick& tick);

  /// Once, after the last tick.
  /// @param summary  summary() of the same race.
  /// @param verdict  in words: "crashed into a pole at ...".
  [[nodiscard]] std::string html(const nlohmann::ordered_json& summary, const std::string& verdict);

 private:
  [[nodiscard]] std::string filled(const nlohmann::ordered_json& flight, const std::string& film,
                                   std::size_t step) const;

  std::string page_;
  PageCourse course_;
  std::optional<RacePlan> plan_;
  FlightColumns columns_;
  FlightLooks looks_;
  GatePasses passes_;
};

}  // namespace gatefly::report
