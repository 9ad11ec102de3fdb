#include "viewport/state/playback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "tests/support/error_kind.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

constexpr double kFps = 64;              // frames take a time that is exact in binary
constexpr double kFrameTime = 1 / kFps;  // seconds
constexpr int kMost = std::numeric_limits<int>::max(), kLeast = std::numeric_limits<int>::min();

Playback playing(const PlayFrames& frames, PlayMode mode = PlayMode::loop, bool backwards = false) {
  Playback playback(frames, kFps);
  playback.set_mode(mode);
  playback.set_backwards(backwards);
  playback.play();
  return playback;
}

// The frames of the next `count` frame times.
std::vector<int> next(Playback& playback, int count) {
  std::vector<int> frames;
  for (int k = 0; k < count; ++k) frames.push_back(playback.advance(kFrameTime));
  return frames;
}

TEST(Playback, ShowsTheFirstFrameUntilItPlays) {
  Playback playback({7, 12}, kFps);
  EXPECT_EQ(playback.advance(3 * kFrameTime), 7);
  playback.toggle();
  EXPECT_EQ(playback.advance(0.5 * kFrameTime), 7);
  EXPECT_EQ(playback.advance(0.5 * kFrameTime), 8);
  playback.toggle();
  EXPECT_EQ(playback.advance(kFrameTime), 8);
}

TEST(Playback, KeepsTheClipsTimeWhateverTheDisplays) {
  for (const double display : {24.0, 60.0, 61.0, 144.0}) {
    Playback playback({1001, 2000}, 24);
    playback.play();
    for (int k = 0; k < 10 * static_cast<int>(display); ++k) playback.advance(1 / display);
    EXPECT_NEAR(playback.frame(), 1001 + 240, 1) << display;
    EXPECT_EQ(playback.dropped(), 0) << display;
  }
}

TEST(Playback, Loops) {
  Playback forwards = playing({1, 4});
  EXPECT_EQ(next(forwards, 8), (std::vector{2, 3, 4, 1, 2, 3, 4, 1}));
  Playback backwards = playing({1, 4}, PlayMode::loop, true);
  EXPECT_EQ(next(backwards, 8), (std::vector{4, 3, 2, 1, 4, 3, 2, 1}));
}

TEST(Playback, PingPongShowsEitherEndOnce) {
  Playback forwards = playing({1, 4}, PlayMode::ping_pong);
  EXPECT_EQ(next(forwards, 9), (std::vector{2, 3, 4, 3, 2, 1, 2, 3, 4}));
  Playback backwards = playing({1, 4}, PlayMode::ping_pong, true);
  backwards.scrub(3);
  EXPECT_EQ(next(backwards, 5), (std::vector{2, 1, 2, 3, 4}));
  Playback pair = playing({1, 2}, PlayMode::ping_pong);
  EXPECT_EQ(next(pair, 4), (std::vector{2, 1, 2, 1}));
}

TEST(Playback, PingPongSaysWhichWayItGoes) {
  Playback playback = playing({1, 3}, PlayMode::ping_pong);
  next(playback, 3);
  EXPECT_EQ(playback.frame(), 2);
  EXPECT_TRUE(playback.backwards());
  playback.set_backwards(false);  // turned by hand in the middle
  EXPECT_EQ(next(playback, 2), (std::vector{3, 2}));
}

TEST(Playback, PlaysOnceAndFromTheBeginningAgain) {
  for (const bool backwards : {false, true}) {
    Playback playback = playing({1, 3}, PlayMode::once, backwards);
    playback.scrub(2);
    const int end = backwards ? 1 : 3;
    EXPECT_EQ(next(playback, 3), (std::vector{end, end, end}));
    EXPECT_FALSE(playback.playing());
    playback.play();
    EXPECT_EQ(playback.frame(), backwards ? 3 : 1);
    EXPECT_EQ(next(playback, 2), (std::vector{2, end}));
  }
}

TEST(Playback, OneFrameStays) {
  for (const PlayMode mode : {PlayMode::loop, PlayMode::ping_pong, PlayMode::once}) {
    for (const bool backwards : {false, true}) {
      Playback playback = playing({5, 5}, mode, backwards);
      EXPECT_EQ(playback.advance(0.5), 5);
      EXPECT_EQ(playback.dropped(), 0);
      EXPECT_EQ(playback.playing(), mode != PlayMode::once);
    }
  }
}

TEST(Playback, ManyFramesAtOnceEndWhereSingleFramesDo) {
  std::mt19937 random(5);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int k = 0; k < 3000; ++k) {
    const int length = 1 + below(9), in = 1 + below(length), out = in + below(length - in + 1);
    Playback at_once = playing({1, length}, static_cast<PlayMode>(below(3)), below(2) == 1);
    at_once.set_range(in, out);
    at_once.scrub(1 + below(length));  // also outside the range
    Playback one_by_one = at_once;
    const int frames = 1 + below(60);
    int shown = at_once.frame();
    std::int64_t seen = 0;  // changes of the picture, and more where it stays for the mode's sake
    at_once.advance(frames * kFrameTime);
    for (const int frame : next(one_by_one, frames)) {
      seen += frame != shown ? 1 : 0;
      shown = frame;
    }
    ASSERT_EQ(at_once.frame(), one_by_one.frame()) << k;
    ASSERT_EQ(at_once.playing(), one_by_one.playing()) << k;
    ASSERT_EQ(at_once.dropped(), in < out ? std::max<std::int64_t>(seen - 1, 0) : 0) << k;
    ASSERT_EQ(one_by_one.dropped(), 0) << k;
    ASSERT_EQ(next(at_once, 3), next(one_by_one, 3)) << k;  // so they go the same way
  }
}

TEST(Playback, DropsFramesToKeepTimeAndCountsThem) {
  Playback playback = playing({1, 100});
  EXPECT_EQ(playback.advance(4 * kFrameTime), 5);
  EXPECT_EQ(playback.dropped(), 3);
  EXPECT_EQ(playback.advance(2.5 * kFrameTime), 7);
  EXPECT_EQ(playback.dropped(), 4);
  EXPECT_EQ(playback.advance(0.5 * kFrameTime), 8);
  EXPECT_EQ(playback.dropped(), 4);
  playback.pause();
  EXPECT_EQ(playback.dropped(), 4);  // to be read
  playback.play();
  EXPECT_EQ(playback.dropped(), 0);
}

TEST(Playback, EveryFrameIsShownHoweverLate) {
  Playback playback = playing({1, 10});
  playback.set_real_time(false);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> late(0, 8 * kFrameTime);
  std::set<int> frames;
  for (int k = 0; k < 500; ++k) {
    const int before = playback.frame();
    const int frame = playback.advance(late(random));
    EXPECT_TRUE(frame == before || frame == before % 10 + 1) << before << " " << frame;
    frames.insert(frame);
  }
  EXPECT_EQ(frames.size(), 10u);
  EXPECT_EQ(playback.dropped(), 0);
  EXPECT_EQ(playback.advance(0), playback.frame());  // nor is it hurried afterwards
}

TEST(Playback, EveryFrameIsNotFasterThanTheClip) {
  Playback playback = playing({1, 1000});
  playback.set_real_time(false);
  for (int k = 0; k < 100; ++k) playback.advance(kFrameTime / 4);
  EXPECT_EQ(playback.frame(), 26);
}

TEST(Playback, AStallIsNotPlayed) {
  for (const double stall : {10.0, 1e9, std::numeric_limits<double>::infinity()}) {
    Playback playback = playing({1, 1000});
    EXPECT_EQ(playback.advance(stall), 1 + static_cast<int>(Playback::kLongestGap * kFps)) << stall;
    EXPECT_LT(playback.dropped(), kFps);
    EXPECT_EQ(playback.advance(kFrameTime), 2 + static_cast<int>(Playback::kLongestGap * kFps));
  }
}

// What steps every frame would take longer for a late picture, and make the next one later still.
TEST(Playback, LatePicturesGoOnByAFewFramesWhereThatIsAsked) {
  Playback playback = playing({1, 1000});
  for (const int frame : {3, 5, 7}) EXPECT_EQ(playback.advance(0.5, 2), frame);
  EXPECT_EQ(playback.advance(kFrameTime, 2), 8);  // what was not played is not caught up on
  EXPECT_EQ(playback.advance(2 * kFrameTime), 10);
}

TEST(Playback, WhatIsNoTimeChangesNothing) {
  Playback playback = playing({1, 10});
  playback.advance(0.75 * kFrameTime);
  for (const double seconds : {0.0, -1.0, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(playback.advance(seconds), 1);
  }
  EXPECT_EQ(playback.advance(0.25 * kFrameTime), 2);  // and what had passed is not lost
}

TEST(Playback, RangesStayWithinTheClip) {
  Playback playback = playing({1001, 1100});
  playback.set_range(1004, 1007);
  EXPECT_EQ(playback.in(), 1004);
  EXPECT_EQ(playback.out(), 1007);
  playback.set_range(kLeast, kMost);
  EXPECT_EQ(playback.in(), 1001);
  EXPECT_EQ(playback.out(), 1100);
  for (const auto& [in, out] : {std::pair{1007, 1004}, {1, 1000}, {1101, 1200}, {kMost, kLeast}}) {
    EXPECT_EQ(kind_of([&, a = in, b = out] { playback.set_range(a, b); }), ErrorKind::usage) << in << " " << out;
  }
  EXPECT_EQ(playback.out(), 1100);  // as it was
}

TEST(Playback, TheRangeMayChangeWhilePlaying) {
  Playback playback = playing({1, 100});
  playback.scrub(50);
  playback.set_range(40, 51);
  EXPECT_EQ(next(playback, 3), (std::vector{51, 40, 41}));
  playback.set_range(60, 62);
  EXPECT_EQ(playback.frame(), 41);  // shown until its time is over
  EXPECT_EQ(next(playback, 4), (std::vector{60, 61, 62, 60}));
  playback.set_backwards(true);
  playback.set_range(10, 12);
  EXPECT_EQ(next(playback, 4), (std::vector{12, 11, 10, 12}));
}

TEST(Playback, AnotherPlaysAsItsSettingsSay) {
  Playback playback({1, 10}, 24);
  EXPECT_EQ(playback.settings(), PlaySettings{});
  playback.set_mode(PlayMode::once);
  playback.set_speed(0.5);
  playback.set_backwards(true);
  playback.set_real_time(false);
  playback.set_range(3, 10);
  const PlaySettings settings{PlayMode::once, 0.5, true, false, 3, std::nullopt};
  EXPECT_EQ(playback.settings(), settings);
  Playback other({3, 10}, 30);
  other.apply(settings);
  EXPECT_EQ(other.settings(), (PlaySettings{PlayMode::once, 0.5, true, false, std::nullopt, std::nullopt}));
}

TEST(Playback, ScrubbingGoesOnPlaying) {
  Playback playback = playing({1, 100});
  playback.advance(0.9 * kFrameTime);
  playback.scrub(30);
  EXPECT_TRUE(playback.playing());
  EXPECT_EQ(playback.advance(0.5 * kFrameTime), 30);  // the frame has its whole time
  EXPECT_EQ(playback.advance(0.5 * kFrameTime), 31);
  playback.scrub(-5);
  EXPECT_EQ(playback.frame(), 1);
  playback.scrub(kMost);
  EXPECT_EQ(playback.frame(), 100);
}

TEST(Playback, StepsPauseAndStayInTheClip) {
  Playback playback = playing({1, 10});
  playback.set_range(4, 6);
  playback.scrub(6);
  playback.step(1);
  EXPECT_FALSE(playback.playing());
  EXPECT_EQ(playback.frame(), 7);
  playback.step(-3);
  EXPECT_EQ(playback.frame(), 4);
  playback.step(kLeast);
  EXPECT_EQ(playback.frame(), 1);
  playback.step(kMost);
  EXPECT_EQ(playback.frame(), 10);
  playback.scrub(playback.in());
  EXPECT_EQ(playback.frame(), 4);
  playback.scrub(playback.out());
  EXPECT_EQ(playback.frame(), 6);
}

TEST(Playback, GoesFromKeyToKey) {
  Playback playback({1001, 1100}, kFps);
  playback.set_keys({1049, 1001, 1021, 1019, 900, 1200, 1021});
  EXPECT_EQ(playback.keys(), (std::vector{1001, 1019, 1021, 1049}));
  const std::vector<int> of_clip = playback.keys();
  const std::set<int> keys(of_clip.begin(), of_clip.end());
  std::vector<int> there, back;
  for (int k = 0; k < 4; ++k) {
    playback.go_to_next_key(keys);
    there.push_back(playback.frame());
  }
  for (int k = 0; k < 4; ++k) {
    playback.go_to_previous_key(keys);
    back.push_back(playback.frame());
  }
  EXPECT_EQ(there, (std::vector{1019, 1021, 1049, 1049}));
  EXPECT_EQ(back, (std::vector{1021, 1019, 1001, 1001}));
  playback.scrub(1060);
  playback.go_to_previous_key(keys);
  EXPECT_EQ(playback.frame(), 1049);
  playback.go_to_next_key({});
  EXPECT_EQ(playback.frame(), 1049);
}

TEST(Playback, SpeedStretchesTime) {
  for (const double speed : {0.125, 0.5, 2.0}) {
    Playback playback = playing({1, 100});
    playback.set_speed(speed);
    for (int k = 0; k < 32; ++k) playback.advance(kFrameTime / 2);
    EXPECT_EQ(playback.frame(), 1 + static_cast<int>(16 * speed));
  }
}

TEST(Playback, RefusesWhatCannotBePlayed) {
  EXPECT_EQ(kind_of([] { Playback({2, 1}, 24); }), ErrorKind::usage);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double fps : {0.0, -24.0, 1e4, nan}) {
    EXPECT_EQ(kind_of([&] { Playback({1, 2}, fps); }), ErrorKind::usage);
  }
  Playback playback({1, 2}, 24);
  for (const double speed : {0.0, 0.05, 2.5, -1.0, nan}) {
    EXPECT_EQ(kind_of([&] { playback.set_speed(speed); }), ErrorKind::usage);
  }
  EXPECT_EQ(playback.speed(), 1);
}

TEST(Playback, TheLongestClipDoesNotOverflow) {
  Playback playback = playing({kLeast, kMost}, PlayMode::ping_pong);
  playback.set_range(kMost - 1, kMost);
  playback.scrub(kMost);
  EXPECT_EQ(next(playback, 3), (std::vector{kMost - 1, kMost, kMost - 1}));
}

}  // namespace
}  // namespace bodyopt::testing
