// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/controller_link.hpp"

#include <stdexcept>
#include <string_view>
#include <vector>

#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/files/text.hpp"
#include "gatefly/guard/hand_over.hpp"
#include "gatefly/live/ardu_introduction.hpp"
#include "gatefly/live/drone_answers.hpp"
#include "gatefly/live/mavlink_speaker.hpp"
#include "gatefly/live/msp_introduction.hpp"
#include "gatefly/live/msp_speaker.hpp"
#include "gatefly/live/px4_introduction.hpp"
#include "gatefly/live/ts002_introduction.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;

constexpr auto kCallsFor = 3s;

[[noreturn]] void not_the_drone(const DroneFile& drone, const std::vector<std::string>& others) {
  throw AnotherDrone("is not the drone of " + drone.path.string() + ": " +
                     files::joined(others, "; "));
}

[[noreturn]] void refuse(std::string_view why) { throw std::runtime_error(std::string{why}); }

[[noreturn]] void not_alone() {
  throw AnotherDrone(std::string{guard::text_of(guard::Reason::kOtherClient)});
}

/// Throws what is wrong with a Betaflight.
Acquaintance met_betaflight(Port& port, const DroneFile& drone, bool only_listens) {
  const Introduction said = introduction_of(port);
  if (said.other_client) not_alone();
  if (const auto others = differences(drone, said.facts, said.board); !others.empty())
    not_the_drone(drone, others);
  for (const guard::Complaint complaint : guard::complaints_about(said.facts))
    if (!only_listens || complaint != guard::Complaint::kArmed) refuse(guard::text_of(complaint));
  if (!only_listens &&
      said.facts.status->on(msp::Box::kMspOverride, *said.facts.boxes).value_or(true))
    refuse(guard::text_of(guard::Reason::kOverrideAtStart));
  return {.boxes = *said.facts.boxes};
}

/// The same of an ArduCopter or a PX4. @param its_mode  in which it takes set points. @param is_in  whether its custom_mode is that one.
template <class Introduction, class IsIn>
Acquaintance met_autopilot(const Introduction& said, const DroneFile& drone, bool only_listens,
                           const char* its_mode, IsIn&& is_in) {
  if (said.other_client) not_alone();
  for (const auto complaint : guard::complaints_about(said.facts))
    if (!only_listens || complaint != decltype(complaint)::kArmed)
      refuse(guard::text_of(complaint));
  if (const auto others = differences(drone, said.facts); !others.empty())
    not_the_drone(drone, others);
  if (!only_listens && is_in(said.facts.heartbeat->custom_mode))
    refuse(std::string{"the mode is "} + its_mode + ": choose another before the program starts");
  return {};
}

Acquaintance met_ardu(Port& port, const DroneFile& drone, bool only_listens) {
  return met_autopilot(ardu_introduction_of(port, drone.system()), drone, only_listens,
                       "GUIDED_NOGPS",
                       [](std::uint32_t mode) { return mode == mavlink::kGuidedNoGps; });
}

Acquaintance met_px4(Port& port, const DroneFile& drone, bool only_listens) {
  return met_autopilot(px4_introduction_of(port, drone.system()), drone, only_listens, "OFFBOARD",
                       mavlink::is_offboard);
}

/// The same of a simulator that speaks TS-002.
Acquaintance met_ts002(Port& port, const DroneFile& drone, bool only_listens) {
  const Ts002Introduction said = ts002_introduction_of(port, drone.system());
  if (said.other_client) not_alone();
  if (said.autopilot)
    throw AnotherDrone("is " + std::string{*said.autopilot} +
                       ", a real drone's autopilot: not a simulator of TS-002");
  if (!said.clock) refuse("answers no TIMESYNC: whether a set point arrives could not be told");
  if (!only_listens && said.armed) refuse(guard::text_of(guard::ArduComplaint::kArmed));
  return {};
}

}  // namespace

Port opened(const LinkUri& uri) {
  switch (uri.kind) {
    case LinkUri::Kind::kSerial:
      return Port::serial(uri.place, uri.baud);
    case LinkUri::Kind::kUdp:
      return Port::udp_to(uri.place, uri.port, uri.bind);
    case LinkUri::Kind::kUdpIn:
      return Port::udp_from(uri.place, uri.port, uri.peer, Clock::now() + kCallsFor);
    default:
      return Port::tcp(uri.place, uri.port, Clock::now() + kCallsFor);
  }
}

Introduced introduced(const LinkUri& uri, const DroneFile& drone, bool only_listens,
                      double imu_hz) {
  if (uri.mavlink != drone.by_mavlink())
    throw std::runtime_error(drone.path.string() + ": is a drone for --link " +
                             (drone.by_mavlink() ? "mavlink:" : "msp:"));
  if (drone.ts002 && uri.kind == LinkUri::Kind::kSerial)
    throw std::runtime_error(drone.path.string() +
                             ": TS-002 is a simulator's, over UDP or TCP: no serial line");
  Port port = opened(uri);
  const auto named = [&](const std::string& text) {
    return text.starts_with(port.name()) ? text : port.name() + ": " + text;
  };
  try {
    Acquaintance known = drone.ardu    ? met_ardu(port, drone, only_listens)
                         : drone.px4   ? met_px4(port, drone, only_listens)
                         : drone.ts002 ? met_ts002(port, drone, only_listens)
                                       : met_betaflight(port, drone, only_listens);
    if (imu_hz > 0.0) known.imu_hz = imu_hz;
    return {std::move(port), known};
  } catch (const AnotherDrone& error) {
    throw AnotherDrone(named(error.what()));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(named(error.what()));
  }
}

LinkQueries queries_on(Port port, const DroneFile& drone, const Acquaintance& known) {
  if (drone.by_mavlink())
    return {std::move(port),
            std::make_unique<MavlinkListener>(listener_params(drone, known.imu_hz))};
  return {std::move(port),
          std::make_unique<MspPoller>(drone.imu, known.boxes, poller_params(drone))};
}

LinkCommands commands_on(Port port, const DroneFile& drone, const Acquaintance& known) {
  if (drone.by_mavlink())
    return {std::move(port), std::make_unique<MavlinkSpeaker>(drone, known.imu_hz)};
  return {std::move(port), std::make_unique<MspSpeaker>(drone, known.boxes)};
}

LinkQueries::LinkQueries(Port port, std::unique_ptr<Listener> listener)
    : port_{std::move(port)}, listener_{std::move(listener)} {}

bool LinkQueries::serve(const RunClock& clock, std::chrono::nanoseconds until) {
  clock_ = clock;
  if (const link::Bytes request = listener_->request(clock.now()); !request.empty())
    broken_ = !port_.write(request, Clock::now() + 20ms) || broken_;
  const auto got = port_.read(room_, clock.moment(until));
  if (!got) {
    broken_ = true;
    return false;
  }
  return *got > 0 && listener_->take(link::Bytes{room_}.first(*got), clock.now());
}

LinkCommands::LinkCommands(Port port, Speaker& speaker, std::unique_ptr<Listener> listener)
    : LinkQueries{std::move(port), std::move(listener)}, speaker_{&speaker} {}

bool LinkCommands::send(const Demand& demand, const RunClock& clock) {
  clock_ = clock;
  const link::Bytes bytes = speaker_->set_point(demand, clock.now());
  const bool sent = !bytes.empty() && port_.write(bytes, Clock::now() + 10ms);
  broken_ = broken_ || !sent;
  if (sent && witness_ >= 0) report(speaker_->sticks(demand));
  return sent;
}

void LinkCommands::report(const msp::Sticks& sticks) const {
  const ControllerState& now = state();
  const SentFrame frame{.process = getpid(),
                        .at = Clock::now(),
                        .sent = sticks,
                        .read = now.sticks,
                        .read_at = clock_.moment(now.sticks_at),
                        .status_at = clock_.moment(now.status_at),
                        .armed = now.armed,
                        .override_on = now.override_on,
                        .acknowledged = now.acknowledged};
  (void)!::send(witness_, &frame, sizeof frame, MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace gatefly::live
