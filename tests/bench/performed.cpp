// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/performed.h"

#include <cstdint>
#include <memory>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "recorder/sources/performer.h"

namespace calot::bench {

Motion performed(const std::string& scene, double seconds) {
  constexpr std::uint64_t seed = 1;
  const std::string assets = CALOT_ASSETS;
  const std::unique_ptr<const Model> model =
      built(recorder::loadScene(assets + "/scenes/" + scene + ".json").description);
  const auto profile = recorder::loadPerformer(assets + "/performers/skilled.json");
  const auto performer = recorder::makePerformer(profile, model->scene(), seed);
  SerialExecutor executor;
  recorder::Session session(*model, seed, executor);
  if (performer->watcher() != nullptr) session.join(*performer->watcher());
  std::vector<TickSamples> samples(model->scene().ticksPerStep);
  std::vector<recorder::TickOutcome> ticks(samples.size());
  const auto end = static_cast<std::uint64_t>(seconds / tickLength);
  Motion motion;
  for (std::uint64_t tick = 0; tick < end;) {
    for (std::size_t i = 0; i < samples.size(); ++i, ++tick) {
      if (!performer->next(tick, samples[i])) return motion;
      ticks[i] = session.tick(samples[i]);
    }
    motion.step.push_back(samples);
    session.step(samples, ticks, 0.0F);
  }
  return motion;
}

}  // namespace calot::bench
