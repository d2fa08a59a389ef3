// SPDX-License-Identifier: GPL-3.0-or-later
// A hook's electrode and a probe pressed into a pad of fat, through the whole step: the force is that of the converged
// solution whatever the cubes, and wherever the fat's surface cuts them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/accuracy/support/instrument_press.h"

namespace calot {
namespace {

constexpr std::array<double, 4> fatDepths{0.0005, 0.001, 0.002, 0.003};

/// Forces on a rigid instrument that is pressed into a pad of 36 x 36 x 12 mm as deep (N): linear elasticity, no
/// friction (tests/accuracy/support/press_on_block.py). Hook: cells of 0.3 mm; those of 0.4 mm give -2 to +5 %. Probe:
/// cells of 0.4 mm.
constexpr std::array<double, 4> ofHook{0.00203, 0.00473, 0.01049, 0.01645};
constexpr std::array<double, 4> ofProbe{0.00147, 0.00428, 0.01223, 0.02196};

/// A pad of fat that hangs, as good as fixed, on a hard block. @param raised height of its top above 12 mm (m)
class FatPress : public test::InstrumentPress {
 public:
  FatPress(InstrumentKind instrument, std::uint32_t cells, double x, double y, double raised)
      : InstrumentPress(scene(cells, 0.012 + raised), instrument, x, y, 0.012 + raised) {}

 private:
  static SceneDescription scene(std::uint32_t cells, double top) {
    SceneDescription scene = test::blockScene(150, 6);
    OrganDescription& base = scene.organs[0];
    base.surface = test::boxSurface(Vec3(-0.025, -0.025, -0.01), Vec3(0.025, 0.025, 0.0), {6, 6, 2});
    base.anchors = {{Vec3(0.0, 0.0, -100.0 - 0.003), 100.0, "", 0.0}};
    base.material.youngModulus = 1e7;
    FatDescription pad;
    pad.name = "pad";
    pad.appearance = "fat";
    pad.surface = test::boxSurface(Vec3(-0.018, -0.018, 1e-6), Vec3(0.018, 0.018, top), {6, 6, 3});
    pad.cellSize = 0.00075;
    pad.cellsPerCube = cells;
    pad.material = {1600.0, 0.4, 920.0, 2.0, 0.01};
    pad.friction = 0.0;
    pad.attachments = {{"block", 1.5 * pad.cellSize, 1e11, 1e8}};
    scene.fat = {pad};
    scene.gravity.setZero();
    return scene;
  }
};

/// Largest deviation over depths, places in the cubes and heights of the surface in them. @param all of these, or some
double worstOnFat(InstrumentKind instrument, const std::array<double, 4>& reference, std::uint32_t cells, bool all) {
  const std::vector<double> heights = all ? std::vector{0.0003, 0.001, 0.0017, 0.0024} : std::vector{0.0003, 0.0017};
  std::vector<std::array<double, 2>> places{{0.0014, 0.0016}};
  if (all) places.push_back({0.0003, 0.0002});
  double worst = 0.0;
  for (const double raised : heights) {
    for (const auto& [x, y] : places) {
      FatPress press(instrument, cells, x, y, raised);
      std::printf("%4.2f mm cubes, %4.1f mm high, at (%3.1f, %3.1f) mm:", 0.75 * cells, 12.0 + 1e3 * raised, 1e3 * x,
                  1e3 * y);
      for (std::size_t k = 0; k < fatDepths.size(); ++k) {
        press.settle(fatDepths[k], 2e-5);
        const double off = press.force / reference[k] - 1.0;
        std::printf("  %.5f N %+5.1f %%", press.force, 100.0 * off);
        worst = std::max(worst, std::abs(off));
      }
      std::printf("\n");
    }
  }
  return worst;
}

/// Some of the places; all where CALOT_HEAVY is set.
TEST(FatUnderTips, GivesTheConvergedForce) {
  const bool all = std::getenv("CALOT_HEAVY") != nullptr;
  EXPECT_LT(worstOnFat(InstrumentKind::probe, ofProbe, 4, all), 0.15);
  EXPECT_LT(worstOnFat(InstrumentKind::probe, ofProbe, 2, all), 0.18);
  EXPECT_LT(worstOnFat(InstrumentKind::hook, ofHook, 4, all), 0.40);
  EXPECT_LT(worstOnFat(InstrumentKind::hook, ofHook, 2, all), 0.27);
}

}  // namespace
}  // namespace calot
