// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/picture_rate.h"

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

}  // namespace
}  // namespace calot::gui
