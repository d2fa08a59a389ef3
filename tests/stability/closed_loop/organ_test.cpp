// SPDX-License-Identifier: GPL-3.0-or-later
// The haptic path over organs in the closed loop: every organ pressed, grasped, touched and left, and with a simulation
// that is late.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <deque>
#include <memory>
#include <string>

#include "recorder/formats/scene_file.h"
#include "sim/haptics/haptic_tick.h"
#include "tests/sim/scene/support/scenes.h"
#include "tests/stability/closed_loop/support/closed_loop.h"

namespace calot {
namespace {

using test::ClosedLoop;
using test::LoopSettings;

constexpr std::size_t hand = 1;

/// A scene whose right hand a force device moves: frame D is W, from where the hand is at home.
class Bench {
 public:
  Bench(const Model& model, const LoopSettings& settings) : loop(settings), model_(model), rig_(model) {
    haptic_ = {initialHaptics(rig_.state, 0), initialHaptics(rig_.state, 1)};
    home_ = model.scene().hands[hand].home;
    sets_.push_back(rig_.stepper.contactSet(hand));
  }

  /// The point of an organ's skin that is nearest to the home, from there.
  [[nodiscard]] Vec3 wayTo(std::size_t organ) const {
    std::vector<Vec3> skin;
    model_.organs()[organ].embedding.map(rig_.state.organ[organ].position, skin);
    Vec3 best = skin.front();
    for (const Vec3& p : skin) {
      if ((p - home_).norm() < (best - home_).norm()) best = p;
    }
    return best - home_;
  }

  /// @param late steps that a tick's contact set is behind the newest one
  void step(const Vec3& intended, double jaw, std::size_t late) {
    std::vector<TickSamples> ticks;
    while (sets_.size() > late + 1) sets_.pop_front();
    for (std::uint32_t k = 0; k < model_.scene().ticksPerStep; ++k) {
      TickSamples tick;
      for (std::size_t h = 0; h < handCount; ++h) {
        tick.hand[h].position = model_.scene().hands[h].home;
        tick.hand[h].instrument = InstrumentKind::grasper;
      }
      tick.camera = model_.scene().camera;
      tick.hand[hand].position = home_ + loop.position();
      tick.hand[hand].jaw = jaw;
      ticks.push_back(roundedToGrid(tick));
      takeSample(model_, hand, ticks.back().hand[hand], haptic_[hand]);
      const HapticForce force = hapticTick(hapticModel(model_, hand), haptic_[hand], sets_.front());
      maxRendered = std::max(maxRendered, force.force.norm());
      loop.tick(force.force, intended);
    }
    rig_.stepper.step(rig_.state, ticks);
    sets_.push_back(rig_.stepper.contactSet(hand));
  }

  [[nodiscard]] bool grasping() const { return rig_.state.hand[hand].grasp.structure < model_.organs().size(); }

  ClosedLoop loop;
  double maxRendered = 0.0;

 private:
  const Model& model_;
  test::Rig rig_;
  std::array<HapticState, handCount> haptic_;
  std::deque<ContactSet> sets_;
  Vec3 home_;
};

class Organs : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = recorder::loadScene(std::string(CALOT_SOURCE_DIR) + "/assets/scenes/touch-liver.json").description;
    Model::Built built = Model::build(scene_);
    model_ = std::move(built.model);
  }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }

  static void expectCalm(Bench& bench, const std::string& what) {
    std::printf(
        "%s: swing %.1f um, given %.3f mJ, rendered at most %.2f N, shown %.2f N, change %.3f N, softened %llu\n",
        what.c_str(), 1e6 * bench.loop.swing(), 1e3 * bench.loop.maxGiven, bench.maxRendered, bench.loop.maxShown,
        bench.loop.maxChange, static_cast<unsigned long long>(bench.loop.output().statistics().softened));
    EXPECT_LT(bench.loop.swing(), 0.0003) << what;
    EXPECT_LE(bench.loop.maxGiven, recorder::EnergyTank::initial) << what;
    EXPECT_LE(bench.loop.maxShown, LoopSettings{}.hand.maxForce) << what;
    EXPECT_LE(bench.loop.maxChange, 0.001 * recorder::ForceOutput::maxSlew + 1e-9) << what;
    EXPECT_GT(bench.loop.maxShown, 0.05) << what;
  }

  static inline SceneDescription scene_;
  static inline std::unique_ptr<const Model> model_;
};

TEST_F(Organs, PressedAndHeldAreStill) {
  for (std::size_t o = 0; o < model_->organs().size(); ++o) {
    for (const int delay : {0, 5}) {
      LoopSettings settings;
      settings.delay = delay;
      Bench bench(*model_, settings);
      const Vec3 way = bench.wayTo(o);
      const Vec3 end = way + 0.012 * way.normalized();
      for (int k = 0; k < 300; ++k) {
        if (k == 200) bench.loop.watch();
        bench.step(std::min(1.0, k / 80.0) * end, 0.0, 0);
      }
      expectCalm(bench, "organ " + std::to_string(o) + ", delay " + std::to_string(delay));
    }
  }
}

TEST_F(Organs, TouchedAndLeftAgainAndAgain) {
  LoopSettings settings;
  settings.delay = 3;
  Bench bench(*model_, settings);
  const Vec3 way = bench.wayTo(0);
  for (int k = 0; k < 400; ++k) {
    const double there = std::min(1.0, k / 80.0);
    const double swing = k < 300 ? 0.004 * std::sin(0.2 * k) : -0.02;
    if (k == 380) bench.loop.watch();
    bench.step(there * (way + swing * way.normalized()), 0.0, 0);
  }
  expectCalm(bench, "touched");
}

TEST_F(Organs, GraspedAndPulledIsStill) {
  for (const int delay : {0, 5}) {
    LoopSettings settings;
    settings.delay = delay;
    Bench bench(*model_, settings);
    const Vec3 way = bench.wayTo(0);
    bool grasped = false;
    for (int k = 0; k < 400; ++k) {
      const double jaw = k < 120 ? 0.6 : std::max(0.0, 0.6 - 0.02 * (k - 120));
      const double pull = k < 180 ? 0.0 : std::min(0.008, 0.0002 * (k - 180));
      if (k == 300) bench.loop.watch();
      bench.step(std::min(1.0, k / 80.0) * (way + 0.006 * way.normalized()) - pull * way.normalized(), jaw, 0);
      grasped = grasped || bench.grasping();
    }
    EXPECT_TRUE(grasped);
    expectCalm(bench, "grasped, delay " + std::to_string(delay));
  }
}

TEST_F(Organs, ALateSimulationIsStill) {
  LoopSettings settings;
  settings.delay = 2;
  Bench bench(*model_, settings);
  const Vec3 way = bench.wayTo(0);
  const Vec3 end = way + 0.012 * way.normalized();
  for (int k = 0; k < 400; ++k) {
    if (k == 300) bench.loop.watch();
    // Up to 60 ms behind, coming and going.
    const std::size_t late = k % 40 < 20 ? static_cast<std::size_t>(k % 20) % 7 : 0;
    bench.step(std::min(1.0, k / 80.0) * end, 0.0, late);
  }
  expectCalm(bench, "late simulation");
}

}  // namespace
}  // namespace calot
