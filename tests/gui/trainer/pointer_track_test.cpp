// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/operation_view.h"

#include <gtest/gtest.h>

namespace calot::gui {
namespace {

TEST(PointerTrack, TheFirstPositionIsNoMotion) {
  PointerTrack track;
  EXPECT_EQ(track.moved({100, 50}), QPointF(0, 0));
  EXPECT_EQ(track.moved({103, 46}), QPointF(3, -4));
  track.begin();
  EXPECT_EQ(track.moved({700, 500}), QPointF(0, 0));
}

// 300 pixels to the right in steps of 30; the pointer is put back at 250, and two positions of before are under way.
TEST(PointerTrack, PuttingThePointerBackMovesNothing) {
  PointerTrack track;
  track.begin();
  QPointF sum;
  for (const double x : {100.0, 130.0, 160.0, 190.0, 220.0, 250.0}) sum += track.moved({x, 80.0});
  track.put({100.0, 80.0});
  for (const double x : {280.0, 310.0}) sum += track.moved({x, 80.0});
  EXPECT_TRUE(track.isPutBack());
  for (const double x : {100.0, 130.0, 160.0, 190.0}) sum += track.moved({x, 80.0});
  EXPECT_FALSE(track.isPutBack());
  EXPECT_EQ(sum, QPointF(300, 0));
}

// Window systems join positions: that of the middle itself may never come.
TEST(PointerTrack, WhatCameAfterIsCountedFromTheMiddle) {
  PointerTrack track;
  track.begin();
  track.moved({10, 300});
  track.put({400, 300});
  EXPECT_EQ(track.moved({390, 310}), QPointF(-10, 10));
}

}  // namespace
}  // namespace calot::gui
