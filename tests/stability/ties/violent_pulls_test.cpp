// SPDX-License-Identifier: GPL-3.0-or-later
// Both operations' scenes under hands that grasp wherever they come by, tear at it, clip and cut at random.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double fastest = 10.0;  ///< m/s, of anything at any time
/// Of the steps, at most: a limit that works oftener would be a law of motion.
constexpr double heldBackShare = 0.001;
/// Of the whole operation: fat that hangs on a vessel when it tears is whipped to the speed limit for some steps. How
/// many is chance: 16 to 36 of 600 over twenty variants of contact's settings.
constexpr double heldBackWithFat = 0.07;

SceneDescription sceneNamed(const std::string& name) {
  return recorder::loadScene(std::string(CALOT_SOURCE_DIR) + "/assets/scenes/" + name + ".json").description;
}

/// A hand that goes from place to place on the tissue, closes its jaws there and jerks away; sometimes it presses its
/// pedal, sometimes it changes its instrument.
class WildHand {
 public:
  WildHand(const Model& model, std::size_t hand, std::uint64_t seed) : model_(model), random_(seed, hand) {
    place_ = model.scene().hands[hand].home;
    instrument_ = model.scene().hands[hand].instrument;
    begin();
  }

  InstrumentSample sample() {
    if (left_ == 0) begin();
    const double s = 1.0 - static_cast<double>(left_) / static_cast<double>(length_);
    --left_;
    InstrumentSample out;
    place_ = from_ + s * (to_ - from_);
    out.position = place_;
    out.orientation = turn_;
    out.jaw = jawFrom_ + s * (jawTo_ - jawFrom_);
    out.instrument = instrument_;
    out.buttons = pedal_ ? 1 : 0;
    return out;
  }

 private:
  /// The next stroke: to a place near a vessel's end or on a skin, closing there, then away.
  void begin() {
    from_ = place_;
    jawFrom_ = jawTo_;
    switch (phase_) {
      case 0:  // goes there, jaws open
        if (random_.uniform() < 0.2) {
          constexpr std::array kinds{InstrumentKind::grasper, InstrumentKind::scissors, InstrumentKind::clipApplier,
                                     InstrumentKind::hook};
          instrument_ = kinds[random_.next() % kinds.size()];
        }
        to_ = target();
        turn_ = Quat(random_.normal(), random_.normal(), random_.normal(), random_.normal());
        turn_.coeffs() /= turn_.coeffs().norm();
        jawTo_ = 1.0;
        length_ = 300;
        pedal_ = false;
        break;
      case 1:  // closes
        to_ = place_;
        jawTo_ = 0.0;
        length_ = 100;
        pedal_ = random_.uniform() < 0.3;
        break;
      default:  // jerks: up to 2 m/s, up to 8 cm
        to_ = place_ + Vec3(random_.uniform(-0.05, 0.05), random_.uniform(-0.02, 0.08), random_.uniform(-0.05, 0.05));
        jawTo_ = 0.0;
        length_ = 40 + random_.next() % 400;
    }
    phase_ = phase_ == 4 ? 0 : phase_ + 1;
    left_ = length_;
  }

  Vec3 target() {
    const Vec3 spread(random_.uniform(-0.003, 0.003), random_.uniform(-0.003, 0.003), random_.uniform(-0.003, 0.003));
    if (random_.uniform() < 0.6) {  // on a vessel
      const VesselTree& tree = model_.vesselTrees()[random_.next() % model_.vesselTrees().size()];
      return tree.beams.rest()[random_.next() % tree.beams.nodes()] + spread;
    }
    // The gallbladder, its neck as often as the rest.
    const OrganModel& organ = model_.organs()[1];
    const Vec3 neck(-0.0245, -0.0303, -0.0222);
    Vec3 best = organ.skin[random_.next() % organ.skin.size()];
    if (random_.uniform() < 0.5) {
      for (int k = 0; k < 40; ++k) {
        const Vec3& p = organ.skin[random_.next() % organ.skin.size()];
        if ((p - neck).norm() < (best - neck).norm()) best = p;
      }
    }
    return best + spread;
  }

  const Model& model_;
  Random random_;
  Vec3 place_, from_ = Vec3::Zero(), to_ = Vec3::Zero();
  Quat turn_ = Quat::Identity();
  double jawFrom_ = 0.0, jawTo_ = 0.0;
  InstrumentKind instrument_ = InstrumentKind::grasper;
  bool pedal_ = false;
  int phase_ = 0;
  std::uint32_t length_ = 1, left_ = 0;  // ticks
};

struct Wild {
  double maxSpeed = 0.0;
  std::size_t worstStep = 0;
  std::size_t holds = 0, clips = 0, cuts = 0, torn = 0, misses = 0, speeding = 0, heldBack = 0;
  double left = 0.0;  ///< largest speed after a second without hands (m/s)
  StateDigest digest;
};

double speedOf(const State& state) {
  double largest = 0.0;
  const auto look = [&](const std::vector<Vec3>& velocity) {
    for (const Vec3& v : velocity) largest = std::max(largest, v.norm());
  };
  for (const SolidState& organ : state.organ) look(organ.velocity);
  for (const BeamState& vessel : state.vessel) look(vessel.velocity);
  for (const FatState& fat : state.fat) look(fat.solid.velocity);
  return largest;
}

Wild runWild(const Model& model, std::uint64_t seed, int steps, Executor* executor = nullptr) {
  test::Rig rig(model, executor);
  std::vector<WildHand> hand;
  for (std::size_t h = 0; h < handCount; ++h) hand.emplace_back(model, h, seed);
  Wild out;
  std::vector<TickSamples> ticks(model.scene().ticksPerStep);
  const auto look = [&](const StepResult& result) {
    const double speed = speedOf(rig.state);
    EXPECT_TRUE(test::allFinite(rig.state)) << "step " << result.step;
    EXPECT_EQ((result.misses & miss::runaway) != 0, speed > maxTissueSpeed);
    if (speed > out.maxSpeed) {
      out.maxSpeed = speed;
      out.worstStep = result.step;
    }
    out.speeding += speed > 2.0 ? 1 : 0;
    out.misses += result.misses != 0 ? 1 : 0;
    // What is flagged is what was asked for.
    EXPECT_EQ((result.misses & miss::contact) != 0, result.contact.residual > model.scene().solver.contactTolerance);
    const bool heldBack = (result.misses & miss::speed) != 0;
    EXPECT_EQ(heldBack, std::any_of(result.events.begin(), result.events.end(),
                                    [](const Event& e) { return e.kind == EventKind::motionHeldBack; }));
    out.heldBack += heldBack ? 1 : 0;
    for (const Event& event : result.events) {
      out.holds += event.kind == EventKind::graspBegin ? 1 : 0;
      out.clips += event.kind == EventKind::clipSet ? 1 : 0;
      out.cuts += event.kind == EventKind::vesselCut ? 1 : 0;
      out.torn += event.kind == EventKind::vesselTorn ? 1 : 0;
    }
  };
  const bool failedBefore = testing::Test::HasFailure();
  for (int i = 0; i < steps && (failedBefore || !testing::Test::HasFailure()); ++i) {
    for (TickSamples& tick : ticks) {
      tick.camera = model.scene().camera;
      for (std::size_t h = 0; h < handCount; ++h) tick.hand[h] = hand[h].sample();
    }
    look(rig.stepper.step(rig.state, ticks));
  }
  for (int i = 0; i < 200; ++i) {  // let go, and gone home
    for (TickSamples& tick : ticks) {
      for (std::size_t h = 0; h < handCount; ++h) {
        tick.hand[h] = {};
        tick.hand[h].position = model.scene().hands[h].home;
        tick.hand[h].jaw = 1.0;
        tick.hand[h].instrument = model.scene().hands[h].instrument;
      }
    }
    look(rig.stepper.step(rig.state, ticks));
  }
  out.left = speedOf(rig.state);
  out.digest = digestOf(rig.state);
  return out;
}

void pull(const std::string& name, std::uint64_t firstSeed, int seeds, int steps, double heldBack) {
  const std::unique_ptr<const Model> model = test::buildModel(sceneNamed(name));
  ASSERT_TRUE(model);
  for (int s = 0; s < seeds; ++s) {
    const std::uint64_t seed = firstSeed + static_cast<std::uint64_t>(s);
    const Wild w = runWild(*model, seed, steps);
    std::printf(
        "%s seed %llu: at most %.2f m/s (step %zu; %zu steps above 2, %zu held back), %.2g left; %zu holds, %zu clips, "
        "%zu cuts, %zu torn, %zu misses\n",
        name.c_str(), static_cast<unsigned long long>(seed), w.maxSpeed, w.worstStep, w.speeding, w.heldBack, w.left,
        w.holds, w.clips, w.cuts, w.torn, w.misses);
    EXPECT_LE(w.maxSpeed, 1.001 * fastest) << "seed " << seed;
    EXPECT_LE(static_cast<double>(w.heldBack), heldBack * steps) << "seed " << seed;
    // What is crumpled into itself trembles for a while.
    EXPECT_LT(w.left, 0.5) << "seed " << seed;
  }
}

bool heavy() { return std::getenv("CALOT_HEAVY") != nullptr; }

TEST(ViolentPulls, OnClipAndCutStayBounded) {
  pull("clip-and-cut", 1, heavy() ? 20 : 2, heavy() ? 1500 : 900, heldBackShare);
}
TEST(ViolentPulls, OnTheWholeOperationStayBounded) {
  pull("cholecystectomy", 101, heavy() ? 10 : 1, heavy() ? 1200 : 600, heldBackWithFat);
}

TEST(ViolentPulls, GiveTheSameBitsForAnyNumberOfWorkers) {
  for (const auto& [scene, steps] : {std::pair("clip-and-cut", 100), std::pair("cholecystectomy", 40)}) {
    const std::unique_ptr<const Model> model = test::buildModel(sceneNamed(scene));
    ASSERT_TRUE(model);
    const auto alone = runWild(*model, 7, steps).digest;
    for (const unsigned workers : {2U, 3U, 5U, 8U}) {
      recorder::WorkerPool pool(workers);
      EXPECT_EQ(runWild(*model, 7, steps, &pool).digest, alone) << scene << ", " << workers << " workers";
    }
  }
}

}  // namespace
}  // namespace calot
