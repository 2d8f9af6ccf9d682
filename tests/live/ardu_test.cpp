// SPDX-License-Identifier: Apache-2.0
// The link to an ArduCopter: what it is asked, what is understood, what it is told to do, and what never.
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"
#include "gatefly/live/ardu_bench.hpp"
#include "gatefly/live/ardu_introduction.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/drone_answers.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/hand_over_mark.hpp"
#include "gatefly/live/mavlink_speaker.hpp"
#include "gatefly/live/peer_clock.hpp"
#include "gatefly/live/wires.hpp"

#include "support/drone_file_keys.hpp"
#include "support/fake_arducopter.hpp"
#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class Link>
concept CanFly = requires(Link link, Demand demand, nanoseconds now) {
  link.set_point(demand, now);
};
static_assert(CanFly<MavlinkSpeaker>);
static_assert(!CanFly<MavlinkListener>, "a shadow's half has no set point");

std::string ardu_text() {
  return files::read_file(support::source_folder() / "tests" / "live" / "fake_arducopter.toml");
}

DroneFile ardu_drone() {
  return read_drone(support::source_folder() / "tests" / "live" / "fake_arducopter.toml");
}

/// A fake that serves in a thread of its own.
class ServedArdu {
 public:
  explicit ServedArdu(const test::FakeArduSettings& settings = {})
      : fake_{settings}, thread_{[this] {
          for (; !over_; std::this_thread::sleep_for(1ms)) fake_.serve();
        }} {}
  ~ServedArdu() { over_ = true, thread_.join(); }
  test::FakeArduCopter& fake() { return fake_; }
  Port port() { return Port::tcp("127.0.0.1", fake_.port(), Clock::now() + 2s); }
  LinkUri uri() { return link_uri("mavlink:tcp:127.0.0.1:" + std::to_string(fake_.port())); }

 private:
  test::FakeArduCopter fake_;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

/// Serves until `what` or five seconds have gone. @return whether it came true.
template <class Link, class What>
bool served_until(Link& link, const RunClock& clock, What&& what) {
  for (const nanoseconds end = clock.now() + 5s; clock.now() < end && !link.broken();) {
    (void)link.serve(clock, clock.now() + 2ms);
    if (what()) return true;
  }
  return false;
}

TEST(ArduIntroduction, TheFakeIsTheDroneOfItsFileAndNothingIsWrongWithIt) {
  ServedArdu served;
  Port port = served.port();
  const ArduIntroduction said = ardu_introduction_of(port, 1);
  EXPECT_FALSE(said.other_client);
  EXPECT_TRUE(guard::complaints_about(said.facts).empty());
  EXPECT_THAT(differences(ardu_drone(), said.facts), IsEmpty());
}

TEST(ArduIntroduction, OneOfAnotherSystemIsNotHeard) {
  ServedArdu served;
  Port port = served.port();
  EXPECT_THAT(error_of([&] { (void)ardu_introduction_of(port, 7); }),
              HasSubstr("no MAVLink 2 from system 7"));
}

TEST(ArduIntroduction, WhatADroneMustNotBeSetToIsNamed) {
  ServedArdu served;
  served.fake().obey("parameter GUID_OPTIONS 0");
  served.fake().obey("parameter GUID_TIMEOUT 3");
  served.fake().obey("parameter MOT_THST_HOVER 0");
  Port port = served.port();
  const auto complaints = guard::complaints_about(ardu_introduction_of(port, 1).facts);
  const std::vector<guard::ArduComplaint> all(complaints.begin(), complaints.end());
  EXPECT_THAT(all, ElementsAre(guard::ArduComplaint::kThrustIsClimbRate,
                               guard::ArduComplaint::kTimeout, guard::ArduComplaint::kNoHover));
}

TEST(ArduIntroduction, AnotherThrustCurveIsAnotherDrone) {
  ServedArdu served;
  served.fake().obey("parameter MOT_THST_EXPO 0.65");
  EXPECT_THAT(error_of([&] { (void)introduced(served.uri(), ardu_drone(), true); }),
              HasSubstr("MOT_THST_EXPO is 0.65, in the file 1"));
}

TEST(ArduIntroduction, ADroneThatIsArmedOrInGuidedModeIsNotFlown) {
  ServedArdu served;
  served.fake().obey("override on");
  EXPECT_THAT(error_of([&] { (void)introduced(served.uri(), ardu_drone(), false); }),
              HasSubstr("the mode is GUIDED_NOGPS"));
  served.fake().obey("override off");
  served.fake().obey("arm");
  EXPECT_THAT(error_of([&] { (void)introduced(served.uri(), ardu_drone(), false); }),
              HasSubstr("the drone is armed"));
  EXPECT_EQ(error_of([&] { (void)introduced(served.uri(), ardu_drone(), true); }), "");
}

TEST(ArduIntroduction, AnotherComputerAboardIsAnotherClientAndAGroundStationIsNone) {
  for (const auto& [word, is_one] :
       {std::pair{"other", true}, {"twin", true}, {"station", false}}) {
    ServedArdu served;
    served.fake().obey(word);
    Port port = served.port();
    EXPECT_EQ(ardu_introduction_of(port, 1).other_client, is_one) << word;
  }
}

TEST(ArduIntroduction, ABetaflightsFileIsForAnotherLink) {
  const DroneFile other =
      read_drone(support::source_folder() / "tests" / "live" / "fake_drone.toml");
  EXPECT_THAT(error_of([&] { (void)introduced(link_uri("mavlink:tcp:127.0.0.1:1"), other, true); }),
              HasSubstr("is a drone for --link msp:"));
}

TEST(MavlinkListener, WhatIsAskedForComesAndIsUnderstood) {
  ServedArdu served;
  served.fake().obey("arm");
  LinkQueries link = queries_on(served.port(), ardu_drone(), {.imu_hz = 100});
  const RunClock clock;
  const ControllerState& is = link.state();
  ASSERT_TRUE(served_until(link, clock, [&] {
    return is.samples > 100 && is.status_at > 0ns && is.attitude_at > 0ns && is.battery_v > 0;
  }));
  EXPECT_TRUE(is.armed);
  EXPECT_FALSE(is.override_on);
  EXPECT_NEAR(is.battery_v, 24.0, 0.01);
  EXPECT_NEAR(is.imu.accel_B.z(), -kGravity, 0.3);
  EXPECT_NEAR(is.attitude.roll, 0.0, 0.01);
  EXPECT_LE(is.imu_taken, is.imu_at);
  EXPECT_EQ(served.fake().set_points(), 0) << "who looks on does not fly";
  EXPECT_EQ(served.fake().meddled(), 0);
}

TEST(MavlinkListener, WithoutAFineImuTheCoarseOneWillDo) {
  ServedArdu served;
  served.fake().obey("coarse");
  LinkQueries link = queries_on(served.port(), ardu_drone(), {});
  const RunClock clock;
  ASSERT_TRUE(served_until(link, clock, [&] { return link.state().samples > 20; }));
  EXPECT_NEAR(link.state().imu.accel_B.z(), -kGravity, 0.3);
}

TEST(MavlinkListener, AnImuThatRepeatsItselfIsStuckWhateverItsStampSays) {
  ServedArdu served;
  served.fake().obey("freeze imu");
  LinkQueries link = queries_on(served.port(), ardu_drone(), {});
  const RunClock clock;
  const ControllerState& is = link.state();
  ASSERT_TRUE(served_until(link, clock, [&] { return is.samples > 30; }));
  EXPECT_GT(is.imu_at - is.imu_changed_at, 200ms);
}

TEST(MavlinkListener, AModeOfItsOwnTakesTheDroneBack) {
  ServedArdu served;
  served.fake().obey("arm");
  served.fake().obey("override on");
  LinkQueries link = queries_on(served.port(), ardu_drone(), {});
  const RunClock clock;
  ASSERT_TRUE(served_until(link, clock, [&] { return link.state().override_on; }));
  served.fake().obey("land");
  EXPECT_TRUE(served_until(link, clock, [&] { return !link.state().override_on; }));
}

TEST(MavlinkListener, AnotherComputerThatComesLaterIsNoticed) {
  ServedArdu served;
  LinkQueries link = queries_on(served.port(), ardu_drone(), {});
  const RunClock clock;
  ASSERT_TRUE(served_until(link, clock, [&] { return link.state().samples > 10; }));
  EXPECT_FALSE(link.state().other_client);
  served.fake().obey("other");
  EXPECT_TRUE(served_until(link, clock, [&] { return link.state().other_client; }));
}

TEST(MavlinkListener, GarbageAndFramesOfOthersChangeNothing) {
  MavlinkListener listener{{}};
  std::vector<std::uint8_t> garbage(4000);
  Rng rng{3};
  for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(rng.uniform(0.0, 255.99));
  EXPECT_FALSE(listener.take(garbage, 1s));
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(
      mavlink::Heartbeat{.custom_mode = mavlink::kGuidedNoGps, .autopilot = 3, .base_mode = 128},
      {2, 1, 0}, frame);
  (void)listener.take(link::Bytes{frame}.first(size), 1s);
  EXPECT_LT(listener.state().status_at, 0ns) << "another system's heartbeat";
  EXPECT_FALSE(listener.state().armed);
}

TEST(MavlinkListener, ASampleThatIsNoNumberIsNone) {
  MavlinkListener listener{{}};
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(
      mavlink::HighresImu{.time_usec = 1000, .xgyro = NAN}, {1, 1, 0}, frame);
  EXPECT_FALSE(listener.take(link::Bytes{frame}.first(size), 1s));
}

/// The set point in the bytes that a speaker writes.
mavlink::SetAttitudeTarget target_in(link::Bytes bytes) {
  mavlink::Stream stream;
  mavlink::SetAttitudeTarget found;
  stream.feed(bytes, [&](const mavlink::Frame& frame) {
    if (const auto target = mavlink::message_in<mavlink::SetAttitudeTarget>(frame)) found = *target;
  });
  return found;
}

TEST(MavlinkSpeaker, RatesAreSentAsTheyAreAndThrustAsAPartOfWhatHovers) {
  const DroneFile drone = ardu_drone();
  MavlinkSpeaker speaker{drone, 50};
  const auto target = target_in(speaker.set_point(
      {.rests = false, .rates_B = {1.0, -0.5, 0.25}, .thrust = 1.5 * kGravity}, 2s));
  EXPECT_FLOAT_EQ(target.body_roll_rate, 1.0f);
  EXPECT_FLOAT_EQ(target.body_pitch_rate, -0.5f);
  EXPECT_FLOAT_EQ(target.body_yaw_rate, 0.25f);
  EXPECT_NEAR(target.thrust, 1.5 * 0.2, 1e-6);
  EXPECT_EQ(target.type_mask, 128) << "no attitude";
  EXPECT_EQ(target.target_system, 1);
}

TEST(MavlinkSpeaker, AtRestNothingTurnsAndNothingLifts) {
  const DroneFile drone = ardu_drone();
  MavlinkSpeaker speaker{drone, 50};
  const auto target = target_in(speaker.set_point({}, 2s));
  EXPECT_EQ(target.thrust, 0.0f);
  EXPECT_EQ(target.body_roll_rate, 0.0f);
}

TEST(MavlinkSpeaker, ThrustIsNeverMoreThanAllNorLessThanNone) {
  const DroneFile drone = ardu_drone();
  MavlinkSpeaker speaker{drone, 50};
  for (const double thrust : {1e9, std::nan(""), -5.0}) {
    const auto target = target_in(speaker.set_point({.rests = false, .thrust = thrust}, 2s));
    EXPECT_GE(target.thrust, 0.0f);
    EXPECT_LE(target.thrust, 1.0f);
  }
}

TEST(ArduDrone, WhereItAddsThrustItselfWhenTiltedWeDoNot) {
  ArduDrone drone;
  EXPECT_DOUBLE_EQ(drone.thrust_part(400, 0.8), 0.4);
  drone.angle_boost = true;
  EXPECT_DOUBLE_EQ(drone.thrust_part(400, 0.8), 0.32);
}

TEST(MavlinkSpeaker, SetPointsAreAcknowledgedAndObeyedInGuidedModeAlone) {
  ServedArdu served;
  const DroneFile drone = ardu_drone();
  LinkCommands link = commands_on(served.port(), drone, {});
  const RunClock clock;
  nanoseconds next{0};
  const Demand demand{.rests = false, .rates_B = {0, 0, 0.5}, .thrust = 0.5 * kGravity};
  const auto flown = [&] {
    if (clock.now() >= next) next = clock.now() + 25ms, (void)link.send(demand, clock);
    return link.state().acknowledged >= 40;
  };
  ASSERT_TRUE(served_until(link, clock, flown));
  EXPECT_EQ(link.state().sticks.yaw, 1500) << "not before the mode is chosen";
  served.fake().obey("arm");
  served.fake().obey("override on");
  const msp::Sticks wanted{.roll = 1500, .pitch = 1500, .yaw = 2000, .throttle = 1100};
  EXPECT_TRUE(served_until(link, clock, [&] {
    (void)flown();
    return link.state().sticks == wanted;
  }));
  EXPECT_EQ(served.fake().meddled(), 0) << "neither armed nor changed the mode";
}

TEST(ArduUdp, ADroneThatCallsIsHeardAndNobodyElse) {
  // A port that is free.
  const int ours = [] {
    ServedArdu other;
    return other.fake().port();
  }();
  ServedArdu served{{.calls = ours}};
  LinkUri uri = link_uri("mavlink:udpin:127.0.0.1:" + std::to_string(ours));
  Introduced met = introduced(uri, ardu_drone(), true);
  LinkQueries link = queries_on(std::move(met.port), ardu_drone(), met.known);
  const RunClock clock;
  EXPECT_TRUE(served_until(link, clock, [&] { return link.state().samples > 10; }));
  // Somebody else's heartbeats from another port do not arrive: the drone would count as flown by another.
  const Port stranger = Port::udp_to("127.0.0.1", ours, "127.0.0.1");
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size =
      mavlink::encode_message(mavlink::Heartbeat{.type = 18}, {1, 192, 0}, frame);
  for (int i = 0; i < 5; ++i) (void)!write(stranger.fd(), frame.data(), size);
  (void)served_until(link, clock,
                     [&, n = link.state().samples] { return link.state().samples > n + 10; });
  EXPECT_FALSE(link.state().other_client);
}

/// Hands a message of the drone's autopilot to a listener.
template <class Message>
bool hears(MavlinkListener& listener, const Message& message, nanoseconds now) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(message, {1, 1}, frame);
  return listener.take(link::Bytes{frame}.first(size), now);
}

TEST(MavlinkListener, ASampleOrAttitudeThatComesTwiceOrLateIsNotTakenAgain) {
  MavlinkListener listener{{}};
  EXPECT_TRUE(hears(listener, mavlink::HighresImu{.time_usec = 2'000'000, .zacc = -9.8f}, 1s));
  EXPECT_FALSE(hears(listener, mavlink::HighresImu{.time_usec = 2'000'000, .zacc = -9.8f}, 1001ms));
  EXPECT_FALSE(hears(listener, mavlink::HighresImu{.time_usec = 1'980'000, .zacc = -9.8f}, 1002ms));
  EXPECT_TRUE(hears(listener, mavlink::HighresImu{.time_usec = 2'020'000, .zacc = -9.7f}, 1020ms));
  EXPECT_EQ(listener.state().samples, 2u);
  (void)hears(listener, mavlink::Attitude{.time_boot_ms = 2000, .roll = 0.1f}, 1s);
  (void)hears(listener, mavlink::Attitude{.time_boot_ms = 1980, .roll = 0.9f}, 1010ms);
  EXPECT_NEAR(listener.state().attitude.roll, 0.1, 1e-6);
  EXPECT_EQ(listener.state().attitude_at, 1s);
  // A clock that has begun anew is a controller that has.
  EXPECT_TRUE(hears(listener, mavlink::HighresImu{.time_usec = 10'000, .zacc = -9.6f}, 1040ms));
}

TEST(MavlinkListener, AnAttitudeThatTheLineHasHeldUpIsOld) {
  MavlinkListener listener{{}};
  // Its clock is 100 s ahead of ours; a question of 1 s was answered at once.
  (void)hears(listener, mavlink::Timesync{.tc1 = 101'002'000'000, .ts1 = 1'000'000'000}, 1004ms);
  (void)hears(listener, mavlink::Attitude{.time_boot_ms = 102'000}, 2010ms);
  EXPECT_LE(listener.state().attitude_at, 2s);
  EXPECT_GE(listener.state().attitude_at, 1997ms);
  (void)hears(listener, mavlink::Attitude{.time_boot_ms = 102'020}, 2400ms);
  EXPECT_LE(listener.state().attitude_at, 2020ms) << "it counts as fresh";
  EXPECT_GE(listener.state().attitude_at, 2017ms);
}

TEST(MavlinkListener, AnAnswerThatComesTwiceAcknowledgesOnce) {
  MavlinkListener listener{{}};
  for (int i = 0; i < 3; ++i)
    (void)hears(listener, mavlink::Timesync{.tc1 = 5'000'000, .ts1 = 1'000'001}, 20ms);
  EXPECT_EQ(listener.state().acknowledged, 1);
}

TEST(PeerClock, AnAnswerThatTookLongDoesNotCount) {
  PeerClock clock;
  clock.take({.offset = 100s, .round_trip = 4ms}, 1s);
  // A full line back: the offset looks wrong by half of what the answer waited.
  clock.take({.offset = 100s - 150ms, .round_trip = 304ms}, 2s);
  EXPECT_EQ(clock.best()->offset, 100s);
  EXPECT_EQ(clock.age(102s, 2s), 2ms);
  // The quickest answer is forgotten after a while: clocks drift.
  clock.take({.offset = 100s + 1ms, .round_trip = 6ms}, 13s);
  clock.take({.offset = 100s + 1ms, .round_trip = 6ms}, 25s);
  EXPECT_EQ(clock.best()->offset, 100s + 1ms);
}

TEST(PeerClock, AStampOfAnotherClockHasNoAge) {
  PeerClock clock;
  EXPECT_EQ(clock.age(1s, 1s), std::nullopt);
  clock.take({.offset = 100s, .round_trip = 4ms}, 1s);
  EXPECT_EQ(clock.age(3s, 3s), std::nullopt);
}

TEST(LateCounts, QuantilesAreToATenthOfAMillisecond) {
  LateCounts late;
  EXPECT_EQ(late.quantile(0.5), 0ns);
  for (int i = 0; i < 998; ++i) late.add(50us);
  late.add(7ms), late.add(2s);
  EXPECT_EQ(late.quantile(0.5), 100us);
  EXPECT_EQ(late.quantile(0.999), 7100us);
  EXPECT_EQ(late.longest(), 2s);
}

TEST(LinkUri, TheWaysToAnArduCopter) {
  EXPECT_EQ(link_uri("mavlink:serial:/dev/ttyAMA0").baud, 921600);
  EXPECT_EQ(link_uri("msp:/dev/ttyAMA0").baud, 115200);
  EXPECT_THAT(error_of([] { (void)link_uri("mavlink:serial:/dev/ttyAMA0?baud=115200"); }),
              HasSubstr("baud = 115200 is too slow for what an ArduCopter sends"));
  EXPECT_EQ(link_uri("mavlink:serial:/dev/ttyAMA0?baud=921600").baud, 921600);
  EXPECT_EQ(link_uri("mavlink:udp:10.0.0.2:14550?bind=10.0.0.1&system=3").bind, "10.0.0.1");
  EXPECT_EQ(link_uri("mavlink:udp:10.0.0.2:14550").bind, "127.0.0.1");
  EXPECT_EQ(link_uri("mavlink:tcp:127.0.0.1:5760").kind, LinkUri::Kind::kTcp);
  EXPECT_THAT(error_of([] { (void)link_uri("mavlink:/dev/ttyAMA0"); }),
              HasSubstr("mavlink:serial:"));
  EXPECT_THAT(error_of([] { (void)link_uri("mavlink:udp:14550"); }), HasSubstr("HOST:PORT"));
  EXPECT_THAT(error_of([] { (void)link_uri("mavlink:tcp:a:1?system=0"); }), HasSubstr("1..254"));
}

TEST(ArduFile, EveryKeyMustBeThereAndNoOtherMay) { test::expect_every_key_is_needed(ardu_text()); }

TEST(ArduFile, AnotherConstantIsAnotherHandOverTest) {
  const DroneFile drone = ardu_drone();
  DroneFile other = drone;
  other.ardu->expo = 0.65;
  EXPECT_NE(hand_over_mark(drone, "p"), hand_over_mark(other, "p"));
}

TEST(ArduBench, WhatIsWrittenReadsBackAsTheDrone) {
  ServedArdu served;
  Port port = served.port();
  const ArduIntroduction said = ardu_introduction_of(port, 1);
  const test::TempFolder folder;
  const auto file = folder.file(
      "drone.toml",
      drone_toml(ardu_drone_of(said.facts), {.name = "fake", .exponent = 1.0, .least_v = 19.8}));
  EXPECT_EQ(hand_over_mark(read_drone(file), "p"), hand_over_mark(ardu_drone(), "p"));
}

}  // namespace
}  // namespace gatefly::live
