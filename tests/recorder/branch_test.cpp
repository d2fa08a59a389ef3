// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/loop.h"

#include <gtest/gtest.h>

#include <optional>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/source.h"
#include "tests/recorder/support/small_scene.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

std::filesystem::path parentOf(const test::SmallScene& scene, const std::filesystem::path& file, Mode mode,
                               bool live = false) {
  const std::unique_ptr<SampleSource> source = test::performer(scene, "skilled", 6);
  AttemptSettings settings;
  settings.seed = 6;
  settings.participant = "P9";
  settings.mode = mode;
  RecordingWriter writer(file, makeHeader(*scene.model, scene.assets, source->provenance(), settings));
  SerialExecutor executor;
  Session session(*scene.model, 6, executor);
  session.join(writer);
  RunSettings run;
  run.seconds = 1.5;
  run.live = live;
  runAttempt(session, *source, run);
  writer.finish();
  return file;
}

/// A branch on, by the unskilled performer.
std::filesystem::path branchOf(const std::filesystem::path& parentFile, const std::filesystem::path& file, double at,
                               bool live) {
  Recording parent(parentFile);
  refuseParent(parent);
  const std::uint64_t fork = forkStepAt(parent, at);
  const std::shared_ptr<PreparedScene> prepared = sceneOf(parent);
  const Model& model = prepared->model();
  const test::SmallScene scene = test::smallScene();
  const std::unique_ptr<SampleSource> source = test::performer(scene, "unskilled", 2);
  const AttemptHeader header = branchHeader(parent, model, fork, source->provenance());
  NewFile place(file, false, ".branch");
  RecordingWriter writer(place.path(), header);
  SerialExecutor executor;
  Session session(model, header.seed, executor);
  session.join(writer);
  EXPECT_FALSE(takeParent(parent, session, fork));
  place.publish();
  BlendedSource blended(*source, parent.step(fork).samples.back());
  RunSettings run;
  run.live = live;
  run.seconds = at + 1.2;
  runAttempt(session, blended, run);
  writer.finish();
  return file;
}

TEST(Branch, IsAWholeRecordingThatSharesItsParentsPast) {
  const test::SmallScene scene = test::smallScene();
  const test::Folder folder;
  for (const bool live : {false, true}) {
    const std::string suffix = live ? "-live.h5" : ".h5";
    const std::filesystem::path first = parentOf(scene, folder / ("a" + suffix), Mode::practice, live);
    const std::filesystem::path second = branchOf(first, folder / ("b" + suffix), 1.05, live);
    const std::filesystem::path third = branchOf(second, folder / ("c" + suffix), 1.4, live);  // of a branch
    EXPECT_FALSE(std::filesystem::exists(folder / ("b" + suffix + ".branch")));
    Recording parent(first), branch(second), twig(third);
    EXPECT_EQ(branch.header().parent, parent.header().attempt);
    EXPECT_EQ(branch.header().forkStep, 104);
    EXPECT_EQ(twig.header().parent, branch.header().attempt);
    EXPECT_EQ(twig.header().forkStep, 139);
    EXPECT_EQ(branch.header().seed, 6U);
    EXPECT_EQ(branch.header().participant, "P9");
    EXPECT_EQ(branch.header().provenance.profile, "unskilled");
    EXPECT_NE(branch.header().attempt, parent.header().attempt);
    EXPECT_EQ(branch.stepCount(), 225U);
    for (std::uint64_t n = 0; n <= 104; ++n) {
      const RecordedStep a = parent.step(n);
      const RecordedStep b = branch.step(n);
      EXPECT_EQ(a.brief, b.brief);
      for (std::size_t t = 0; t < a.ticks.size(); ++t) {
        EXPECT_EQ(a.ticks[t].lateness, b.ticks[t].lateness);
        for (std::size_t h = 0; h < handCount; ++h) {
          EXPECT_EQ(a.ticks[t].hand[h].contactSet, b.ticks[t].hand[h].contactSet);
          EXPECT_EQ(a.ticks[t].hand[h].force, b.ticks[t].hand[h].force);
        }
      }
    }
    EXPECT_NE(parent.step(149).brief, branch.step(149).brief) << "the branch went the parent's way";
    for (const std::filesystem::path& file : {second, third}) {
      for (const unsigned threads : {1U, 2U}) {
        ReplaySettings settings;
        settings.threads = threads;
        const ReplayReport report = replayRecording(file, settings);
        EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
      }
    }
  }
}

TEST(Branch, RefusesWhatCannotBeBranched) {
  const test::SmallScene scene = test::smallScene();
  const test::Folder folder;
  Recording assessed(parentOf(scene, folder / "assessed.h5", Mode::assessment));
  expectFault(ErrorKind::refused, assessed.path().string(), {"assessment"}, [&] { refuseParent(assessed); });
  Recording good(parentOf(scene, folder / "good.h5", Mode::practice));
  EXPECT_NO_THROW(refuseParent(good));
  for (const double at : {0.0, 0.009, -1.0, 1.52, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    SCOPED_TRACE(at);
    expectFault(ErrorKind::invalid, "", {good.path().string(), at > 1.0 ? "1.5 s" : "0.01 s"},
                [&] { forkStepAt(good, at); }, {Remedy::moveFork});
  }
  EXPECT_EQ(forkStepAt(good, 0.01), 0U);
  EXPECT_EQ(forkStepAt(good, 0.07), 6U) << "0.07 / 0.01 is a little below 7";
  EXPECT_EQ(forkStepAt(good, 0.075), 6U);
  EXPECT_EQ(forkStepAt(good, 1.5), 149U);

  // Another seed's simulation is not the parent's.
  SerialExecutor executor;
  Session other(*scene.model, 7, executor);
  EXPECT_TRUE(takeParent(good, other, 10));
}

TEST(Blend, NeitherPlaceNorSpeedJumps) {
  const test::SmallScene scene = test::smallScene();
  const std::unique_ptr<SampleSource> plain = test::performer(scene, "skilled", 3, 0);
  const std::unique_ptr<SampleSource> inner = test::performer(scene, "skilled", 3, 0);
  TickSamples start;
  ASSERT_TRUE(test::performer(scene, "skilled", 3, 0)->next(0, start));
  for (InstrumentSample& hand : start.hand) {
    hand.position += Vec3(0.03, -0.02, 0.04);
    hand.orientation = Quat(-hand.orientation.w(), -hand.orientation.x(), -hand.orientation.y(), -hand.orientation.z());
    hand.jaw = 0.4;
  }
  BlendedSource blended(*inner, start);
  const auto ticks = static_cast<std::uint64_t>(BlendedSource::blendTime / tickLength + 0.5);
  TickSamples before = start;
  TickSamples out, own;
  const double length = Vec3(0.03, -0.02, 0.04).norm();
  for (std::uint64_t t = 0; t < ticks + 50; ++t) {
    ASSERT_TRUE(blended.next(t, out));
    ASSERT_TRUE(plain->next(t, own));
    for (std::size_t h = 0; h < handCount; ++h) {
      // At most the blend's greatest speed and the performer's own (it rests for half a second, then sets out).
      const double moved = (out.hand[h].position - before.hand[h].position).norm();
      EXPECT_LT(moved, (1.875 * length / BlendedSource::blendTime + 0.3) * tickLength + 4e-6) << t;
      EXPECT_GT(std::abs(out.hand[h].orientation.dot(before.hand[h].orientation)), 0.9999) << t;
      if (t >= ticks) {
        EXPECT_EQ(out.hand[h].position, own.hand[h].position);
        EXPECT_EQ(out.hand[h].jaw, own.hand[h].jaw);
      }
    }
    if (t < 30) {
      EXPECT_LT((out.hand[0].position - start.hand[0].position).norm(), 3e-5) << "it starts at rest";
    }
    before = out;
  }
}

}  // namespace
}  // namespace calot::recorder
