// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/attempt_monitor.h"

#include <gtest/gtest.h>

namespace calot::gui {
namespace {

using std::chrono::milliseconds;

/// Ends after so many ticks.
class Ticks final : public recorder::SampleSource {
 public:
  explicit Ticks(std::uint64_t count) : count_(count) {}
  [[nodiscard]] const recorder::Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& /*out*/) override { return tick < count_; }

 private:
  std::uint64_t count_;
  recorder::Provenance provenance_;
};

TEST(MotionClock, KnowsTheLatestSteps) {
  MotionClock clock;
  EXPECT_FALSE(clock.of(0));
  const MotionClock::Time start{};
  for (std::uint64_t step = 0; step < 1000; ++step) clock.asked(step, start + milliseconds(10 * step));
  EXPECT_EQ(clock.of(999), start + milliseconds(9990));
  EXPECT_EQ(clock.of(800), start + milliseconds(8000));
  EXPECT_FALSE(clock.of(1000));
  EXPECT_FALSE(clock.of(700)) << "long ago";
}

TEST(MotionClock, AStepIsKnownFromItsLastTickOn) {
  Ticks ticks(25);
  MotionClock clock;
  ClockedSource source(ticks, clock, 40, 10);  // a branch, from step 40 on
  TickSamples out;
  for (std::uint64_t tick = 0; tick < 9; ++tick) ASSERT_TRUE(source.next(tick, out));
  EXPECT_FALSE(clock.of(40));
  const MotionClock::Time before = MotionClock::Time::clock::now();
  for (std::uint64_t tick = 9; tick < 25; ++tick) ASSERT_TRUE(source.next(tick, out));
  ASSERT_TRUE(clock.of(40));
  EXPECT_GE(*clock.of(40), before);
  ASSERT_TRUE(clock.of(41));
  EXPECT_FALSE(clock.of(42)) << "half of its ticks";
  EXPECT_FALSE(source.next(25, out));
  EXPECT_FALSE(clock.of(42));
}

}  // namespace
}  // namespace calot::gui
