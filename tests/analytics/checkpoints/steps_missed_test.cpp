// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that missed a tolerance reach the report.
#include <gtest/gtest.h>

#include "recorder/replay.h"
#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using namespace support;

TEST(StepsMissed, isTheShareOfSteps) {
  Operation o;
  for (const std::uint32_t misses : {0U, miss::solver, miss::solver | miss::contact, 0U, miss::speed}) {
    o.now.misses = misses;
    o.step();
  }
  o.now.misses = 0;
  for (int i = 0; i < 3; ++i) o.step();
  o.end();
  const CheckpointValue value = o.value("steps-missed");
  EXPECT_DOUBLE_EQ(*value.value, 3.0 / 8.0) << "a step counts once, whatever it missed";
  expectNames(value.note, {"3", "8", "solver 2", "contact 1", "back 1"});
}

TEST(StepsMissed, saysNothingWhereNothingMissed) {
  Operation o;
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("steps-missed").value, 0.0);
  EXPECT_EQ(o.value("steps-missed").note, "");
}

TEST(StepsMissed, runawayIsAMiss) {
  recorder::StepMisses misses;
  misses.add(miss::runaway);
  EXPECT_EQ(misses.any, 1U);
  EXPECT_EQ(misses.solver + misses.contact + misses.heldBack, 0U);
}

}  // namespace
}  // namespace calot::analytics
