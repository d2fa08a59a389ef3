// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/support/lying_recording.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/loop.h"
#include "recorder/recording/writer.h"

namespace calot::recorder::test {

namespace {

std::size_t placeOf(const DigestLayout& layout, const std::string& field) {
  std::size_t place = 0;
  while (layout.fields[place].name != field) ++place;
  return place;
}

/// Stands between the loop and the writer and tells it something else.
class Liar final : public Observer {
 public:
  Liar(Observer& writer, const DigestLayout& layout, const std::optional<Lie>& lie)
      : writer_(writer), layout_(layout), lie_(lie) {}

  void onStep(const StepRecord& record) override {
    if (!lie_ || record.step != lie_->step) return writer_.onStep(record);
    std::vector<TickSamples> samples(record.samples.begin(), record.samples.end());
    std::vector<TickOutcome> ticks(record.ticks.begin(), record.ticks.end());
    StepResult result = record.result;
    StateDigest digest = record.digest;
    std::function<Keyframe()> keyframe = record.keyframe;
    const auto changed = [&](auto change) {
      keyframe = [&record, change] {
        Keyframe k = record.keyframe();
        change(k);
        return k;
      };
    };
    switch (lie_->about) {
      case Lie::About::force:
        ticks[4].hand[1].force[2] += 1e-3;
        break;
      case Lie::About::torque:
        ticks.back().hand[0].torque[1] += 1e-12;  // less than what is stored shows
        break;
      case Lie::About::contactSet:
        ticks.front().hand[1].contactSet -= 2;
        break;
      case Lie::About::sample:
        samples[2].hand[0].position[0] += 1e-9;
        break;
      case Lie::About::digest:
        digest.component[layout_.fields[placeOf(layout_, "organ.liver/position")].component] ^= 1U;
        digest.field[placeOf(layout_, "organ.liver/position")] ^= 1U;
        break;
      case Lie::About::volume:
        result.organ[0].volume *= 1.0 + 1e-15;
        break;
      case Lie::About::event: {
        Event event;
        event.step = record.step;
        event.kind = EventKind::motionHeldBack;
        result.events.push_back(event);
        break;
      }
      case Lie::About::keyframe:
        changed([](Keyframe& k) { k.state[200] ^= std::byte{1}; });
        break;
      case Lie::About::lastByte:
        changed([](Keyframe& k) { k.haptics.back() ^= std::byte{1}; });
        break;
    }
    writer_.onStep({record.step, samples, ticks, result, digest, record.lateness, keyframe, record.view});
  }
  void onEnd(Outcome outcome) override { writer_.onEnd(outcome); }

 private:
  Observer& writer_;
  const DigestLayout& layout_;
  std::optional<Lie> lie_;
};

}  // namespace

void recordTouches(const std::filesystem::path& file, const std::optional<Lie>& lie) {
  constexpr std::uint64_t seed = 3;
  const SmallScene scene = smallScene();
  const std::unique_ptr<SampleSource> source = performer(scene, "skilled", seed);
  AttemptSettings settings;
  settings.seed = seed;
  RecordingWriter writer(file, makeHeader(*scene.model, scene.assets, source->provenance(), settings));
  SerialExecutor executor;
  Session session(*scene.model, seed, executor);
  Liar liar(writer, scene.model->layout(), lie);
  session.join(liar);
  RunSettings run;
  run.seconds = 2.1;
  EXPECT_EQ(runAttempt(session, *source, run).outcome, Outcome::stopped);
  writer.finish();
}

}  // namespace calot::recorder::test
