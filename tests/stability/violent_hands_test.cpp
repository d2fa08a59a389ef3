// SPDX-License-Identifier: GPL-3.0-or-later
// The whole step under hands that shake at 20 Hz with 2 m/s, that teleport, and from states that were tampered with.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "sim/math/random.h"
#include "sim/step/stepper.h"
#include "tests/sim/scene/support/loop.h"
#include "tests/stability/support/depth.h"

namespace calot {
namespace {

/// What every step promises, whatever happens: finite numbers, and a miss that is told.
void expectHonest(const Model& model, const State& state, const StepResult& result) {
  ASSERT_TRUE(test::allFinite(state));
  ASSERT_TRUE(test::allFinite(result));
  const SolverDescription& solver = model.scene().solver;
  bool solverEvent = false;
  bool contactEvent = false;
  for (const Event& event : result.events) {
    solverEvent = solverEvent || event.kind == EventKind::solverMiss;
    contactEvent = contactEvent || event.kind == EventKind::contactMiss;
  }
  const bool solverMissed = (result.misses & miss::solver) != 0;
  const bool contactMissed = (result.misses & miss::contact) != 0;
  EXPECT_EQ(solverMissed, solverEvent);
  EXPECT_EQ(contactMissed, contactEvent);
  EXPECT_EQ(contactMissed, result.contact.residual > solver.contactTolerance);
  for (const OrganResult& organ : result.organ) {
    EXPECT_TRUE(solverMissed || organ.residual <= solver.tolerance) << organ.residual;
  }
}

/// Hands that swing by +-16 mm at 20 Hz (2 m/s at the middle) in a direction that turns, about places near a surface;
/// they roll, open and close their jaws, and change instruments every second.
struct Shaking {
  std::array<Vec3, handCount> centre;
  std::array<Vec3, handCount> direction;
  std::array<double, handCount> phase;
  std::uint32_t first = 0;
  Shaking(const std::array<Vec3, handCount>& about, Random& random) {
    for (std::size_t h = 0; h < handCount; ++h) {
      centre[h] = about[h] + Vec3(0.004 * random.normal(), 0.008 * random.normal(), 0.005 * random.normal());
      direction[h] = Vec3(random.normal(), random.normal(), random.normal()).normalized();
      phase[h] = random.uniform() * 2.0 * std::numbers::pi;
    }
    first = random.next() % 4U;
  }
  [[nodiscard]] InstrumentSample at(std::size_t h, double t) const {
    const double amplitude = 2.0 / (2.0 * std::numbers::pi * 20.0);
    const Vec3 turned = Eigen::AngleAxisd(1.3 * t, Vec3::UnitY()) * direction[h];
    InstrumentSample sample;
    sample.position = centre[h] + amplitude * std::sin(2.0 * std::numbers::pi * 20.0 * t + phase[h]) * turned;
    sample.orientation = Quat(Eigen::AngleAxisd(1.5 * std::sin(9.0 * t + phase[h]), Vec3::UnitZ()));
    sample.jaw = std::max(0.0, 0.5 + 0.6 * std::sin(7.0 * t + 2.0 * phase[h]));
    sample.instrument =
        static_cast<InstrumentKind>(1U + (first + static_cast<std::uint32_t>(h) + static_cast<std::uint32_t>(t)) % 4U);
    return sample;
  }
};

/// What a run met with.
struct Record {
  double deepest = 0.0;          ///< outside pinches, measured without the contact search (m)
  double pinched = 0.0;          ///< the same in steps that tell of a pinch (m)
  double told = 0.0;             ///< what the steps told (m)
  double strongest = 0.0;        ///< contact force (N)
  double strongestTick = 0.0;    ///< what the device gave out (N)
  std::vector<double> residual;  ///< of each step's contact problem, relative to its violation
  std::vector<double> error;     ///< the same with the gaps that the forces really left
  int misses = 0;
  int touches = 0;
  int holds = 0;

  void add(const Record& other) {
    deepest = std::max(deepest, other.deepest);
    pinched = std::max(pinched, other.pinched);
    told = std::max(told, other.told);
    strongest = std::max(strongest, other.strongest);
    strongestTick = std::max(strongestTick, other.strongestTick);
    residual.insert(residual.end(), other.residual.begin(), other.residual.end());
    error.insert(error.end(), other.error.begin(), other.error.end());
    misses += other.misses;
    touches += other.touches;
    holds += other.holds;
  }
};

const std::array<Vec3, handCount> onBlock{Vec3(-0.012, 0.0, test::blockTop), Vec3(0.012, 0.0, test::blockTop)};

/// The places of the skins that are nearest to where the hands are at home.
std::array<Vec3, handCount> nearHomes(const Model& model) {
  std::array<Vec3, handCount> out;
  for (std::size_t h = 0; h < handCount; ++h) {
    const Vec3& home = model.scene().hands[h].home;
    out[h] = model.organs()[0].skin[0];
    for (const OrganModel& organ : model.organs()) {
      for (const Vec3& p : organ.skin) {
        if ((p - home).squaredNorm() < (out[h] - home).squaredNorm()) out[h] = p;
      }
    }
  }
  return out;
}

double percentile99(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() * 99 / 100];
}

Record shake(const Model& model, const std::array<Vec3, handCount>& about, std::uint64_t seed, int steps,
             int measureEvery) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Record record;
  Random random(seed);
  const Shaking shaking(about, random);
  test::Loop loop(model);
  const auto sample = [&](double t) {
    TickSamples tick = loop.resting();
    for (std::size_t h = 0; h < handCount; ++h) tick.hand[h] = shaking.at(h, t);
    return tick;
  };
  for (int step = 0; step < steps; ++step) {
    const StepResult& result = loop.step(sample, [&] {
      for (std::size_t h = 0; h < handCount; ++h) {
        EXPECT_TRUE(loop.force[h].force.allFinite());
        EXPECT_TRUE(loop.force[h].torque.allFinite());
        record.strongestTick = std::max(record.strongestTick, loop.force[h].force.norm());
      }
    });
    expectHonest(model, loop.rig.state, result);
    if (testing::Test::HasFatalFailure()) return record;
    record.residual.push_back(result.contact.residual / std::max(result.contact.violation, 1e-4));
    record.error.push_back(result.contact.error / std::max(result.contact.violation, 1e-4));
    record.misses += result.misses != 0 ? 1 : 0;
    record.told = std::max(record.told, result.contact.maxDepth);
    for (std::size_t h = 0; h < handCount; ++h) {
      record.strongest = std::max(record.strongest, result.hand[h].contactForce.norm());
      record.touches += result.hand[h].touching != 0 ? 1 : 0;
      record.holds += result.hand[h].grasping != 0 ? 1 : 0;
      if (step % measureEvery != 0) continue;
      const double depth = test::instrumentDepth(model, loop.rig.state, h);
      EXPECT_LT(test::deepestDimple(loop.rig.state.hand[h].touches), 0.00801) << "dimples are bounded";
      // In a pinch an instrument may have no way out; then the step must tell how deep it is. Jaws that hold tissue are
      // left out of the measure, the rest of their instrument is not.
      double& kept = result.contact.pinchedDepth > 0.0 ? record.pinched : record.deepest;
      if (depth > std::max(kept, 2e-4)) {
        std::printf("  seed %llu step %d hand %zu instrument %d: %.3f mm deep, told %.3f, pinched %.3f\n",
                    static_cast<unsigned long long>(seed), step, h,
                    static_cast<int>(loop.rig.state.hand[h].instrument.kind), 1e3 * depth,
                    1e3 * result.contact.maxDepth, 1e3 * result.contact.pinchedDepth);
      }
      kept = std::max(kept, depth);
    }
  }
  // The hands let go and go home: the block recovers its shape.
  const auto home = [&](double) {
    TickSamples tick = loop.resting();
    for (InstrumentSample& hand : tick.hand) hand.jaw = 1.0;
    return tick;
  };
  for (int i = 0; i < 300; ++i) loop.step(home, [] {});
  EXPECT_LT(loop.rig.state.organ[0].maxDisplacement, 1e-3);
  return record;
}

void expectWithinBounds(const Model& model, const Record& record) {
  std::printf(
      "deepest %.3f mm (told %.3f), in pinches %.3f mm, relative residual p99 %.2e (posed anew %.2e), strongest "
      "contact %.2f N, "
      "device %.2f N, %d of %zu steps with misses, %d touches, %d holds\n",
      1e3 * record.deepest, 1e3 * record.told, 1e3 * record.pinched, percentile99(record.residual),
      percentile99(record.error), record.strongest, record.strongestTick, record.misses, record.residual.size(),
      record.touches, record.holds);
  EXPECT_LE(record.deepest, 5e-5);
  EXPECT_LE(record.told, record.deepest + 2e-5) << "what is told is what is measured";
  EXPECT_LE(record.pinched, 1e-3);
  EXPECT_LE(percentile99(record.residual), 1e-4);
  EXPECT_LE(percentile99(record.error), 0.02);
  EXPECT_LE(record.strongest, model.scene().hands[0].maxForce * (1.0 + 1e-6));
  EXPECT_LE(static_cast<double>(record.misses), 1e-3 * static_cast<double>(record.residual.size()));
  EXPECT_LE(record.strongestTick, model.scene().hands[0].maxForce * (1.0 + 1e-12));
  EXPECT_GT(record.touches, static_cast<int>(record.residual.size()) / 4) << "the run must press";
  EXPECT_GT(record.holds, 0) << "and hold";
}

TEST(ViolentHands, ShakingAtTwentyHertz) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(500, 8));
  ASSERT_TRUE(model);
  Record all;
  for (const std::uint64_t seed : {91U, 92U, 93U}) {
    const Record record = shake(*model, onBlock, seed, 300, 1);
    if (HasFatalFailure()) return;
    all.add(record);
  }
  expectWithinBounds(*model, all);
}

/// The liver and the gallbladder as they are drawn, with their weight.
TEST(ViolentHands, ShakingOnOrgans) {
  const std::unique_ptr<const Model> model = test::buildModel(
      recorder::loadScene(std::string(CALOT_SOURCE_DIR) + "/assets/scenes/touch-liver.json").description);
  ASSERT_TRUE(model);
  Record all;
  for (const std::uint64_t seed : {94U, 95U, 96U, 97U}) {
    const Record record = shake(*model, nearHomes(*model), seed, 300, 6);
    if (HasFatalFailure()) return;
    all.add(record);
  }
  expectWithinBounds(*model, all);
}

TEST(ViolentHandsHeavy, TwentySeedsOfTenMinutes) {
  const char* heavy = std::getenv("CALOT_HEAVY");
  if (heavy == nullptr) GTEST_SKIP() << "set CALOT_HEAVY (to a number of steps a seed, or to 1 for ten minutes each)";
  const int wanted = std::atoi(heavy);
  const int steps = wanted > 1 ? wanted : 60000;
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(500, 8));
  ASSERT_TRUE(model);
  Record all;
  for (std::uint64_t seed = 101; seed <= 120; ++seed) {
    const Record record = shake(*model, onBlock, seed, steps, 1);
    if (HasFatalFailure()) return;
    all.add(record);
  }
  expectWithinBounds(*model, all);
}

/// Tips that are somewhere else in every step, everywhere in the workspace, in and behind the organ.
TEST(ViolentHands, Teleporting) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(300, 6));
  ASSERT_TRUE(model);
  SCOPED_TRACE("seed 95");
  Random random(95);
  test::Rig rig(*model);
  const auto anywhere = [&] {
    return Vec3(random.uniform(-0.16, 0.16), random.uniform(-0.16, 0.16), random.uniform(-0.16, 0.16));
  };
  for (int step = 0; step < 400; ++step) {
    const Vec3 left = anywhere();
    const Vec3 right = random.uniform() < 0.2 ? model->scene().hands[1].port : anywhere();
    const StepResult& result = rig.step(left, right);
    expectHonest(*model, rig.state, result);
    ASSERT_FALSE(HasFatalFailure()) << "step " << step;
  }
}

/// A State whose bits were turned is refused, or it is stepped without leaving the finite numbers unnoticed.
TEST(ViolentHands, TamperedStates) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(300, 6));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 40; ++i) rig.step(Vec3(-0.005, 0.0, 0.03 - 0.0004 * i));
  ASSERT_NE(rig.state.hand[0].touches.structures, 0U);
  const std::vector<std::byte> bytes = saveState(rig.state);
  SCOPED_TRACE("seed 96");
  Random random(96);
  int restored = 0;
  for (int trial = 0; trial < 150; ++trial) {
    std::vector<std::byte> turned = bytes;
    for (int k = 0; k < 1 + trial % 3; ++k) {
      turned[random.next() % turned.size()] ^= static_cast<std::byte>(1U << (random.next() % 8U));
    }
    test::Rig other(*model);
    if (!restoreState(*model, turned, other.state)) continue;
    ++restored;
    EXPECT_EQ(saveState(other.state), turned) << "trial " << trial;
    for (int i = 0; i < 2; ++i) {
      other.step(Vec3(-0.005, 0.0, 0.014));
      test::FiniteCheck check;
      State::components(other.state,
                        [&](const auto& part) { std::remove_cvref_t<decltype(part)>::fields(part, check); });
      EXPECT_TRUE(check.finite) << "trial " << trial << ": " << check.field;
    }
  }
  EXPECT_GT(restored, 50);
}

}  // namespace
}  // namespace calot
