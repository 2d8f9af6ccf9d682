// SPDX-License-Identifier: Apache-2.0
// The link to a controller: what is asked, what is understood, and that a shadow's cannot send sticks.
#include <array>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/live/arrival_clock.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/drone_answers.hpp"
#include "gatefly/live/msp_introduction.hpp"
#include "gatefly/live/msp_speaker.hpp"
#include "gatefly/live/stream_watch.hpp"

#include "support/fake_betaflight.hpp"
#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using test::error_of;

template <class Link>
concept Flies = requires(Link link, Demand demand, RunClock clock) {
  link.send(demand, clock);
};
template <class Link>
concept GivesItsPort = requires(Link link) {
  link.port();
}
|| requires(Link link) { link.port_; };
static_assert(Flies<LinkCommands>);
static_assert(!Flies<LinkQueries>, "a shadow's link has no function that flies");
static_assert(!GivesItsPort<LinkQueries>, "nor can anybody write past it");

/// A fake controller that serves in a thread of its own.
class Served {
 public:
  explicit Served(const test::FakeSettings& settings = {})
      : fake_{settings}, thread_{[this] {
          for (; !over_; std::this_thread::sleep_for(1ms)) fake_.serve();
        }} {}
  ~Served() { over_ = true, thread_.join(); }
  test::FakeBetaflight& fake() { return fake_; }
  Port port() { return Port::tcp("127.0.0.1", fake_.port(), Clock::now() + 2s); }

 private:
  test::FakeBetaflight fake_;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

DroneFile the_fake() {
  return read_drone(support::source_folder() / "tests" / "live" / "fake_drone.toml");
}

/// A link to the fake, which has introduced itself.
class Listening {
 public:
  /// Asks and listens until `end`, or until the link is cut. @return the samples that came.
  int until(nanoseconds end) {
    int samples = 0;
    while (clock_.now() < end && !link.broken()) samples += link.serve(clock_, clock_.now() + 2ms);
    return samples;
  }

 private:
  Served served_;
  Port port_ = served_.port();
  const Introduction said_ = introduction_of(port_);
  RunClock clock_;

 public:
  LinkQueries link = queries_on(std::move(port_), the_fake(), {.boxes = *said_.facts.boxes});
  test::FakeBetaflight& fake() { return served_.fake(); }
};

TEST(Introduction, TheFakeIsTheDroneOfItsFile) {
  Served served;
  Port port = served.port();
  const Introduction said = introduction_of(port);
  EXPECT_FALSE(said.other_client);
  EXPECT_TRUE(guard::complaints_about(said.facts).empty());
  EXPECT_THAT(differences(the_fake(), said.facts, said.board), testing::IsEmpty());
}

TEST(Introduction, AnotherRateCurveIsNamed) {
  Served served;
  Port port = served.port();
  const Introduction said = introduction_of(port);
  DroneFile other = the_fake();
  other.tuning.super_rate[1] = 70;
  EXPECT_THAT(differences(other, said.facts, said.board),
              testing::ElementsAre("super_rate is 45, in the file 70"));
}

TEST(Introduction, NobodyThereIsOneLine) {
  int port = 0;
  {
    Served served;
    port = served.fake().port();
  }
  EXPECT_THAT(error_of([&] { (void)Port::tcp("127.0.0.1", port, Clock::now() + 1s); }),
              testing::HasSubstr("cannot be opened: Connection refused"));
}

TEST(Introduction, AnswersToAProgramThatHasEndedAreNoOtherClientsButThoseThatKeepComingAre) {
  Served late, other;
  late.fake().obey("late 1.0");
  other.fake().obey("late 60");
  Port port = late.port(), others = other.port();
  EXPECT_FALSE(introduction_of(port).other_client);
  EXPECT_TRUE(introduction_of(others).other_client);
}

TEST(LinkQueries, FiftySamplesASecondArriveOverASerialLineOf115200Baud) {
  Listening drone;
  const int samples = drone.until(2s);
  EXPECT_GE(samples, 90) << "in 2 s";
  EXPECT_LE(samples, 102);
  const ControllerState& state = drone.link.state();
  EXPECT_NEAR(state.imu.accel_B.z(), -kGravity, 0.5);
  EXPECT_FALSE(state.armed);
  EXPECT_NEAR(state.battery_v, 24.0, 0.01);
  EXPECT_EQ(state.sticks, msp::kNeutral);
  EXPECT_EQ(drone.fake().frames(), 0) << "questions only";
}

TEST(LinkQueries, AControllerThatAnswersWhatNobodyAskedHasAnotherClient) {
  Listening drone;
  (void)drone.until(200ms);
  EXPECT_FALSE(drone.link.state().other_client);
  drone.fake().obey("strange");
  (void)drone.until(400ms);
  EXPECT_TRUE(drone.link.state().other_client);
}

TEST(LinkQueries, ALinkThatIsCutIsBrokenAtOnce) {
  Listening drone;
  (void)drone.until(100ms);
  drone.fake().obey("cut");
  (void)drone.until(300ms);
  EXPECT_TRUE(drone.link.broken());
}

TEST(MspPoller, WithoutABatchItAsksOneByOneAndGetsTheSame) {
  msp::BoxIds boxes;
  boxes.push_back(0);
  MspPoller poller{{}, boxes};
  std::array<std::uint8_t, 128> room{};
  const auto asked = [&](nanoseconds now) {
    std::uint16_t id = 0;
    msp::Stream stream;
    stream.feed(poller.request(now), [&](const msp::Frame& frame) { id = frame.id; });
    return id;
  };
  ASSERT_EQ(asked(0ms), msp::kMultiple);
  const std::size_t refusal =
      msp::encode_frame({msp::kMultiple, {}, msp::Direction::kRefused, msp::Version::k2}, room);
  EXPECT_FALSE(poller.take({room.data(), refusal}, 1ms));
  ASSERT_EQ(asked(20ms), msp::RawImu::kId);
  const msp::RawImu raw{.accel = {0, 0, 512}};
  const std::size_t size = msp::encode_message(raw, msp::Direction::kFromController, room);
  EXPECT_TRUE(poller.take({room.data(), size}, 22ms));
  EXPECT_NEAR(poller.state().imu.accel_B.z(), -kGravity, 1e-9);
  EXPECT_EQ(asked(23ms), msp::Attitude::kId);
}

TEST(MspPoller, ALostAnswerIsAskedForAgainAndCounted) {
  MspPoller poller{{}, {}};
  EXPECT_FALSE(poller.request(0ms).empty());
  EXPECT_TRUE(poller.request(30ms).empty());
  EXPECT_FALSE(poller.request(61ms).empty());
  EXPECT_EQ(poller.state().lost, 1u);
}

TEST(MspPoller, AMillionBytesOfNoiseAndBrokenFramesLeaveItAskingAndUnderstanding) {
  msp::BoxIds boxes;
  boxes.push_back(0);
  MspPoller poller{{}, boxes};
  Rng rng{11};
  nanoseconds now{0};
  std::array<std::uint8_t, 256> room{};
  for (int sent = 0; sent < 1'000'000; now += 5ms) {
    (void)poller.request(now);
    const auto id = static_cast<std::uint16_t>(100 + rng.uniform_index(12));
    std::array<std::uint8_t, 40> payload{};
    for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(rng.next());
    const auto size = static_cast<std::size_t>(rng.uniform_index(41));
    std::size_t bytes = msp::encode_frame(
        {id, {payload.data(), size}, msp::Direction::kFromController, msp::Version::k2}, room);
    if (rng.uniform_index(2) == 0)
      room[static_cast<std::size_t>(rng.uniform_index(int(bytes)))] ^= 0x10;
    if (rng.uniform_index(4) == 0) bytes /= 2;
    (void)poller.take({room.data(), bytes}, now);
    sent += static_cast<int>(bytes);
  }
  EXPECT_TRUE(poller.state().other_client) << "frames that nobody asked for";
  // It goes on as if nothing had been, once what has begun is over.
  now += 1s;
  ASSERT_FALSE(poller.request(now).empty());
  std::vector<std::uint8_t> answers{18};
  answers.insert(answers.end(), 18, std::uint8_t{1});
  for (int i = 0; i < 200 && !poller.take({}, now); ++i) {
    const std::size_t size = msp::encode_frame(
        {msp::kMultiple, answers, msp::Direction::kFromController, msp::Version::k2}, room);
    if (poller.take({room.data(), size}, now)) break;
    now += 100ms;
    (void)poller.request(now);
  }
  EXPECT_GT(poller.state().imu_at, now - 1s);
}

TEST(ArrivalClock, RejectsMostOfTheJitterAndNeverRunsAheadOfAnArrival) {
  ArrivalClock clock{20ms};
  Rng rng{3};
  double in = 0.0, out = 0.0;
  nanoseconds last{0}, last_arrival{0};
  for (int i = 0; i < 500; ++i) {
    const nanoseconds arrival =
        i * 20ms + nanoseconds{static_cast<std::int64_t>(rng.uniform(0, 9e6))};
    const nanoseconds taken = clock.take(arrival);
    EXPECT_LE(taken, arrival);
    if (i > 50) {
      in += std::pow(static_cast<double>((arrival - last_arrival - 20ms).count()), 2);
      out += std::pow(static_cast<double>((taken - last - 20ms).count()), 2);
    }
    last = taken, last_arrival = arrival;
  }
  EXPECT_LT(std::sqrt(out), 0.4 * std::sqrt(in));
}

TEST(StreamWatch, AStalledStreamIsNoticedWithinTwoPicturesAndALateOneIsNot) {
  StreamWatch watch;
  nanoseconds t{0};
  for (int i = 0; i < 60; ++i, t += 33ms) watch.arrived(t + (i % 3) * 2ms);
  EXPECT_FALSE(watch.stalled(t + 20ms));
  EXPECT_TRUE(watch.stalled(t - 33ms + 85ms));
}

TEST(StreamWatch, NeitherLostPicturesNorUnevenOnesChangeThePeriod) {
  StreamWatch watch;
  nanoseconds t{0};
  for (int i = 0; i < 60; ++i, t += 66ms)
    if (i % 8 != 3) watch.arrived(t + (i % 2) * 20ms);
  EXPECT_NEAR(static_cast<double>(watch.period().count()), 66e6, 21e6);
  EXPECT_GT(watch.gone(), 3 * 66ms) << "three lost in a row are not the end";
}

TEST(StreamWatch, ACameraOfWhichPartsComeHasTwiceTheTimeOfOneThatIsSilent) {
  StreamWatch watch;
  for (int i = 0; i < 20; ++i) watch.arrived(i * 40ms);
  const nanoseconds last = 19 * 40ms;
  EXPECT_EQ(watch.gone(last + 200ms), watch.gone()) << "silent";
  watch.part_arrived(last + 160ms);
  EXPECT_EQ(watch.gone(last + 200ms), 2 * watch.gone()) << "torn";
  EXPECT_EQ(watch.gone(last + 400ms), watch.gone()) << "parts have stopped, too";
}

TEST(StreamWatch, ANetworkThatTearsEveryOtherPictureIsNoCameraThatIsGone) {
  // Thirty slices a picture, of which one in fifty is lost: 45 % of all pictures.
  StreamWatch watch;
  Rng rng{7};
  nanoseconds t{0}, last{0};
  int given_up = 0;
  for (int i = 0; i < 18000; ++i, t += 33ms) {
    if (watch.gone(t) < t - last) ++given_up;
    watch.part_arrived(t);
    if (rng.uniform(0.0, 1.0) < 0.45) continue;
    watch.arrived(t), last = t;
  }
  EXPECT_EQ(given_up, 0) << "in ten minutes";
  // The same camera gone for good is noticed within a second.
  for (int i = 0; i < 31; ++i, t += 33ms) watch.part_arrived(t);
  EXPECT_LT(watch.gone(t), t - last);
}

}  // namespace
}  // namespace gatefly::live
