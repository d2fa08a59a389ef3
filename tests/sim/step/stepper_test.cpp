// SPDX-License-Identifier: GPL-3.0-or-later
// A step is a function of Model, State and samples, and of nothing else.
#include "sim/step/stepper.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/determinism/thread_executor.h"
#include "tests/sim/scene/support/all_pairs.h"
#include "tests/sim/scene/support/scenes.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#include "tests/support/message.h"
#endif

namespace calot {
namespace {

constexpr int runLength = 100;

class StepperTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    model_ = test::buildModel(test::blockAndBallScene());
    ASSERT_TRUE(model_);
    reference_ = std::make_unique<std::vector<StateDigest>>(digestsOf(*std::make_unique<test::Rig>(*model_)));
  }
  static void TearDownTestSuite() {
    reference_.reset();
    model_.reset();
  }
  static std::vector<StateDigest> digestsOf(test::Rig& rig, int first = 0, int last = runLength) {
    std::vector<StateDigest> digests;
    for (int i = first; i < last; ++i) {
      const test::TipPair tips = test::contactRun(i);
      rig.step(tips.left, tips.right);
      digests.push_back(rig.stepper.digest(rig.state));
    }
    return digests;
  }
  static void expectReference(const std::vector<StateDigest>& digests, std::size_t first = 0) {
    ASSERT_FALSE(digests.empty());
    ASSERT_LE(digests.size() + first, reference_->size());
    for (std::size_t i = 0; i < digests.size(); ++i) {
      for (std::size_t f = 0; f < digests[i].field.size(); ++f) {
        ASSERT_EQ(digests[i].field[f], (*reference_)[first + i].field[f])
            << "step " << first + i << ": " << model_->layout().fields[f].name;
      }
      ASSERT_EQ(digests[i], (*reference_)[first + i]) << "step " << first + i;
    }
  }
  static inline std::unique_ptr<const Model> model_;
  static inline std::unique_ptr<std::vector<StateDigest>> reference_;
};

TEST_F(StepperTest, TheRunTouchesWithBothHandsAndLeaves) {
  test::Rig rig(*model_);
  int left = 0;
  int right = 0;
  int both = 0;
  bool ballMoved = false;
  for (int i = 0; i < runLength; ++i) {
    const test::TipPair tips = test::contactRun(i);
    const StepResult& result = rig.step(tips.left, tips.right);
    const bool l = result.hand[0].touching == 1;
    const bool r = result.hand[1].touching == 1;
    left += l ? 1 : 0;
    right += r ? 1 : 0;
    both += l && r ? 1 : 0;
    ballMoved = ballMoved || !result.organ[1].asleep;
    EXPECT_EQ(result.misses, 0U) << "step " << i;
    EXPECT_EQ(result.step, static_cast<std::uint64_t>(i));
  }
  EXPECT_GT(left, 30);
  EXPECT_GT(right, 30);
  EXPECT_GT(both, 15);
  EXPECT_EQ(rig.state.hand[0].touches.structures, 0U);
  EXPECT_EQ(rig.state.hand[1].touches.structures, 0U);
  EXPECT_FALSE(ballMoved);
}

TEST_F(StepperTest, IncrementalDigestIsTheFullOne) {
  test::Rig rig(*model_);
  // Touch, leave, and on until the block sleeps again.
  int asleep = 0;
  for (int i = 0; i < 330; ++i) {
    const test::TipPair tips = test::contactRun(i);
    const StepResult& result = rig.step(tips.left, tips.right);
    asleep += result.organ[0].asleep ? 1 : 0;
    ASSERT_EQ(rig.stepper.digest(rig.state), digestOf(rig.state)) << "step " << i;
  }
  EXPECT_GT(asleep, 10) << "asleep before the first touch";
}

TEST_F(StepperTest, RestoredStateGoesOnBitForBit) {
  for (const int at : {1, 18, 37, 61, 90}) {
    test::Rig first(*model_);
    for (int i = 0; i < at; ++i) {
      const test::TipPair tips = test::contactRun(i);
      first.step(tips.left, tips.right);
    }
    const std::vector<std::byte> bytes = saveState(first.state);
    // A new stepper, and one that has seen quite another history.
    test::Rig fresh(*model_);
    ASSERT_TRUE(restoreState(*model_, bytes, fresh.state));
    expectReference(digestsOf(fresh, at, at + 10), static_cast<std::size_t>(at));
    test::Rig used(*model_);
    for (int i = 0; i < 12; ++i) used.step(Vec3(0.01, 0.01, 0.012), Vec3(-0.01, 0.0, 0.014));
    used.stepper.digest(used.state);
    ASSERT_TRUE(restoreState(*model_, bytes, used.state));
    used.stepper.invalidate();
    expectReference(digestsOf(used, at, at + 10), static_cast<std::size_t>(at));
  }
}

TEST_F(StepperTest, AnyNumberOfThreadsGivesTheSameBits) {
  for (const unsigned threads : {1U, 2U, 4U}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    ThreadExecutor executor(threads);
    test::Rig rig(*model_, &executor);
    // Into the contact of both hands; threads that start anew for every batch take their time.
    expectReference(digestsOf(rig, 0, 40));
  }
}

TEST_F(StepperTest, AnyBroadPhaseGivesTheSameBits) {
  test::Rig rig(*model_, nullptr, &test::AllPairs::make);
  expectReference(digestsOf(rig));
}

#if defined(__x86_64__)
TEST_F(StepperTest, FlushToZeroOfTheHostChangesNothing) {
  const unsigned before = _mm_getcsr();
  constexpr unsigned flush = 0x8040U;  // flush-to-zero, denormals-are-zero
  _mm_setcsr(before | flush);
  test::Rig rig(*model_);
  const std::vector<StateDigest> digests = digestsOf(rig);
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  expectReference(digests);
  EXPECT_EQ(after & flush, flush) << "the host's setting is its own and comes back";
}
#endif

TEST_F(StepperTest, AnUntouchedOrganSleepsBitForBit) {
  test::Rig rig(*model_);
  const SolidState before = rig.state.organ[1];
  const std::size_t component = rig.state.tissueFrom() + 1;
  const std::uint64_t digest = digestOf(rig.state).component[component];
  for (int i = 0; i < runLength; ++i) {
    const test::TipPair tips = test::contactRun(i);
    const StepResult& result = rig.step(tips.left, tips.right);
    ASSERT_TRUE(result.organ[1].asleep);
    ASSERT_EQ(result.organ[1].iterations, 0U);
    ASSERT_GT(result.organ[1].volume, 0.0) << "a sleeping organ still has its volume";
  }
  EXPECT_EQ(digestOf(rig.state).component[component], digest);
  EXPECT_EQ(rig.state.organ[1].position, before.position);
}

TEST_F(StepperTest, AnOrganWakesBeforeItIsTouchedAndSleepsWhenLeft) {
  test::Rig rig(*model_);
  const Vec3 home = model_->scene().hands[1].home;
  ASSERT_TRUE(rig.step(Vec3(0.0, 0.0, 0.03)).organ[0].asleep);
  int awakeAt = -1;
  int touchedAt = -1;
  for (int i = 0; i < 40; ++i) {
    const StepResult& result = rig.step(Vec3(0.0, 0.0, 0.03 - 0.0005 * i), home);
    if (!result.organ[0].asleep && awakeAt < 0) awakeAt = i;
    if (result.hand[0].touching != 0 && touchedAt < 0) {
      touchedAt = i;
      ASSERT_FALSE(result.events.empty());
      EXPECT_EQ(result.events.back().kind, EventKind::contactBegin);
      EXPECT_GT(result.events.back().value, 0.0);
    }
  }
  ASSERT_GE(touchedAt, 0);
  EXPECT_LE(awakeAt, touchedAt);
  int ended = 0;
  bool asleep = false;
  for (int i = 0; i < 1500 && !asleep; ++i) {
    const StepResult& result = rig.step(Vec3(0.0, 0.0, 0.035), home);
    for (const Event& event : result.events) {
      if (event.kind != EventKind::contactEnd) continue;
      ++ended;
      EXPECT_NEAR(event.value, 0.01 * (40 - touchedAt), 0.0301) << "how long it lasted";
    }
    asleep = result.organ[0].asleep;
  }
  EXPECT_EQ(ended, 1);
  ASSERT_TRUE(asleep);
  for (const Vec3& v : rig.state.organ[0].velocity) ASSERT_TRUE(v.isZero(0.0));
  EXPECT_LT(rig.state.organ[0].maxDisplacement, 1e-4) << "back in its shape";
}

TEST_F(StepperTest, WithoutSleepingEveryOrganIsSolved) {
  SceneDescription scene = model_->scene();
  scene.solver.sleeping = false;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 3; ++i) {
    const StepResult& result = rig.step(Vec3(0.0, 0.0, 0.03));
    for (const OrganResult& organ : result.organ) EXPECT_FALSE(organ.asleep);
    EXPECT_LT(result.organ[0].maxDisplacement, 1e-9) << "at rest nothing moves without gravity";
  }
}

TEST_F(StepperTest, TheRunIsTheSameTwice) {
  test::Rig rig(*model_);
  expectReference(digestsOf(rig));
}

TEST(ModelBuild, IsAPureFunctionOfTheScene) {
  const std::unique_ptr<const Model> a = test::buildModel(test::blockScene(300));
  const std::unique_ptr<const Model> b = test::buildModel(test::blockScene(300));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(saveState(initialState(*a, 3)), saveState(initialState(*b, 3)));
  EXPECT_NE(saveState(initialState(*a, 3)), saveState(initialState(*b, 4))) << "the seed is part of the state";
  EXPECT_EQ(a->organs()[0].solid.tetrahedra(), b->organs()[0].solid.tetrahedra());
}

TEST(ModelBuild, SaysWhatIsWrongWithAScene) {
  SceneDescription held = test::blockScene(300);
  held.organs[0].anchors = {{Vec3::Zero(), 1.0, "", 0.0}};
  EXPECT_NE(Model::build(held).error.find("block"), std::string::npos) << "every node held";
  SceneDescription missing = test::blockScene(300);
  missing.organs[0].anchors.push_back({Vec3::Zero(), 0.0, "spleen", 0.001});
  const Model::Built built = Model::build(missing);
  EXPECT_FALSE(built.model);
  EXPECT_NE(built.error.find("spleen"), std::string::npos);
  SceneDescription open = test::blockScene(300);
  open.organs[0].surface.triangle.pop_back();
  EXPECT_FALSE(Model::build(open).model) << "an open surface";
  SceneDescription many = test::blockScene(300);
  many.organs.assign(maxStructures + 1, many.organs[0]);
  expectNames(Model::build(many).error, {"17", "16"});
}

}  // namespace
}  // namespace calot
