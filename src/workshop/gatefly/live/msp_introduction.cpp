// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/msp_introduction.hpp"

#include <array>
#include <chrono>
#include <stdexcept>

#include "gatefly/guard/answer_watch.hpp"

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

}  // namespace gatefly::live
