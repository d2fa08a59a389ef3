// SPDX-License-Identifier: GPL-3.0-or-later
// A probe with a round end of 2.5 mm pressed into a block, through the whole step: the force depends neither on the
// mesh nor on the place in it nor on the step, and is that of the converged solution.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/accuracy/support/instrument_press.h"

namespace calot {
namespace {

/// Force on a rigid sphere of 2.5 mm that is pressed into the middle of the block (N), by depth in mm: linear
/// elasticity, no friction, the sphere's profile over the reference configuration; trilinear hexahedra of 0.25 mm under
/// the sphere, whose dilatation is averaged (tests/accuracy/support/press_on_block.py). Cells twice as large give 1 to
/// 5 % less.
constexpr std::array<double, 7> reference{0.0, 0.01339, 0.03710, 0.06590, 0.09764, 0.13023, 0.16310};

/// Between the depths: depth^1.3 times what changes slowly. @param depth from 1 to 6 mm (m)
double referenceAt(double depth) {
  const double mm = 1e3 * depth;
  const auto at = static_cast<std::size_t>(std::clamp(std::floor(mm), 1.0, 5.0));
  const double low = static_cast<double>(at);
  const double a = reference[at] / std::pow(low, 1.3);
  const double b = reference[at + 1] / std::pow(low + 1.0, 1.3);
  return std::pow(mm, 1.3) * (a + (b - a) * (mm - low));
}

/// A block under a probe that stands upright above a place of its top.
class Press : public test::InstrumentPress {
 public:
  Press(std::uint32_t tetrahedra, double x, double y, std::uint32_t ticks = 10)
      : InstrumentPress(scene(tetrahedra, ticks), InstrumentKind::probe, x, y, test::blockTop) {}

  /// @return force over that of the reference, less one
  double settle(double depth) {
    InstrumentPress::settle(depth, 5e-6);
    return force / referenceAt(tip) - 1.0;
  }

 private:
  static SceneDescription scene(std::uint32_t tetrahedra, std::uint32_t ticks) {
    SceneDescription scene = test::blockScene(tetrahedra, 16);
    scene.ticksPerStep = ticks;
    scene.organs[0].friction = 0.0;
    return scene;
  }
};

/// Middle of a face of the skin, beside one of its vertices (and of the mesh's), on an edge, in general position.
constexpr std::array<std::array<double, 2>, 4> places{
    {{0.0003, 0.0002}, {0.0019, 0.0017}, {0.0041, 0.0002}, {-0.0071, 0.0049}}};

/// Largest deviation over depths from 1 to 6 mm and all places.
double worstOf(std::uint32_t tetrahedra) {
  double worst = 0.0;
  for (const auto& [x, y] : places) {
    Press press(tetrahedra, x, y);
    std::printf("%5u tetrahedra at (%4.1f, %4.1f) mm:", tetrahedra, 1e3 * x, 1e3 * y);
    for (int mm = 1; mm <= 6; ++mm) {
      const double off = press.settle(1e-3 * mm);
      std::printf("  %.4f N %+5.1f %%", press.force, 100.0 * off);
      worst = std::max(worst, std::abs(off));
    }
    std::printf("  (%d misses)\n", press.misses);
  }
  return worst;
}

TEST(SpherePress, ForceIsThatOfTheConvergedSolution) {
  for (const std::uint32_t tetrahedra : {300U, 1200U, 4800U, 20000U}) {
    EXPECT_LT(worstOf(tetrahedra), 0.10) << tetrahedra;
  }
}

/// F = 4/3 E* sqrt(R) d^(3/2) (Johnson 1985, 4.22); the block's bottom adds 3 % at 0.5 mm.
TEST(SpherePress, ShallowForceIsThatOfHertz) {
  const double modulus = 5000.0 / (1.0 - 0.45 * 0.45);
  for (const std::uint32_t tetrahedra : {300U, 1200U, 4800U, 20000U}) {
    for (const auto& [x, y] : places) {
      Press press(tetrahedra, x, y);
      double ratio[2] = {};
      for (const int k : {0, 1}) {
        press.settle(k == 0 ? 0.00025 : 0.0005);
        ratio[k] = press.force / (4.0 / 3.0 * modulus * std::sqrt(0.0025) * press.tip * std::sqrt(press.tip));
      }
      std::printf("%5u tetrahedra at (%4.1f, %4.1f) mm: %.3f of Hertz at 0.25 mm, %.3f at 0.5 mm\n", tetrahedra,
                  1e3 * x, 1e3 * y, ratio[0], ratio[1]);
      EXPECT_NEAR(ratio[0], 1.0, 0.10);
      EXPECT_NEAR(ratio[1], 1.0, 0.10);
    }
  }
}

TEST(SpherePress, ForceDoesNotDependOnTheStep) {
  double still = 0.0;
  double moving = 0.0;
  for (const std::uint32_t ticks : {1U, 2U, 5U, 10U, 20U}) {
    Press slow(1200, 0.0019, 0.0017, ticks);
    slow.settle(0.003);
    // While it goes down at 50 mm/s, at 3 mm: after 100 ms, a whole number of steps.
    Press fast(1200, 0.0019, 0.0017, ticks);
    double force = 0.0;
    for (std::uint32_t ms = ticks; ms <= 100; ms += ticks) {
      force = fast.step(-0.002 + 0.05e-3 * ms).hand[0].contactForce[2];
    }
    std::printf("step of %2u ms: %.4f N at rest, %.4f N at 50 mm/s\n", ticks, slow.force, force);
    if (ticks == 1) {
      still = slow.force;
      moving = force;
    }
    EXPECT_NEAR(slow.force, still, 0.02 * still);
    EXPECT_NEAR(force, moving, 0.10 * moving);
  }
}

/// Down and up again: the force rises and falls with the depth, and the tissue gives back less than it took.
TEST(SpherePress, PressingIsMonotoneAndTakesWork) {
  for (const double speed : {0.005, 0.02, 0.1}) {
    Press press(1200, 0.0041, 0.0002);
    double work = 0.0;
    double exchanged = 0.0;
    double before = 0.0;
    double tip = 0.002;
    const double deepest = 0.004;
    for (double way = -0.002; way < 2.0 * deepest + 0.002; way += speed * press.seconds()) {
      const StepResult& result = press.step(way < deepest ? way : 2.0 * deepest - way);
      const double force = result.hand[0].contactForce[2];
      if (way < deepest) {
        EXPECT_GE(force, before - 1e-6) << way;
      } else if (way > deepest + speed * press.seconds()) {
        EXPECT_LE(force, before + 1e-6) << way;
      }
      const double moved = result.hand[0].tipSimulated[2] - tip;
      tip = result.hand[0].tipSimulated[2];
      if (way > -0.0015) {
        work += force * moved;
        exchanged += std::abs(force * moved);
      }
      before = force;
    }
    std::printf("at %.0f mm/s: work on the operator %.4f mJ of %.4f mJ\n", 1e3 * speed, 1e3 * work, 1e3 * exchanged);
    EXPECT_LT(work, 0.0);
    EXPECT_GT(exchanged, 1e-5);
  }
}

}  // namespace
}  // namespace calot
