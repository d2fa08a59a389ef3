// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/picture_overlay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gui/render/draw_list.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

constexpr double view = 1.0;  // rad
const QSizeF wide(1366.0, 768.0);

TEST(DirectionOutside, IsNoneForWhatIsSeen) {
  EXPECT_FALSE(directionOutside(Vec3(0.0, 0.0, 0.1), wide, view));
  EXPECT_FALSE(directionOutside(Vec3(0.04, -0.03, 0.1), wide, view));
}

TEST(DirectionOutside, PointsToTheSideOnWhichTheTipIs) {
  const auto right = directionOutside(Vec3(0.3, 0.0, 0.1), wide, view);
  ASSERT_TRUE(right);
  EXPECT_NEAR(right->x(), 1.0, 1e-12);
  const auto above = directionOutside(Vec3(0.0, -0.2, 0.1), wide, view);
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->y(), -1.0, 1e-12);
  const auto behind = directionOutside(Vec3(-0.05, 0.0, -0.02), wide, view);
  ASSERT_TRUE(behind) << "behind the endoscope";
  EXPECT_NEAR(behind->x(), -1.0, 1e-12);
  EXPECT_TRUE(directionOutside(Vec3(0.0, 0.0, -0.02), wide, view)) << "right behind it";
}

/// What falls on a pixel within the round field of the picture (Renderer's camera) has no arrow, and all else has one.
TEST(DirectionOutside, AgreesWithTheRenderersField) {
  constexpr unsigned seed = 20261201;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> across(-0.15, 0.15), away(0.02, 0.3);
  const double f = 0.5 * wide.height() / std::tan(0.5 * view);
  const double rim = static_cast<double>(sightOf(1366, 768, view, true).rim);
  int seen = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 tip(across(random), across(random), away(random));
    const double x = f * tip.x() / tip.z(), y = f * tip.y() / tip.z();
    const bool within = std::hypot(x, y) < rim && std::abs(x) < 0.5 * wide.width() && std::abs(y) < 0.5 * wide.height();
    ASSERT_EQ(!directionOutside(tip, wide, view), within) << tip.transpose() << ", seed " << seed;
    seen += within;
  }
  EXPECT_GT(seen, 500);
  EXPECT_LT(seen, 4500);
}

}  // namespace
}  // namespace calot::gui
