// SPDX-License-Identifier: GPL-3.0-or-later
// Mouse and keyboard as a device, on a clock of the test's own.
#include "recorder/sources/devices/mouse_device.h"

#include <gtest/gtest.h>

#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/source.h"
#include "sim/math/random.h"
#include "tests/recorder/sources/devices/support/device_support.h"

namespace calot::recorder::mouse_test {
namespace {

struct Rig {
  std::shared_ptr<MouseInput> mouse = std::make_shared<MouseInput>();
  std::int64_t now = 1'000'000'000;
  MouseDevice device{mouse, [this] { return now; }};
  DeviceInput input;

  /// Lets so many milliseconds pass; the last sample of a hand.
  DeviceSample run(int milliseconds, Hand hand = Hand::right) {
    for (int i = 0; i < milliseconds; ++i) {
      now += 1'000'000;
      device.poll(std::chrono::nanoseconds(0), input);
    }
    for (auto it = input.samples.rbegin(); it != input.samples.rend(); ++it) {
      if (it->hand == hand) return *it;
    }
    ADD_FAILURE() << "no sample of that hand";
    return {};
  }
};

TEST(Mouse, PointerMovesTheTipByPixelsAndNeverTooFast) {
  Rig rig;
  EXPECT_EQ(rig.run(20).position, Vec3::Zero());
  rig.mouse->move(100.0, -40.0);
  EXPECT_NEAR((rig.run(100).position - Vec3(0.015, -0.006, 0)).norm(), 0.0, 1e-12);
  rig.input.samples.clear();
  rig.mouse->move(600.0, 0.0);  // 90 mm at once
  rig.run(400);
  const DeviceSample* before = nullptr;
  for (const DeviceSample& s : rig.input.samples) {
    if (s.hand != Hand::right) continue;
    if (before != nullptr) {
      const double seconds = 1e-9 * static_cast<double>(s.hostTime - before->hostTime);
      EXPECT_LE((s.position - before->position).norm(), 0.5 * seconds + 1e-12);
    }
    before = &s;
  }
  EXPECT_NEAR((before->position - Vec3(0.105, -0.006, 0)).norm(), 0.0, 1e-12);
}

TEST(Mouse, KeysGoAlongTheShaft) {
  Rig rig;
  const Vec3 port(0.03, -0.04, -0.12);  // 130 mm from the tip
  rig.mouse->setPorts({Vec3::Zero(), port});
  rig.run(20);
  const Vec3 shaft = -port / 0.13;
  rig.mouse->hold(MouseControl::in, true);
  const Vec3 in = rig.run(400).position;
  EXPECT_NEAR(in.dot(shaft), 0.012, 2e-4);
  EXPECT_NEAR(in.cross(shaft).norm(), 0.0, 1e-12);
  rig.mouse->hold(MouseControl::in, false);
  // It is not drawn out of its port.
  rig.mouse->hold(MouseControl::out, true);
  EXPECT_NEAR((rig.run(8000).position - port).norm(), 0.01, 1e-9);
}

// The shaft comes from the side: along it, depth would carry the tip across the picture.
TEST(Mouse, TheWheelLeavesTheTipWhereItIsInThePicture) {
  Rig rig;
  const Vec3 port(0.12, -0.04, -0.03), eye(-0.03, 0.02, -0.1);
  rig.mouse->setPorts({Vec3::Zero(), port});
  rig.mouse->setEyes({Vec3::Zero(), eye});
  rig.run(20);
  const auto inPicture = [&](const Vec3& tip) {
    const Vec3 seen = tip - eye;
    return Vec3(seen / seen.z());
  };
  rig.mouse->move(60.0, -30.0);
  const Vec3 before = rig.run(200).position;
  rig.mouse->turnWheel(4.0);
  const Vec3 after = rig.run(200).position;
  EXPECT_NEAR((after - before).norm(), 0.012, 1e-12);
  EXPECT_GT(after.z(), before.z() + 0.01);
  EXPECT_NEAR((inPicture(after) - inPicture(before)).norm(), 0.0, 1e-12);
  rig.mouse->turnWheel(-4.0);
  EXPECT_NEAR((rig.run(200).position - before).norm(), 0.0, 1e-12);
  // It comes neither into the lens nor out of its port.
  rig.mouse->turnWheel(-400.0);
  EXPECT_NEAR((rig.run(5000).position - eye).norm(), 0.02, 1e-9);
}

TEST(Mouse, TheWheelDrawsNoTipOutOfItsPort) {
  Rig rig;
  const Vec3 port(0.0, 0.0, -0.05);  // on the line of sight
  rig.mouse->setPorts({Vec3::Zero(), port});
  rig.run(20);
  rig.mouse->turnWheel(-400.0);
  EXPECT_GE((rig.run(5000).position - port).norm(), 0.01);
}

TEST(Mouse, KeysRollJawAndPedals) {
  Rig rig;
  rig.run(20);
  for (const MouseControl c : {MouseControl::right, MouseControl::rollRight, MouseControl::openJaw, MouseControl::cut,
                               MouseControl::coagulate, MouseControl::fire})
    rig.mouse->hold(c, true);
  const DeviceSample s = rig.run(400);
  EXPECT_NEAR((s.position - Vec3(0.012, 0, 0)).norm(), 0.0, 2e-4);
  EXPECT_NEAR(s.orientation.angularDistance(Quat(Eigen::AngleAxisd(0.6, Vec3::UnitZ()))), 0.0, 0.01);
  EXPECT_NEAR(s.gripper, 0.72, 0.01);
  EXPECT_EQ(s.buttons, button::cutPedal | button::coagulatePedal | button::fire);
  EXPECT_NEAR(rig.run(3000).gripper, 1.2, 1e-12);
  rig.mouse->release();
  const DeviceSample still = rig.run(20);
  EXPECT_EQ(still.buttons, 0);
  EXPECT_EQ(rig.run(200).position, still.position);
  rig.mouse->hold(MouseControl::fine, true);
  rig.mouse->move(100.0, 0.0);
  EXPECT_NEAR(rig.run(100).position.x() - still.position.x(), 0.25 * 0.015, 1e-12);
}

TEST(Mouse, TheHandThatIsLeftHolds) {
  Rig rig;
  rig.mouse->move(50.0, 0.0);
  rig.mouse->hold(MouseControl::cut, true);
  rig.mouse->toggleLock();
  const DeviceSample right = rig.run(100);
  EXPECT_EQ(right.buttons, button::cutPedal | button::lock);
  rig.mouse->switchHand();
  EXPECT_EQ(rig.mouse->hand(), Hand::left);
  rig.mouse->move(0.0, 80.0);
  EXPECT_NEAR((rig.run(300, Hand::left).position - Vec3(0, 0.012, 0)).norm(), 0.0, 1e-12);
  const DeviceSample held = rig.run(1, Hand::right);
  EXPECT_EQ(held.position, right.position);
  EXPECT_EQ(held.buttons, button::lock) << "the ratchet holds, the pedal does not";
  EXPECT_EQ(rig.run(1, Hand::left).buttons, button::cutPedal) << "the lock is the other hand's";
  rig.mouse->reset();
  EXPECT_EQ(rig.mouse->hand(), Hand::right);
  EXPECT_EQ(rig.run(200, Hand::right).buttons, 0U);
}

// Whatever is done: samples are numbers within reach, in rising order, and no hand is ever silent for 100 ms, after
// which it would not be measured.
TEST(Mouse, AnythingAtAllGivesGoodSamples) {
  const std::uint64_t seed = 20;
  SCOPED_TRACE(seed);
  Random random(seed, 1);
  Rig rig;
  rig.mouse->setPorts({Vec3(0.05, 0.05, -0.1), Vec3(-0.05, 0.05, -0.1)});
  for (int i = 0; i < 3000; ++i) {
    const double right = random.uniform(-200.0, 200.0);
    const double down = random.uniform(-200.0, 200.0);
    rig.mouse->move(right, down);
    rig.mouse->turnWheel(random.uniform(-5.0, 5.0));
    const auto control = static_cast<MouseControl>(random.uniform(0.0, static_cast<double>(mouseControls) - 1e-9));
    rig.mouse->hold(control, random.uniform(0.0, 1.0) < 0.5);
    if (random.uniform(0.0, 1.0) < 0.05) rig.mouse->switchHand();
    if (random.uniform(0.0, 1.0) < 0.05) rig.mouse->toggleLock();
    rig.run(1 + static_cast<int>(random.uniform(0.0, 10.0)), rig.mouse->hand());
  }
  std::array<const DeviceSample*, handCount> before{};
  for (const DeviceSample& s : rig.input.samples) {
    ASSERT_TRUE(s.position.allFinite());
    ASSERT_LE(s.position.cwiseAbs().maxCoeff(), 0.2);
    ASSERT_NEAR(s.orientation.norm(), 1.0, 1e-12);
    ASSERT_GE(s.gripper, 0.0);
    ASSERT_LE(s.gripper, 1.2);
    const DeviceSample*& last = before[static_cast<std::size_t>(s.hand)];
    if (last != nullptr) {
      ASSERT_EQ(s.sequence, last->sequence + 1);
      ASSERT_GT(s.hostTime, last->hostTime);
      ASSERT_LT(s.hostTime - last->hostTime, 50'000'000);
    }
    last = &s;
  }
}

/// The device behind its source, on the tick clock.
struct SourceRig {
  SceneDescription scene = devicetest::emptyScene();
  std::shared_ptr<MouseInput> mouse = std::make_shared<MouseInput>();
  std::shared_ptr<TickClock> clock = std::make_shared<TickClock>();
  std::unique_ptr<DeviceSource> source;
  std::uint64_t tick = 0;
  TickSamples now;

  SourceRig() {
    DeviceSourceSettings settings;
    settings.tickClock = clock;
    source = std::make_unique<DeviceSource>(
        std::make_unique<MouseDevice>(mouse, [ticks = clock] { return ticks->now; }), scene, settings);
  }
  void run(SampleSource& from, int ticks) {
    for (int i = 0; i < ticks; ++i) ASSERT_TRUE(from.next(tick++, now));
  }
};

TEST(Mouse, BothHandsAreMeasuredWhicheverIsDriven) {
  SourceRig rig;
  rig.source->waitForFirst(1.0);
  rig.mouse->switchHand();
  for (int i = 0; i < 2000; ++i) {
    rig.run(*rig.source, 1);
    for (std::size_t h = 0; h < handCount; ++h) {
      ASSERT_TRUE(rig.now.hand[h].valid) << "tick " << i;
      ASSERT_EQ(rig.now.hand[h].instrument, rig.scene.hands[h].instrument);
    }
  }
}

TEST(Mouse, ABranchSetsOutFromWhereTheHandsWere) {
  SourceRig rig;
  TickSamples start;
  for (std::size_t h = 0; h < handCount; ++h) {
    start.hand[h].position = rig.scene.hands[h].home + Vec3(0.01, 0.002, -0.003);
    start.hand[h].orientation = Quat(0.5, 0.5, 0.5, 0.5);
  }
  start = roundedToGrid(start);
  rig.source->setOutFrom(start);
  rig.source->waitForFirst(1.0);
  rig.run(*rig.source, 50);
  for (std::size_t h = 0; h < handCount; ++h) EXPECT_EQ(rig.now.hand[h].position, start.hand[h].position);
}

TEST(Mouse, TheFirstMotionIsAwaited) {
  SourceRig rig;
  rig.source->waitForFirst(1.0);
  const auto movesWithin = [&](int calls) {
    for (int i = 0; i < calls; ++i)
      if (rig.source->moved()) return true;
    return false;
  };
  EXPECT_FALSE(movesWithin(500));
  rig.mouse->move(3.0, 0.0);  // 0.45 mm: a hand trembles
  EXPECT_FALSE(movesWithin(100));
  rig.mouse->move(30.0, 0.0);
  EXPECT_TRUE(movesWithin(100));
  rig.run(*rig.source, 1);
  for (std::size_t h = 0; h < handCount; ++h)
    EXPECT_LT((rig.now.hand[h].position - rig.scene.hands[h].home).norm(), 1e-4) << "the attempt begins at home";
  SourceRig pressing;
  pressing.source->waitForFirst(1.0);
  EXPECT_FALSE(pressing.source->moved());
  pressing.mouse->hold(MouseControl::cut, true);
  bool moved = false;
  for (int i = 0; i < 100 && !moved; ++i) moved = pressing.source->moved();
  EXPECT_TRUE(moved) << "a pedal, too";
}

TEST(Mouse, ABranchActsOnlyWhenTheHandDoes) {
  SourceRig rig;
  rig.mouse->hold(MouseControl::fire, true);
  devicetest::expectNothingActs(*rig.source, rig.scene);
  rig.tick = 5000;
  rig.mouse->hold(MouseControl::fire, false);
  rig.mouse->hold(MouseControl::closeJaw, true);
  rig.run(*rig.source, 100);
  rig.mouse->hold(MouseControl::closeJaw, false);
  EXPECT_NEAR(rig.now.hand[1].jaw, 0.75 - 0.18, 0.01) << "from where it was, not from the mouse's own zero";
  EXPECT_EQ(rig.now.hand[1].buttons, 0U);
  rig.mouse->hold(MouseControl::fire, true);
  rig.run(*rig.source, 10);
  EXPECT_EQ(rig.now.hand[1].buttons, button::fire) << "pressed anew";
  rig.mouse->switchHand();
  rig.mouse->toggleLock();
  rig.run(*rig.source, 20);
  EXPECT_EQ(rig.now.hand[0].buttons & button::lock, 0U) << "one press lets go";
}

TEST(ControlledSource, HoldsExchangesAndEnds) {
  SourceRig rig;
  rig.source->waitForFirst(1.0);
  ControlledSource controlled(*rig.source);
  rig.run(controlled, 100);
  const TickSamples before = rig.now;
  EXPECT_EQ(controlled.status(), SourceStatus::ok);
  controlled.hold(true);
  EXPECT_EQ(controlled.status(), SourceStatus::paused);
  rig.mouse->move(400.0, 0.0);  // while the run is held
  rig.mouse->hold(MouseControl::openJaw, true);
  rig.mouse->hold(MouseControl::cut, true);
  for (int i = 0; i < 200; ++i) {
    rig.clock->now += 2'000'000;
    EXPECT_EQ(controlled.status(), SourceStatus::paused);
  }
  rig.mouse->hold(MouseControl::openJaw, false);
  controlled.hold(false);
  EXPECT_EQ(controlled.status(), SourceStatus::ok);
  rig.run(controlled, 20);
  EXPECT_EQ(rig.now.hand[1].position, before.hand[1].position) << "what was done in the pause moved the hand";
  EXPECT_EQ(rig.now.hand[1].jaw, before.hand[1].jaw) << "what was done in the pause opened the jaw";
  EXPECT_EQ(rig.now.hand[1].buttons, 0U) << "a pedal that went down in the pause counts once it was let go";
  rig.mouse->hold(MouseControl::cut, false);
  rig.mouse->move(10.0, 0.0);
  rig.run(controlled, 20);
  EXPECT_NEAR((rig.now.hand[1].position - before.hand[1].position).norm(), 0.0015, 2e-6);

  controlled.mount(Hand::left, InstrumentKind::scissors);
  rig.run(controlled, 1);
  EXPECT_EQ(rig.now.hand[0].instrument, InstrumentKind::scissors);
  EXPECT_EQ(rig.now.hand[1].instrument, rig.scene.hands[1].instrument);

  controlled.hold(true);
  controlled.finish(Outcome::abandoned);
  EXPECT_EQ(controlled.status(), SourceStatus::ok) << "what is to end is held back";
  EXPECT_FALSE(controlled.next(rig.tick, rig.now));
  EXPECT_EQ(controlled.ending(), Outcome::abandoned);
}

TEST(ControlledSource, AnExchangeTakesItsTime) {
  SourceRig rig;
  rig.source->waitForFirst(1.0);
  ControlledSource controlled(*rig.source);
  rig.run(controlled, 10);
  const InstrumentKind had = rig.now.hand[0].instrument;
  EXPECT_FALSE(controlled.exchanging(Hand::left));
  controlled.exchange(Hand::left, had, 300);
  rig.run(controlled, 1);
  EXPECT_EQ(rig.now.hand[0].instrument, had) << "it has that one already";
  controlled.exchange(Hand::left, InstrumentKind::hook, 300);
  rig.run(controlled, 100);
  EXPECT_EQ(rig.now.hand[0].instrument, InstrumentKind::none);
  EXPECT_NE(rig.now.hand[1].instrument, InstrumentKind::none) << "the other hand goes on";
  ASSERT_TRUE(controlled.exchanging(Hand::left));
  EXPECT_EQ(controlled.exchanging(Hand::left)->coming, InstrumentKind::hook);
  EXPECT_EQ(controlled.exchanging(Hand::left)->ticks, 200U);
  controlled.exchange(Hand::left, InstrumentKind::scissors, 300);  // thought better of
  rig.run(controlled, 300);
  EXPECT_EQ(rig.now.hand[0].instrument, InstrumentKind::none);
  rig.run(controlled, 1);
  EXPECT_EQ(rig.now.hand[0].instrument, InstrumentKind::scissors);
  EXPECT_FALSE(controlled.exchanging(Hand::left));
}

/// A request is one tick pressed and one let go, by a hand that is measured.
TEST(ControlledSource, AsksForRetractionTickByTick) {
  SourceRig rig;
  rig.source->waitForFirst(1.0);
  ControlledSource controlled(*rig.source);
  rig.run(controlled, 10);
  controlled.ask(true);
  controlled.ask(true);
  controlled.ask(false);
  std::vector<int> pressed;
  for (int i = 0; i < 8; ++i) {
    rig.run(controlled, 1);
    pressed.push_back(rig.now.hand[0].buttons | rig.now.hand[1].buttons);
  }
  constexpr int more = button::retractMore, less = button::retractLess;
  EXPECT_EQ(pressed, (std::vector<int>{more, 0, more, 0, less, 0, 0, 0}));
}

}  // namespace
}  // namespace calot::recorder::mouse_test
