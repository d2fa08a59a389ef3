// SPDX-License-Identifier: GPL-3.0-or-later
// From a hand to the cohort: three seconds of carve-fat are recorded, replayed, read, assessed and stored.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "analytics/assess.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/cohort/cohort_database.h"
#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/pointing.h"
#include "tests/analytics/checkpoints/support/steps.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// The right hand holds the hook in the air with the current on for a second, brings it to the nearest fat in another,
/// and strokes through it in the third. The left hand keeps still.
class Carver final : public recorder::SampleSource {
 public:
  explicit Carver(const SceneDescription& scene) : scene_(scene), target_(scene.hands[1].home) {
    provenance_.profile = "scripted";
    double least = 1e300;
    for (const Vec3& vertex : scene.fat[0].surface.vertex) {
      const double away = (vertex - scene.hands[1].home).norm();
      if (away < least) {
        least = away;
        target_ = vertex;
      }
    }
    target_ += 0.002 * recorder::shaftDirection(scene.hands[1].port, target_);
  }
  [[nodiscard]] const recorder::Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& out) override {
    if (tick >= 3000) return false;
    const double t = static_cast<double>(tick) * 0.001;
    out = TickSamples{};
    out.camera = scene_.camera;
    for (std::size_t h = 0; h < 2; ++h) {
      const HandDescription& hand = scene_.hands[h];
      Vec3 tip = hand.home;
      if (h == 1) {
        tip += recorder::minimumJerk(t - 1.0) * (target_ - hand.home);
        if (t > 2.0) tip.x() += 0.006 * recorder::minimumJerk(t - 2.0);
        out.hand[h].buttons = button::cutPedal;
      }
      out.hand[h].instrument = hand.instrument;
      out.hand[h].position = tip;
      out.hand[h].orientation = recorder::pointing(hand.port, tip);
    }
    out = roundedToGrid(out);
    return true;
  }

 private:
  const SceneDescription& scene_;
  Vec3 target_;
  recorder::Provenance provenance_;
};

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "calot-carve-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

TEST(CarveFat, isAssessedFromTheHandToTheCohort) {
  const Folder folder;
  const std::string file = folder.file("carve.h5");
  recorder::LoadedScene scene =
      recorder::loadScene(std::filesystem::path(CALOT_SOURCE_DIR) / "assets/scenes/carve-fat.json");
  Model::Built built = Model::build(std::move(scene.description));
  ASSERT_TRUE(built.model) << built.error;
  const Model& model = *built.model;
  Carver source(model.scene());
  recorder::AttemptSettings attempt;
  attempt.seed = 7;
  const recorder::AttemptHeader header =
      recorder::makeHeader(model, std::move(scene.assets), source.provenance(), attempt);
  CheckpointCollector live(header, model.scene());
  {
    recorder::RecordingWriter writer(file, header);
    recorder::WorkerPool pool(1);
    recorder::Session session(model, attempt.seed, pool);
    session.join(writer);
    session.join(live);
    (void)recorder::runAttempt(session, source, {});
    writer.finish();
  }

  // Every way to the values gives the same bits.
  std::unique_ptr<CheckpointCollector> replayed;
  recorder::ReplaySettings settings;
  settings.observers = [&](const recorder::AttemptHeader& h, const SceneDescription& s) {
    replayed = std::make_unique<CheckpointCollector>(h, s);
    return std::vector<recorder::Observer*>{replayed.get()};
  };
  const std::vector<CheckpointValue> values = live.values();
  recorder::ReplayReport report;
  for (const unsigned threads : {1U, 2U}) {  // 2: from recorded results, once proven
    settings.threads = threads;
    report = recorder::replayRecording(file, settings);
    ASSERT_EQ(report.verdict, recorder::ReplayVerdict::exact) << report.error;
    EXPECT_EQ(replayed->values(), values) << threads << " threads";
  }
  recorder::Recording recording(file);
  std::vector<CheckpointValue> read = valuesFromObservables(recording);
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].origin, values[i].origin == Origin::samples ? Origin::samples : Origin::observables);
    read[i].origin = values[i].origin;
    if (values[i].name.find("force") != std::string::npos && read[i].value && values[i].value) {
      // Of forces recordings hold what is felt, not their last bits.
      EXPECT_NEAR(*read[i].value, *values[i].value, 1e-4 + 1e-3 * std::abs(*values[i].value)) << values[i].name;
      read[i].value = values[i].value;
    }
    EXPECT_EQ(read[i], values[i]) << values[i].name << " " << values[i].subject;
  }

  // What the hand did, and what the recording's own columns say.
  EXPECT_DOUBLE_EQ(*support::valueOf(live, "elapsed-time").value, 3.0);
  EXPECT_GT(*support::valueOf(live, "path-length", "right").value, 0.02);
  EXPECT_LT(*support::valueOf(live, "path-length", "left").value, 1e-9);
  const FatResult first = recording.step(0).result.fat.at(0);
  const FatResult last = recording.step(299).result.fat.at(0);
  const CheckpointValue fat = support::valueOf(live, "fat-remaining");
  ASSERT_TRUE(fat.value) << fat.reason;
  EXPECT_DOUBLE_EQ(*fat.value, last.volume / first.volume);
  EXPECT_LT(*fat.value, 0.9999) << "the stroke took fat";
  EXPECT_GT(*fat.value, 0.5);
  double touched = 0.0, air = 0.0, inAir = 0.0, longEnough = 0.0;
  const std::vector<std::string> structures = header.structures();
  for (std::uint64_t n = 0; n < 300; ++n) {
    const StepResult& r = recording.step(n).result;
    for (const HandResult& hand : r.hand) {
      for (std::size_t s = 0; s < structures.size(); ++s) {
        if (structures[s] == "cystic-duct" || structures[s] == "cystic-artery") touched += hand.touching >> s & 1U;
      }
    }
    const bool without = r.hand[1].cautery == Cautery::withoutContact;
    air += without ? 1.0 : 0.0;
    inAir = without ? inAir + 1.0 : 0.0;
    longEnough = std::max(longEnough, inAir);
  }
  EXPECT_NEAR(*support::valueOf(live, "cystic-contact-time").value, touched * 0.01, 1e-12);
  const double cautery = *support::valueOf(live, "cautery-without-contact", "right").value;
  EXPECT_GE(cautery, 1.0) << "the first second was in the air";
  EXPECT_GE(cautery, longEnough * 0.01 - 1e-12);
  EXPECT_LE(cautery, air * 0.01 + 1e-12);
  EXPECT_LT(cautery, 3.0) << "the stroke was not";
  for (const OrganModel& organ : model.organs()) {
    double area = 0.0;
    for (const double a : organ.triangleArea) area += a;
    const std::size_t o = model.structureNamed(organ.name);
    EXPECT_NEAR(*support::valueOf(live, "organ-burned", organ.name).value,
                recording.step(299).result.organ[o].charredArea / area, 1e-12);
  }
  EXPECT_EQ(support::valueOf(live, "connective-remaining").availability, Availability::notApplicable);
  expectNames(support::valueOf(live, "clip-errors").reason, {"clip"});

  // And into the cohort and out again.
  CohortDatabase database(folder.file("c.db"), CohortDatabase::Access::create);
  EXPECT_EQ(database.storeAttempt(recordOf(header, report, file), values), Imported::added);
  EXPECT_EQ(database.values(header.attempt), values);
}

}  // namespace
}  // namespace calot::analytics
