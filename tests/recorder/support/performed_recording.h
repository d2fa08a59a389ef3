// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/performer.h"

namespace calot::recorder::test {

/// Records the skilled performer in a shipped scene, minimally. @param seconds of attempt time; 0: until it is done
inline void recordSkilled(const std::filesystem::path& file, const std::string& scene, std::uint64_t seed,
                          double seconds) {
  const std::filesystem::path assets = std::filesystem::path(CALOT_SOURCE_DIR) / "assets";
  LoadedScene loaded = loadScene(assets / "scenes" / (scene + ".json"));
  PreparedScene prepared(loaded.assets, Where{scene});
  const auto source = makePerformer(loadPerformer(assets / "performers/skilled.json"), prepared.model().scene(), seed);
  AttemptSettings settings;
  settings.seed = seed;
  settings.purpose = "golden";
  RecordingWriter writer(file, makeHeader(prepared.model(), std::move(loaded.assets), source->provenance(), settings),
                         {true});
  SerialExecutor executor;
  Session session(prepared.model(), seed, executor, prepared.services());
  session.join(writer);
  RunSettings run;
  run.seconds = seconds;
  static_cast<void>(runAttempt(session, *source, run));
  writer.finish();
}

}  // namespace calot::recorder::test
