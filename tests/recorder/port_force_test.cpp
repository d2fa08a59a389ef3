// SPDX-License-Identifier: GPL-3.0-or-later
// Friction of the trocar and resistance of the wall, recorded and verified; what they leave alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/performer.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::recorder {
namespace {

/// Collects digests of State and the forces on the hands.
class Felt final : public Observer {
 public:
  void onStep(const StepRecord& record) override {
    digests.push_back(record.digest.component);
    for (const TickOutcome& tick : record.ticks) {
      for (const auto& hand : tick.hand) force.push_back(hand.force);
    }
  }
  void onEnd(Outcome /*outcome*/) override {}

  std::vector<decltype(StateDigest::component)> digests;
  std::vector<Vec3> force;
};

LoadedScene portScene(const std::string& keys) {
  const std::filesystem::path assets = std::filesystem::path(CALOT_SOURCE_DIR) / "assets";
  std::vector<Asset> files = loadScene(assets / "scenes" / "touch-liver.json").assets;
  std::string text(reinterpret_cast<const char*>(files[0].bytes.data()), files[0].bytes.size());
  text.replace(text.find("1489"), 4, "300");
  const std::string instrument = "\"instrument\"";
  for (std::size_t at = text.find(instrument); at != std::string::npos;
       at = text.find(instrument, at + keys.size() + instrument.size())) {
    text.insert(at, keys);
  }
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  files[0].bytes.assign(bytes, bytes + text.size());
  return sceneFromAssets(files);
}

struct Ran {
  std::unique_ptr<const Model> model;
  Felt felt;
};

/// A performer's first two seconds, recorded.
Ran recordFelt(const std::filesystem::path& file, const std::string& keys) {
  Ran ran;
  const LoadedScene scene = portScene(keys);
  Model::Built built = Model::build(scene.description);
  EXPECT_TRUE(built.model) << built.error;
  ran.model = std::move(built.model);
  const std::filesystem::path assets = std::filesystem::path(CALOT_SOURCE_DIR) / "assets";
  PerformerSource source(loadPerformer(assets / "performers" / "skilled.json"), scene.description, 3);
  AttemptSettings settings;
  settings.seed = 3;
  RecordingWriter writer(file, makeHeader(*ran.model, scene.assets, source.provenance(), settings));
  SerialExecutor executor;
  Session session(*ran.model, 3, executor);
  session.join(writer);
  session.join(ran.felt);
  RunSettings run;
  run.seconds = 2.1;
  EXPECT_EQ(runAttempt(session, source, run).outcome, Outcome::stopped);
  writer.finish();
  return ran;
}

TEST(PortForceRecorded, ReplayVerifiesIt) {
  const test::Folder folder;
  const Ran without = recordFelt(folder / "without.h5", "");
  const Ran zero = recordFelt(folder / "zero.h5", R"("trocarFriction": 0, "wallStiffness": 0, )");
  const Ran with = recordFelt(folder / "with.h5", R"("trocarFriction": 1, "wallStiffness": 0.5, )");
  for (const HandDescription& hand : with.model->scene().hands) {
    ASSERT_EQ(hand.trocarFriction, 1.0);
    ASSERT_EQ(hand.wallStiffness, 0.5);
  }
  EXPECT_EQ(zero.felt.force, without.felt.force) << "the default is off";
  ASSERT_EQ(with.felt.force.size(), without.felt.force.size());
  double most = 0.0;
  for (std::size_t i = 0; i < with.felt.force.size(); ++i) {
    most = std::max(most, (with.felt.force[i] - without.felt.force[i]).norm());
  }
  EXPECT_GT(most, 0.5) << "the hand feels it";
  EXPECT_EQ(with.felt.digests, without.felt.digests) << "nothing of it enters State";
  const ReplayReport report = replayRecording(folder / "with.h5", {});
  EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
  EXPECT_EQ(report.steps, 210U);
}

/// From a keyframe on, ticks give the recorded forces: the seal's stretch is part of it.
TEST(PortForceRecorded, GoesOnFromAKeyframe) {
  const test::Folder folder;
  const Ran ran = recordFelt(folder / "with.h5", R"("trocarFriction": 1, "wallStiffness": 0.5, )");
  Recording recording(folder / "with.h5");
  SerialExecutor executor;
  Session session(*ran.model, recording.header().seed, executor);
  ASSERT_TRUE(session.restore(recording.keyframe(0)));
  for (std::uint64_t n = session.steps(); n < recording.stepCount(); ++n) {
    const RecordedStep step = recording.step(n);
    std::vector<TickOutcome> ticks;
    for (std::size_t t = 0; t < step.samples.size(); ++t) {
      ticks.push_back(session.tick(step.samples[t]));
      for (std::size_t h = 0; h < handCount; ++h) {
        ASSERT_EQ(ticks.back().hand[h].force, ran.felt.force[(n * step.samples.size() + t) * handCount + h]) << n;
      }
    }
    session.step(step.samples, ticks, 0.0F);
  }
}

}  // namespace
}  // namespace calot::recorder
