// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay_player.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <random>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/hand_motion.h"
#include "recorder/base/errors.h"
#include "recorder/recording/probe.h"
#include "recorder/replay.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/recorder/support/rerun.h"
#include "tests/recorder/support/small_scene.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using recorder::test::Folder;

/// Remembers what a player says.
class Listener {
 public:
  ReplayPlayer::Receiver receiver() {
    return {[this](std::shared_ptr<const SceneView> view, const PlayerPosition& position) {
              const std::lock_guard lock(mutex_);
              view_ = std::move(view);
              position_ = position;
              steps_.push_back(position.step);
              changed_.notify_all();
            },
            [this](const std::string& fault) {
              const std::lock_guard lock(mutex_);
              fault_ = fault;
              changed_.notify_all();
            }};
  }
  /// Waits until it shows what the condition wants. @return false after a minute, or when the player failed
  bool await(const std::function<bool(const PlayerPosition&)>& condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), [&] {
      return !fault_.empty() || (view_ && condition(position_));
    }) && fault_.empty();
  }
  bool awaitStep(std::uint64_t step) {
    return await([step](const PlayerPosition& p) { return p.settled && p.step == step && !p.playing; });
  }
  std::string awaitFault() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::minutes(1), [&] { return !fault_.empty(); });
    return fault_;
  }
  std::shared_ptr<const SceneView> view() {
    const std::lock_guard lock(mutex_);
    return view_;
  }
  PlayerPosition position() {
    const std::lock_guard lock(mutex_);
    return position_;
  }
  std::vector<std::uint64_t> steps() {
    const std::lock_guard lock(mutex_);
    return steps_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const SceneView> view_;
  PlayerPosition position_;
  std::vector<std::uint64_t> steps_;
  std::string fault_;
};

/// One recording of 3.2 s for all tests: 320 steps, keyframes about every second.
struct Recorded {
  Folder folder;
  std::filesystem::path file = folder / "r.h5";
  std::string attempt = test::recordPerformer(file, 3.2);
};
const Recorded& recorded() {
  static const Recorded made;
  return made;
}

/// Every number of the surfaces and instruments, to be compared bit for bit.
std::vector<double> numbersOf(const SceneView& view) {
  std::vector<double> numbers{static_cast<double>(view.step), view.time};
  for (const SurfaceView& surface : view.surface) {
    for (const Vec3& p : surface.position) numbers.insert(numbers.end(), p.data(), p.data() + 3);
  }
  for (const InstrumentView& instrument : view.instrument)
    numbers.insert(numbers.end(), instrument.pose.position.data(), instrument.pose.position.data() + 3);
  return numbers;
}

TEST(ReplayPlayer, OpensAtTheFirstStep) {
  Listener listener;
  const ReplayPlayer player(recorded().file, recorded().attempt, listener.receiver());
  ASSERT_TRUE(listener.awaitStep(0)) << listener.awaitFault();
  EXPECT_EQ(listener.position().steps, 320U);
  EXPECT_DOUBLE_EQ(listener.position().seconds, 3.2);
  EXPECT_DOUBLE_EQ(listener.position().time, 0.01);
}

TEST(ReplayPlayer, ShowsTheStateThatTheSimulationGivesWhereverItGoes) {
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  Listener listener;
  ReplayPlayer player(recorded().file, recorded().attempt, listener.receiver());
  ASSERT_TRUE(listener.awaitStep(0));
  for (int i = 0; i < 6; ++i) {
    const std::uint64_t step = std::uniform_int_distribution<std::uint64_t>(0, 319)(random);
    player.ask({.time = (static_cast<double>(step) + 0.5) * 0.01});
    ASSERT_TRUE(listener.awaitStep(step)) << step;
    // From the very beginning, without any keyframe.
    recorder::Recording recording(recorded().file);
    const auto scene = recorder::sceneOf(recording);
    SerialExecutor executor;
    recorder::Session session(scene->model(), recording.header().seed, executor);
    while (session.steps() <= step) recorder::test::rerun(session, recording.step(session.steps()));
    EXPECT_EQ(numbersOf(*listener.view()), numbersOf(session.view())) << "step " << step;
  }
}

TEST(ReplayPlayer, TheLastOfManyWishesIsShown) {
  Listener listener;
  ReplayPlayer player(recorded().file, recorded().attempt, listener.receiver());
  ASSERT_TRUE(listener.awaitStep(0));
  for (int i = 0; i < 300; ++i) player.ask({.time = 0.01 * static_cast<double>(319 - i)});
  player.ask({.time = 2.505});
  EXPECT_TRUE(listener.awaitStep(250));
  EXPECT_LT(listener.steps().size(), 300U) << "wishes that were overtaken are not shown";
}

TEST(ReplayPlayer, SingleStepsAddUpAndStopAtTheEnds) {
  Listener listener;
  ReplayPlayer player(recorded().file, recorded().attempt, listener.receiver());
  player.ask({.time = 1.505});
  ASSERT_TRUE(listener.awaitStep(150));
  player.ask({.steps = 1});
  ASSERT_TRUE(listener.awaitStep(151));
  for (int i = 0; i < 7; ++i) player.ask({.steps = -1});
  ASSERT_TRUE(listener.awaitStep(144));
  player.ask({.steps = -1000});
  ASSERT_TRUE(listener.awaitStep(0));
  player.ask({.steps = 1000});
  ASSERT_TRUE(listener.awaitStep(319));
  player.ask({.time = -5.0});
  ASSERT_TRUE(listener.awaitStep(0));
  player.ask({.time = 1e9});
  EXPECT_TRUE(listener.awaitStep(319));
}

TEST(ReplayPlayer, PlaysToTheEndStopsThereAndBeginsAnew) {
  Listener listener;
  ReplayPlayer player(recorded().file, recorded().attempt, listener.receiver());
  ASSERT_TRUE(listener.awaitStep(0));
  player.ask({.speed = 16.0});
  player.ask({.playing = true});
  ASSERT_TRUE(listener.awaitStep(319));
  const std::vector<std::uint64_t> steps = listener.steps();
  EXPECT_TRUE(std::is_sorted(steps.begin(), steps.end())) << "playing goes forward only";
  player.ask({.playing = true});
  EXPECT_TRUE(listener.await([](const PlayerPosition& p) { return p.playing && p.step < 319; }));
  player.ask({.playing = false});
  EXPECT_TRUE(listener.await([](const PlayerPosition& p) { return !p.playing; }));
}

TEST(ReplayPlayer, SpeedsStayWithinTheirBounds) {
  Listener listener;
  ReplayPlayer player(recorded().file, recorded().attempt, listener.receiver());
  ASSERT_TRUE(listener.awaitStep(0));
  player.ask({.speed = 1e6});
  EXPECT_TRUE(listener.await([](const PlayerPosition& p) { return p.speed == 16.0; }));
  player.ask({.speed = -1.0});
  EXPECT_TRUE(listener.await([](const PlayerPosition& p) { return p.speed == 0.1; }));
}

TEST(ReplayPlayer, SaysWhyARecordingCannotBeShown) {
  const Folder folder;
  std::ofstream(folder / "text.h5") << "no recording at all";
  const auto faultOf = [](const std::filesystem::path& file, const std::string& attempt) {
    Listener listener;
    const ReplayPlayer player(file, attempt, listener.receiver());
    return listener.awaitFault();
  };
  EXPECT_NE(faultOf(folder / "missing.h5", "").find("missing.h5"), std::string::npos);
  EXPECT_NE(faultOf(folder / "text.h5", "").find("text.h5"), std::string::npos);
  const std::string other = "00000000-0000-4000-8000-000000000000";
  expectNames(faultOf(recorded().file, other), {"r.h5: ", recorded().attempt, other});
}

TEST(ReplayPlayer, EndsInTheMiddleOfALongWay) {
  Listener listener;
  auto player = std::make_unique<ReplayPlayer>(recorded().file, "", listener.receiver());
  ASSERT_TRUE(listener.awaitStep(0));
  player->ask({.time = 0.9});
  player.reset();  // joins: hangs here if a wish to end is not heard
}

/// Flips a byte without which the first step can be read. @return false where none was found
bool damageBehindItsBeginning(const std::filesystem::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const auto put = [&](std::size_t at, char byte) {
    file.clear();
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte).flush();
  };
  for (std::size_t at = bytes.size() / 2; at < bytes.size(); at += 997) {
    put(at, static_cast<char>(bytes[at] ^ 1));
    try {
      recorder::probeBeginning(path);
      try {
        if (!recorder::probe(path).intact()) return true;
      } catch (const Error&) {
        return true;
      }
    } catch (const Error&) {
    }
    put(at, bytes[at]);
  }
  return false;
}

TEST(ReplayPlayer, GivesAGlimpseBeforeAllWasRead) {
  const Folder folder;
  std::filesystem::copy_file(recorded().file, folder / "new.h5");
  const auto glimpses = [&](const char* file, bool intact) {
    std::vector<std::uint64_t> seen;
    Listener listener;
    ReplayPlayer::Receiver receiver = listener.receiver();
    receiver.glimpse = [&](const std::shared_ptr<const SceneView>& view) {
      EXPECT_EQ(listener.view(), nullptr) << "before the first moment";
      seen.push_back(view->step);
    };
    const ReplayPlayer player(folder / file, "", receiver);
    EXPECT_EQ(listener.awaitStep(0), intact) << listener.awaitFault();
    return seen;
  };
  EXPECT_EQ(glimpses("new.h5", true), std::vector<std::uint64_t>{1}) << "the step is done";
  EXPECT_TRUE(glimpses("new.h5", true).empty()) << "all of it was read before";
  ASSERT_TRUE(damageBehindItsBeginning(folder / "new.h5"));
  EXPECT_EQ(glimpses("new.h5", false), std::vector<std::uint64_t>{1}) << "and then it is refused";
}

TEST(AttemptTrack, HoldsWhatTheRecordingsStepsSay) {
  recorder::Recording recording(recorded().file);
  const AttemptTrack track = readTrack(recording);
  EXPECT_EQ(track.none, "");
  EXPECT_DOUBLE_EQ(track.seconds, 3.2);
  EXPECT_DOUBLE_EQ(track.bin, 0.01) << "320 steps need no wider bins";
  // Again, step by step, for both hands.
  std::array<double, handCount> largest{};
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    for (std::size_t h = 0; h < handCount; ++h) {
      double force = 0.0;
      for (const auto& tick : step.ticks) force = std::max(force, tick.hand[h].force.norm());
      ASSERT_EQ(track.hand[h].force[n], force);
      largest[h] = std::max(largest[h], force);
    }
  }
  EXPECT_GT(std::max(largest[0], largest[1]), 0.05) << "the performer touches the liver";
  const std::array<analytics::Motion, handCount> motion = analytics::motionOf(recording, analytics::motionCutoff);
  for (std::size_t h = 0; h < handCount; ++h) {
    double traced = 0.0;
    for (const double speed : track.hand[h].speed) traced += speed * track.bin;
    const double way = analytics::pathLength(motion[h]);
    EXPECT_NEAR(traced, way, 1e-9) << "speeds add up to the way that the path's figure has";
    EXPECT_GT(way, 0.01);
  }
}

TEST(AttemptTrack, BreaksOffWhenItsProgressThrows) {
  recorder::Recording recording(recorded().file);
  EXPECT_THROW(readTrack(recording, [](std::uint64_t, std::uint64_t) { throw std::runtime_error("enough"); }),
               std::runtime_error);
}

TEST(AttemptTrack, TimesReadAsMinutesSecondsAndTenths) {
  EXPECT_EQ(timeText(0.0), "0:00.0");
  EXPECT_EQ(timeText(9.96), "0:09.9");
  EXPECT_EQ(timeText(62.5), "1:02.5");
  EXPECT_EQ(timeText(3723.05), "62:03.0");
  EXPECT_EQ(timeText(-1.0), "0:00.0");
  EXPECT_EQ(timeText(0.3), "0:00.3") << "0.3 is a little less than three tenths";
}

}  // namespace
}  // namespace calot::gui
