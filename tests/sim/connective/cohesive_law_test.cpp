// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/connective/connective_tissue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

namespace calot {
namespace {

constexpr int pieces = 20000;  // of an opening

/// Opens from 0 to beyond the final separation.
struct Opening {
  double work = 0.0;  ///< J/m^2, by the trapezoidal rule
  double peak = 0.0;  ///< Pa
  double peakAt = 0.0;
};

Opening open(const CohesiveLaw& law) {
  Opening out;
  double before = 0.0;
  double damage = 0.0;
  const double step = 1.1 * law.finalSeparation() / pieces;
  for (int i = 1; i <= pieces; ++i) {
    const double w = i * step;
    const double next = law.damageAt(w);
    EXPECT_GE(next, damage) << w;
    EXPECT_LE(next, 1.0) << w;
    damage = next;
    const double traction = law.secant(w, damage) * w;
    out.work += 0.5 * (before + traction) * step;
    before = traction;
    // What the work has not stored, it has dissipated.
    EXPECT_NEAR(law.dissipated(damage), out.work - 0.5 * traction * w, 1e-3 * law.fractureEnergy) << w;
    EXPECT_GE(law.dissipated(damage), 0.0);
    EXPECT_LE(law.dissipated(damage), law.fractureEnergy * (1.0 + 1e-12));
    if (traction > out.peak) {
      out.peak = traction;
      out.peakAt = w;
    }
  }
  EXPECT_EQ(damage, 1.0);
  return out;
}

TEST(CohesiveLaw, OpeningTakesTheFractureEnergyAndNoMoreThanTheStrength) {
  for (const CohesiveLaw& law :
       {CohesiveLaw{2e5, 4e3, 60.0}, CohesiveLaw{2e5, 4e3, 41.0}, CohesiveLaw{1e8, 4e3, 60.0}}) {
    const Opening opening = open(law);
    EXPECT_NEAR(opening.work, law.fractureEnergy, 1e-3 * law.fractureEnergy);
    EXPECT_NEAR(opening.peak, law.strength, 1e-3 * law.strength);
    EXPECT_NEAR(opening.peakAt, law.peakSeparation(), 2.2 * law.finalSeparation() / pieces);
    EXPECT_NEAR(law.dissipated(1.0), law.fractureEnergy, 1e-12 * law.fractureEnergy);
    EXPECT_EQ(law.dissipated(0.0), 0.0);
  }
}

/// With the least fracture energy it is brittle: intact up to the strength, then gone.
TEST(CohesiveLaw, TheLeastFractureEnergyIsBrittle) {
  CohesiveLaw law{2e5, 4e3, 0.0};
  law.fractureEnergy = law.minFractureEnergy();
  EXPECT_DOUBLE_EQ(law.fractureEnergy, 40.0);
  EXPECT_DOUBLE_EQ(law.finalSeparation(), law.peakSeparation());
  EXPECT_EQ(law.damageAt(0.999 * law.peakSeparation()), 0.0);
  EXPECT_EQ(law.damageAt(1.001 * law.peakSeparation()), 1.0);
}

TEST(CohesiveLaw, CompressionIsThatOfIntactTissue) {
  const CohesiveLaw law{2e5, 4e3, 60.0};
  for (const double damage : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(law.secant(-1e-3, damage), law.stiffness);
    EXPECT_EQ(law.secant(1e-3, damage), (1.0 - damage) * law.stiffness);
  }
}

}  // namespace
}  // namespace calot
