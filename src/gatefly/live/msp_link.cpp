// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/msp_link.hpp"

#include <stdexcept>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/files/text.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t kBoardInfo = 4;  // MSP_BOARD_INFO: four letters first
constexpr int kTries = 3;

/// Sends a question and gives every frame that comes to `take`, which says whether it was the answer.
template <class Take>
bool asked(Port& port, msp::Stream& stream, std::uint16_t id, Take&& take) {
  std::array<std::uint8_t, 512> room{};
  const std::size_t size = msp::encode_request(id, room);
  if (!port.write({room.data(), size}, Clock::now() + 200ms)) return false;
  for (const Moment end = Clock::now() + 300ms; Clock::now() < end;) {
    const auto got = port.read(room, end);
    if (!got) throw std::runtime_error(port.name() + ": has closed the connection");
    bool done = false;
    stream.feed(link::Bytes{room}.first(*got), [&](const msp::Frame& frame) {
      if (frame.direction != msp::Direction::kToController) done = take(frame) || done;
    });
    if (done) return true;
  }
  return false;
}

/// Waits until nothing comes any more: a controller that is slow still answers a program that has just ended. @return false: frames
/// keep coming, so somebody else asks for them.
bool falls_silent(Port& port, msp::Stream& stream) {
  constexpr auto kSilence = 200ms, kLongest = 3000ms;
  std::array<std::uint8_t, 512> room{};
  const Moment begin = Clock::now();
  for (Moment last = begin; Clock::now() < last + kSilence;) {
    if (Clock::now() > begin + kLongest) return false;
    const auto got = port.read(room, last + kSilence);
    if (!got) return true;  // the first question will say so
    stream.feed(link::Bytes{room}.first(*got), [&](const msp::Frame&) { last = Clock::now(); });
  }
  return true;
}

}  // namespace

Introduction introduction_of(Port& port) {
  Introduction found;
  msp::Stream stream;
  const bool quiet = falls_silent(port, stream);
  guard::Interview interview;
  guard::AnswerWatch answers;
  int answered = 0, tries = 0;
  while (const auto question = interview.question()) {
    answers.asked(*question);
    const bool came = asked(port, stream, *question, [&](const msp::Frame& frame) {
      answers.answered(frame.id);
      if (frame.id != *question) return false;
      interview.take(frame);
      return true;
    });
    answered += came;
    if (came) tries = 0;
    if (!came && ++tries >= kTries) {
      if (answered == 0) throw std::runtime_error(port.name() + ": nobody answers to MSP");
      interview.skip();
      tries = 0;
    }
  }
  found.facts = interview.facts();
  for (int i = 0; i < kTries && found.board.empty(); ++i) {
    answers.asked(kBoardInfo);
    (void)asked(port, stream, kBoardInfo, [&](const msp::Frame& frame) {
      answers.answered(frame.id);
      if (frame.id != kBoardInfo) return false;
      if (frame.payload.size() >= 4)
        for (const std::uint8_t letter : frame.payload.first(4))
          found.board += static_cast<char>(letter);
      return true;
    });
  }
  found.other_client = !quiet || answers.other_client();
  return found;
}

Port opened(const LinkUri& uri) {
  return uri.kind == LinkUri::Kind::kSerial
             ? Port::serial(uri.place, uri.baud)
             : Port::tcp(uri.place, uri.port, Clock::now() + std::chrono::seconds{3});
}

Introduced introduced(const LinkUri& uri, const DroneFile& drone, bool only_listens) {
  Port port = opened(uri);
  const Introduction said = introduction_of(port);
  const std::string name = port.name() + ": ";
  if (said.other_client) throw std::runtime_error(name + "another program talks to the controller");
  if (const auto others = differences(drone, said.facts, said.board); !others.empty())
    throw std::runtime_error(name + "is not the drone of " + drone.path.string() + ": " +
                             io::joined(others, "; "));
  for (const guard::Complaint complaint : guard::complaints_about(said.facts))
    if (!only_listens || complaint != guard::Complaint::kArmed)
      throw std::runtime_error(name + std::string{guard::text_of(complaint)});
  if (!only_listens &&
      said.facts.status->on(msp::Box::kMspOverride, *said.facts.boxes).value_or(true))
    throw std::runtime_error(name + std::string{guard::text_of(guard::Reason::kOverrideAtStart)});
  return {std::move(port), *said.facts.boxes};
}

MspQueries::MspQueries(Port port, const DroneFile& drone, const msp::BoxIds& boxes)
    : port_{std::move(port)}, poller_{drone.imu, boxes} {}

bool MspQueries::serve(const RunClock& clock, std::chrono::nanoseconds until) {
  start_ = clock.moment(std::chrono::nanoseconds{0});
  if (const link::Bytes request = poller_.request(clock.now()); !request.empty())
    broken_ = !port_.write(request, Clock::now() + 20ms) || broken_;
  const auto got = port_.read(room_, clock.moment(until));
  if (!got) {
    broken_ = true;
    return false;
  }
  return *got > 0 && poller_.take(link::Bytes{room_}.first(*got), clock.now());
}

MspSticks::MspSticks(Port port, const DroneFile& drone, const msp::BoxIds& boxes)
    : MspQueries{std::move(port), drone, boxes}, order_{drone.order} {}

bool MspSticks::send(const msp::Sticks& sticks) {
  std::array<std::uint8_t, 32> frame{};
  const auto payload = order_.set_raw_rc(sticks);
  const std::size_t size = msp::encode_frame(
      {msp::kSetRawRc, payload, msp::Direction::kToController, msp::Version::k1}, frame);
  poller_.sticks_sent();
  const bool sent = port_.write({frame.data(), size}, Clock::now() + 10ms);
  broken_ = broken_ || !sent;
  if (sent && witness_ >= 0) report(sticks);
  return sent;
}

void MspSticks::report(const msp::Sticks& sticks) const {
  const ControllerState& state = poller_.state();
  const SentFrame frame{.process = getpid(),
                        .at = Clock::now(),
                        .sent = sticks,
                        .read = state.sticks,
                        .read_at = start_ + state.sticks_at,
                        .status_at = start_ + state.status_at,
                        .armed = state.armed,
                        .override_on = state.override_on,
                        .acknowledged = state.acknowledged};
  (void)!::send(witness_, &frame, sizeof frame, MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace gatefly::live
