// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include "sim/scene/step_result.h"

namespace calot::recorder::test {

/// What two results tell of vessels, fat and procedure must be the same.
inline void expectSameStructures(const StepResult& made, const StepResult& read) {
  ASSERT_EQ(made.vessel.size(), read.vessel.size());
  for (std::size_t v = 0; v < made.vessel.size(); ++v) {
    const VesselResult &a = made.vessel[v], &b = read.vessel[v];
    EXPECT_EQ(a.largestStrain, b.largestStrain);
    EXPECT_EQ(a.largestTension, b.largestTension);
    EXPECT_EQ(a.largestDisplacement, b.largestDisplacement);
    EXPECT_EQ(a.clips, b.clips);
    EXPECT_EQ(a.partings, b.partings);
    EXPECT_EQ(a.charred, b.charred);
    EXPECT_EQ(a.asleep, b.asleep);
  }
  ASSERT_EQ(made.fat.size(), read.fat.size());
  for (std::size_t f = 0; f < made.fat.size(); ++f) {
    const FatResult &a = made.fat[f], &b = read.fat[f];
    EXPECT_EQ(a.volume, b.volume);
    EXPECT_EQ(a.toClear, b.toClear);
    EXPECT_EQ(a.carved, b.carved);
    EXPECT_EQ(a.islands, b.islands);
    EXPECT_EQ(a.largestDisplacement, b.largestDisplacement);
    EXPECT_EQ(a.largestSpeed, b.largestSpeed);
    EXPECT_EQ(a.residual, b.residual);
    EXPECT_EQ(a.iterations, b.iterations);
    EXPECT_EQ(a.asleep, b.asleep);
  }
  const ProcedureResult &a = made.procedure, &b = read.procedure;
  EXPECT_EQ(a.phase, b.phase);
  EXPECT_EQ(a.triangleCleared, b.triangleCleared);
  EXPECT_EQ(a.lowerThirdFreed, b.lowerThirdFreed);
  EXPECT_EQ(a.twoStructures, b.twoStructures);
  EXPECT_EQ(a.criticalViewFrozen, b.criticalViewFrozen);
  EXPECT_EQ(a.lowerThirdAttached, b.lowerThirdAttached);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_EQ(a.criticalErrors, b.criticalErrors);
}

}  // namespace calot::recorder::test
