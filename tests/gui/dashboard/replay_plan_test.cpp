// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay_player.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <vector>

namespace calot::gui {
namespace {

const std::vector<std::uint64_t> keyframes{99, 199, 299, 399};

ReplayReach standing(std::optional<std::uint64_t> step, std::uint64_t budget) { return {step, keyframes, budget}; }

TEST(ReplayPlan, TheWayToAStepIsTheShorterOfGoingOnAndTheNearestKeyframe) {
  EXPECT_EQ(stepsTo(standing(110, 1), 150), 40U) << "from here";
  EXPECT_EQ(stepsTo(standing(110, 1), 205), 6U) << "from the keyframe after step 199";
  EXPECT_EQ(stepsTo(standing(150, 1), 110), 11U) << "backwards: the keyframe before";
  EXPECT_EQ(stepsTo(standing(150, 1), 150), 0U);
  EXPECT_EQ(stepsTo(standing(150, 1), 199), 0U) << "a keyframe itself";
  EXPECT_EQ(stepsTo(standing(150, 1), 20), 21U) << "before any keyframe: from the attempt's start";
  EXPECT_EQ(stepsTo(standing(std::nullopt, 1), 0), 1U);
}

TEST(ReplayPlan, PlayingShowsWhatIsDueWhereTheBudgetLeadsThere) {
  const ReplayMove move = playTowards(standing(110, 10), 115);
  EXPECT_EQ(move.step, 115U);
  EXPECT_FALSE(move.hops);
}

TEST(ReplayPlan, PlayingFallsBehindWhereThereIsNoKeyframeBetween) {
  const ReplayMove move = playTowards(standing(110, 10), 190);
  EXPECT_EQ(move.step, 120U);
  EXPECT_FALSE(move.hops);
}

TEST(ReplayPlan, PlayingHopsToTheLastKeyframeBeforeWhatIsDue) {
  const ReplayMove move = playTowards(standing(110, 10), 380);
  EXPECT_EQ(move.step, 299U);
  EXPECT_TRUE(move.hops);
}

TEST(ReplayPlan, PlayingFastFromKeyframeToKeyframeSaysSo) {
  // 16 times as fast as real time, pictures 0.1 s apart: due 160 steps later each time.
  std::uint64_t step = 0;
  for (const std::uint64_t due : {160U, 320U}) {
    const ReplayMove move = playTowards(standing(step, 5), due);
    EXPECT_TRUE(move.hops);
    EXPECT_GT(move.step, step);
    EXPECT_LE(move.step, due);
    step = move.step;
  }
  EXPECT_EQ(step, 299U);
}

// Whatever the budget: playing never runs ahead of the clock nor backwards, and always gets on; seeking arrives, and no
// part of the way is longer than the budget.
TEST(ReplayPlan, AlwaysGetsOn) {
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint64_t n) { return std::uniform_int_distribution<std::uint64_t>(0, n - 1)(random); };
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint64_t> frames;
    for (std::uint64_t n = below(5); n > 0; --n) frames.push_back(below(500));
    std::sort(frames.begin(), frames.end());
    const std::uint64_t at = below(500), due = below(500), budget = 1 + below(60);
    if (due > at) {
      const ReplayMove move = playTowards({at, frames, budget}, due);
      EXPECT_GT(move.step, at);
      EXPECT_LE(move.step, due);
      EXPECT_LE(stepsTo({at, frames, budget}, move.step), budget);
    }
    std::optional<std::uint64_t> here;
    if (below(4) > 0) here = at;
    for (int moves = 0; here != due; ++moves) {
      ASSERT_LT(moves, 600) << "does not arrive";
      const std::uint64_t next = seekTowards({here, frames, budget}, due);
      EXPECT_LE(stepsTo({here, frames, budget}, next), budget);
      here = next;
    }
  }
}

}  // namespace
}  // namespace calot::gui
