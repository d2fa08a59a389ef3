// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/replay.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "recorder/engine/session.h"
#include "recorder/engine/state_fields.h"
#include "tests/recorder/support/lying_recording.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

class Replay : public ::testing::Test {
 protected:
  Replay() : folder_(std::filesystem::temp_directory_path() / ("calot-replay-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Replay() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path record(const std::string& name, const std::optional<test::Lie>& lie = {}) {
    const std::filesystem::path file = folder_ / name;
    test::recordTouches(file, lie);
    return file;
  }

  std::filesystem::path folder_;
};

TEST_F(Replay, IsExactWithOneAndTwoThreads) {
  const std::filesystem::path file = record("r.h5");
  for (const unsigned threads : {1U, 2U}) {
    ReplaySettings settings;
    settings.threads = threads;
    const ReplayReport report = replayRecording(file, settings);
    EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
    EXPECT_EQ(report.steps, 210U);
    EXPECT_TRUE(report.complete);
    EXPECT_EQ(report.outcome, Outcome::stopped);
    EXPECT_EQ(report.fault(), std::nullopt);
  }
}

TEST_F(Replay, SaysWhatIsWrongWithADamagedRecordingAndWhatSavesIt) {
  const std::filesystem::path file = record("r.h5");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 100);
  const ReplayReport report = replayRecording(file, {});
  EXPECT_EQ(report.verdict, ReplayVerdict::damaged);
  EXPECT_EQ(report.fault(), ErrorKind::damaged);
  EXPECT_EQ(report.error.find(file.string()), std::string::npos)
      << report.error << ": the report names the file itself";
  EXPECT_EQ(report.remedies, std::vector{Remedy::recover});
}

TEST_F(Replay, NamesStepTickComponentAndBothValues) {
  const ReplayReport force = replayRecording(record("f.h5", test::Lie{test::Lie::About::force, 150}), {});
  ASSERT_EQ(force.verdict, ReplayVerdict::diverged) << force.error;
  EXPECT_TRUE(force.chainIntact());
  ASSERT_TRUE(force.divergence);
  EXPECT_EQ(force.divergence->step, 150U);
  EXPECT_EQ(force.divergence->tick, 1504U);
  EXPECT_EQ(force.divergence->component, "force.right");
  EXPECT_EQ(force.divergence->field, "force[2]");
  expectNames(force.divergence->detail, {"recorded"});
  EXPECT_EQ(force.reproducible, true);
  EXPECT_EQ(force.fault(), ErrorKind::refused);

  // Less than the grid that forces are stored on: their digest tells.
  const ReplayReport torque = replayRecording(record("t.h5", test::Lie{test::Lie::About::torque, 150}), {});
  ASSERT_TRUE(torque.divergence) << torque.error;
  EXPECT_EQ(torque.divergence->step, 150U);
  EXPECT_EQ(torque.divergence->component, "force");
  EXPECT_TRUE(holdsToken(torque.divergence->field, "digest"));

  const ReplayReport digest = replayRecording(record("d.h5", test::Lie{test::Lie::About::digest, 151}), {});
  ASSERT_TRUE(digest.divergence) << digest.error;
  EXPECT_EQ(digest.divergence->step, 151U);
  EXPECT_EQ(digest.divergence->component, "organ.liver");
  EXPECT_EQ(digest.divergence->field, "position");

  const ReplayReport volume = replayRecording(record("v.h5", test::Lie{test::Lie::About::volume, 152}), {});
  ASSERT_TRUE(volume.divergence) << volume.error;
  EXPECT_EQ(volume.divergence->component, "observables");
  EXPECT_EQ(volume.divergence->field, "organs/volume[0]");

  const ReplayReport keyframe = replayRecording(record("k.h5", test::Lie{test::Lie::About::keyframe, 199}), {});
  ASSERT_TRUE(keyframe.divergence) << keyframe.error;
  EXPECT_EQ(keyframe.divergence->step, 199U);
  EXPECT_EQ(keyframe.divergence->component, "keyframe");
}

TEST_F(Replay, SeekingGivesTheStateOfRunningThere) {
  Recording recording(record("s.h5"));
  ASSERT_EQ(recording.keyframeSteps(), (std::vector<std::uint64_t>{99, 199}));
  SerialExecutor executor;
  const std::shared_ptr<PreparedScene> prepared = sceneOf(recording);
  const Model& model = prepared->model();
  Session straight(model, recording.header().seed, executor);
  std::vector<StateDigest> digests;
  std::vector<std::vector<std::byte>> states;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep recorded = recording.step(n);
    std::vector<TickOutcome> ticks;
    for (const TickSamples& tick : recorded.samples) ticks.push_back(straight.tick(tick));
    straight.step(recorded.samples, ticks, 0.0F);
    states.push_back(saveState(straight.state()));
  }
  Seeker seeker(recording);
  // Forwards, backwards, onto keyframes, around them, and twice the same.
  for (const std::uint64_t step : {207U, 5U, 99U, 100U, 101U, 180U, 199U, 199U, 0U, 209U}) {
    seeker.seek(step);
    EXPECT_EQ(seeker.steps(), step + 1);
    EXPECT_EQ(seeker.keyframe().state, states[step]) << "step " << step;
  }
}

TEST_F(Replay, ASessionRefusesAKeyframeThatIsNotItsOwn) {
  Recording recording(record("o.h5"));
  SerialExecutor executor;
  const std::shared_ptr<PreparedScene> prepared = sceneOf(recording);
  const Model& model = prepared->model();
  Session session(model, 1, executor);
  const Keyframe good = recording.keyframe(0);
  Keyframe cut = good;
  cut.state.resize(cut.state.size() - 8);
  EXPECT_FALSE(session.restore(cut));
  Keyframe grown = good;
  grown.haptics.push_back(std::byte{0});
  EXPECT_FALSE(session.restore(grown));
  Keyframe elsewhere = good;
  ++elsewhere.step;
  EXPECT_FALSE(session.restore(elsewhere));
  EXPECT_EQ(session.steps(), 0U);
  EXPECT_TRUE(session.restore(good));
  EXPECT_EQ(session.steps(), good.step + 1);
}

TEST_F(Replay, ATickThatNamesAnUnknownContactSetIsRefused) {
  Recording recording(record("c.h5"));
  SerialExecutor executor;
  const std::shared_ptr<PreparedScene> prepared = sceneOf(recording);
  const Model& model = prepared->model();
  Session session(model, 3, executor);
  const TickSamples tick = recording.step(0).samples[0];
  EXPECT_NO_THROW(session.tick(tick, std::array<std::int64_t, 2>{-1, -1}));
  EXPECT_THROW(session.tick(tick, std::array<std::int64_t, 2>{0, -1}), std::out_of_range);
  EXPECT_THROW(session.tick(tick, std::array<std::int64_t, 2>{-1, -2}), std::out_of_range);
}

TEST(StateFields, TheFirstDifferenceIsNamed) {
  const std::vector<StateField> a{{"x/a", std::vector<std::uint64_t>{1, 2}}, {"x/b", std::vector<double>{0.5, -0.0}}};
  std::vector<StateField> b = a;
  EXPECT_FALSE(firstDifference(a, b));
  std::get<0>(b[1].values)[1] = 0.0;  // equal as numbers, other bits
  const auto sign = firstDifference(a, b);
  ASSERT_TRUE(sign);
  EXPECT_EQ(sign->field, "x/b");
  EXPECT_EQ(sign->index, 1U);
  EXPECT_EQ(sign->first, "-0");
  EXPECT_EQ(sign->second, "0");
  std::get<1>(b[0].values).push_back(9);
  const auto longer = firstDifference(a, b);
  ASSERT_TRUE(longer);
  EXPECT_EQ(longer->field, "x/a");
  EXPECT_EQ(longer->index, 2U);
  EXPECT_EQ(longer->first, "absent");
}

}  // namespace
}  // namespace calot::recorder
