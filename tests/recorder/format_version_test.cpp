// SPDX-License-Identifier: GPL-3.0-or-later
// Format version 1 is read for ever: a recording of 2.6 s that was written when it was the newest (touch-liver with 300
// tetrahedra, skilled performer, seed 1), with contact, observables and keyframes. What it replays to, its kept engine
// decides: tests/command_line/engine_test.py.
#include <gtest/gtest.h>

#include <filesystem>

#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recover.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::recorder {
namespace {

const std::filesystem::path old = std::filesystem::path(CALOT_SOURCE_DIR) / "tests/recorder/recording/data/format-1.h5";

TEST(FormatVersion1, IsRead) {
  Recording r(old);
  EXPECT_EQ(r.header().formatVersion, 1U);
  ASSERT_EQ(r.stepCount(), 260U);
  EXPECT_EQ(r.outcome(), Outcome::stopped);
  EXPECT_TRUE(r.verifyChain().intact());
  EXPECT_TRUE(probe(old).intact());
  const RecordedStep& step = r.step(255);
  EXPECT_EQ(step.digest.component.size(), r.header().layout.components.size());
  EXPECT_EQ(step.digest.field.size(), r.header().layout.fields.size());
  EXPECT_TRUE(step.brief.field.empty());
  // Forces to the last bit, not on the grid of later versions.
  const TickOutcome& tick = step.ticks.back();
  EXPECT_GT(tick.hand[0].force.norm(), 0.0);
  EXPECT_NE(tick.hand[0].force, asStored(tick).hand[0].force);
  ASSERT_EQ(r.keyframeSteps(), (std::vector<std::uint64_t>{99, 199}));
  EXPECT_EQ(r.keyframe(1).state.size(), 21551U);
  EXPECT_EQ(r.keyframe(1).haptics.size(), 784U);
}

/// Saved, it stays what it is: the same version, the same chain.
TEST(FormatVersion1, IsRecoveredAsItIs) {
  const test::Folder folder;
  const Recovered saved = recover(old, folder / "o.h5", false);
  EXPECT_TRUE(saved.complete);
  Recording a(old);
  Recording b(folder / "o.h5");
  EXPECT_EQ(b.header().formatVersion, 1U);
  ASSERT_EQ(a.status().size(), b.status().size());
  EXPECT_EQ(a.status().back().chain, b.status().back().chain);
  EXPECT_TRUE(b.verifyChain().intact());
  EXPECT_EQ(a.keyframe(1).state, b.keyframe(1).state);
}

}  // namespace
}  // namespace calot::recorder
