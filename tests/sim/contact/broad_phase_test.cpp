// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/broad_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "tests/sim/contact/support/broad_phase_checks.h"

namespace calot {
namespace {

/// With cells, and without.
constexpr std::size_t maxSwept[] = {0, 2048};

TEST(SortedGrid, FindsEveryOverlapSortedAndOnce) {
  SCOPED_TRACE("seed 51");
  for (const std::size_t swept : maxSwept) {
    SortedGrid grid(0.02, swept);
    test::checkUpdates(grid, 51);
  }
}

TEST(SortedGrid, RefitsWhatMoved) {
  SCOPED_TRACE("seed 52");
  for (const std::size_t swept : maxSwept) {
    SortedGrid grid(0.02, swept);
    test::checkRefits(grid, 52);
  }
}

TEST(SortedGrid, BoxesThatOnlyTouchOverlap) {
  SCOPED_TRACE("seed 53");
  for (const std::size_t swept : maxSwept) {
    SortedGrid grid(0.02, swept);
    test::checkTightBoxes(grid, 53);
  }
}

TEST(SortedGrid, ARefitGivesWhatAnUpdateGives) {
  SCOPED_TRACE("seed 54");
  Random random(54);
  SortedGrid refitted(0.02, 0);
  SortedGrid swept(0.02);
  std::vector<Box> leaves(150);
  for (Box& box : leaves) box = test::randomBox(random);
  refitted.update(leaves);
  swept.update(leaves);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Box> before = leaves;
    for (int k = 0; k < 20; ++k) leaves[random.next() % leaves.size()] = test::randomBox(random);
    std::vector<std::uint32_t> changed;
    changedBounds(before, leaves, changed);
    EXPECT_LE(changed.size(), 20U);
    EXPECT_GE(changed.size(), 10U);
    refitted.refit(leaves, changed);
    swept.refit(leaves, changed);
    SortedGrid fresh(0.02, 0);
    fresh.update(leaves);
    std::vector<Box> queries(30);
    for (Box& box : queries) box = test::randomBox(random);
    std::vector<BroadPhase::Pair> a;
    std::vector<BroadPhase::Pair> b;
    refitted.pairs(queries, a);
    fresh.pairs(queries, b);
    ASSERT_EQ(a, b) << trial;
    swept.pairs(queries, a);
    ASSERT_EQ(a, b) << trial;
  }
}

TEST(FloatBounds, RoundOutwardAndNoFurther) {
  SCOPED_TRACE("seed 55");
  Random random(55);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (int trial = 0; trial < 20000; ++trial) {
    const double scales[] = {1.0, 1e-3, 1e-40, 1e-46, 1e30, 1e38, 1e39, 1e300};
    double x = scales[random.next() % 8] * random.normal();
    if (trial % 10 == 0) x = static_cast<double>(static_cast<float>(random.normal()));
    if (trial == 1) x = 0.0;
    const float below = floatBelow(x);
    const float above = floatAbove(x);
    ASSERT_LE(static_cast<double>(below), x);
    ASSERT_GE(static_cast<double>(above), x);
    const auto exact = static_cast<float>(x);
    if (static_cast<double>(exact) == x) {
      ASSERT_EQ(below, exact);
      ASSERT_EQ(above, exact);
    } else if (below > -infinity) {
      ASSERT_EQ(std::nextafter(below, infinity), above) << "neighbours";
    }
  }
}

}  // namespace
}  // namespace calot
