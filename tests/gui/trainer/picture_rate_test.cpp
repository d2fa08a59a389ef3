// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/attempt_monitor.h"

#include <gtest/gtest.h>

namespace calot::gui {
namespace {

using std::chrono::milliseconds;

TEST(PictureRate, CountsWhileTheOperationRuns) {
  PictureRate rate;
  PictureRate::Time now{};
  rate.shown(now);
  EXPECT_EQ(rate.pictures(), 0U) << "nothing moves yet";
  EXPECT_EQ(rate.mean(), 0.0);
  rate.setRunning(true);
  for (const int wait : {1000, 40, 40, 120}) rate.shown(now += milliseconds(wait));
  EXPECT_EQ(rate.pictures(), 3U);
  EXPECT_NEAR(rate.seconds(), 0.2, 1e-9);
  EXPECT_NEAR(rate.longest(), 0.12, 1e-9);
  EXPECT_NEAR(rate.mean(), 15.0, 1e-9);
}

TEST(PictureRate, APauseDoesNotCount) {
  PictureRate rate;
  PictureRate::Time now{};
  rate.setRunning(true);
  rate.shown(now);
  rate.shown(now += milliseconds(50));
  rate.setRunning(false);
  rate.shown(now += milliseconds(50));  // drawn again, because the window got another size
  rate.setRunning(true);
  rate.shown(now += milliseconds(60'000));
  rate.shown(now += milliseconds(50));
  EXPECT_EQ(rate.pictures(), 2U);
  EXPECT_NEAR(rate.mean(), 20.0, 1e-9);
  EXPECT_NEAR(rate.longest(), 0.05, 1e-9);
}

TEST(PictureRate, SaysHowLargeAndHowLate) {
  PictureRate rate;
  PictureRate::Time now{};
  rate.setRunning(true);
  EXPECT_EQ(rate.side(), 1.0);
  EXPECT_FALSE(rate.delay(0.5));
  rate.shown(now, 0.5, 9.0);  // none before it: not counted
  for (int i = 1; i <= 20; ++i) rate.shown(now += milliseconds(33), i <= 10 ? 1.0 : 0.75, 0.001 * i);
  rate.shown(now += milliseconds(33), 0.875);
  EXPECT_NEAR(rate.side(), 0.875, 1e-12);
  EXPECT_NEAR(*rate.delay(0.5), 0.010, 1e-6);
  EXPECT_NEAR(*rate.delay(0.95), 0.019, 1e-6);
  EXPECT_NEAR(*rate.delay(1.0), 0.020, 1e-6);
}

}  // namespace
}  // namespace calot::gui
