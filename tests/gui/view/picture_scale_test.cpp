// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/scene_picture_widget.h"

#include <gtest/gtest.h>

#include <vector>

namespace calot::gui {
namespace {

/// Draws so many pictures of a cost of `fixed` + `area` times the share of the pixels (s).
std::vector<double> drawn(PictureScale& scale, int pictures, double fixed, double area) {
  std::vector<double> sides;
  for (int i = 0; i < pictures; ++i) {
    const double side = scale.side();
    sides.push_back(side);
    scale.drew(side, fixed + area * side * side);
  }
  return sides;
}

TEST(PictureScale, WithoutARateAllIsDrawnWhole) {
  PictureScale scale(0.0, 2);
  EXPECT_EQ(drawn(scale, 100, 1.0, 1.0).back(), 1.0);
}

TEST(PictureScale, WhatIsFastEnoughStaysWhole) {
  PictureScale scale(30.0, 2);
  for (const double side : drawn(scale, 200, 0.02, 0.04)) ASSERT_EQ(side, 1.0);
}

TEST(PictureScale, WhatIsTooSlowShrinksUntilItKeepsTheRate) {
  PictureScale scale(30.0, 2);  // 67 ms a picture
  EXPECT_EQ(drawn(scale, 200, 0.03, 0.05).back(), 0.75) << "0.875 takes 68 ms, 0.75 takes 58";
}

TEST(PictureScale, WhatIsFarTooSlowShrinksAtOnce) {
  PictureScale scale(30.0, 2);
  EXPECT_EQ(drawn(scale, 13, 0.02, 0.12).back(), 0.625) << "14 a second: by 0.68";
}

TEST(PictureScale, NeverBelowHalf) {
  PictureScale scale(30.0, 1);
  EXPECT_EQ(drawn(scale, 500, 0.5, 0.5).back(), 0.5);
}

TEST(PictureScale, DoesNotSwing) {
  for (double area = 0.02; area < 0.2; area += 0.003) {
    PictureScale scale(30.0, 2);
    drawn(scale, 200, 0.025, area);
    const double settled = scale.side();
    for (const double side : drawn(scale, 500, 0.025, area)) ASSERT_EQ(side, settled) << area;
  }
}

TEST(PictureScale, GrowsAgainWhereThereIsRoom) {
  PictureScale scale(30.0, 2);
  drawn(scale, 200, 0.05, 0.2);
  EXPECT_EQ(scale.side(), 0.5);
  drawn(scale, 200, 0.005, 0.02);
  EXPECT_EQ(scale.side(), 1.0);
}

TEST(PictureScale, APictureOfTheSizeBeforeCountsForNothing) {
  PictureScale scale(30.0, 2);
  drawn(scale, 12, 0.03, 0.05);
  ASSERT_EQ(scale.side(), 0.875);
  for (int i = 0; i < 100; ++i) scale.drew(1.0, 0.2);
  EXPECT_EQ(scale.side(), 0.875);
}

}  // namespace
}  // namespace calot::gui
