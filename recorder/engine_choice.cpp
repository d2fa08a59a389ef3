// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine_choice.h"

#include <fmt/format.h>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_assets.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/kept/engine_process.h"
#include "sim/scene/version.h"

namespace calot::recorder {

EngineChoice::EngineChoice(const Recording& recording, const EngineWish& wish)
    : header_(recording.header()), where_{recording.path().string(), "/scene"}, makeBroadPhase_(wish.makeBroadPhase) {
  if (!wish.file.empty()) {
    command_ = commandOf(wish.file);
    version_ = header_.simulationVersion;
    return;
  }
  const bool own = wish.anyway || header_.simulationVersion == simulationVersion;
  if (own && !wish.apart) {
    scene_ = sceneOf(recording);
    return;
  }
  if (own) {
    if (enginePlaces().own.empty())
      throw Error(ErrorKind::failure, "calot-engine is not beside this program: nothing can be decided apart from it");
    command_ = {enginePlaces().own.string()};
    version_ = simulationVersion;
    return;
  }
  version_ = header_.simulationVersion;
  command_ = commandOfEngine(version_);
  if (!command_.empty()) return;
  throw Error(ErrorKind::undecided, Where{recording.path().string()},
              fmt::format("recorded with simulation version {}, this build has {}, and no engine of version {} is "
                          "installed: cannot decide",
                          header_.simulationVersion, simulationVersion, header_.simulationVersion),
              {Remedy::installEngine, Remedy::replayAnyway});
}

std::unique_ptr<Engine> EngineChoice::make(Executor& executor) const {
  if (scene_) return std::make_unique<LocalEngine>(scene_->model(), executor, scene_->services(makeBroadPhase_));
  auto engine = std::make_unique<EngineProcess>(command_, version_);
  engine->load(header_, where_);
  return engine;
}

bool EngineChoice::fits(const DigestLayout& layout) const {
  if (!scene_) return true;
  const DigestLayout& own = scene_->model().layout();
  return layout.components == own.components && layout.fields.size() == own.fields.size();
}

std::string EngineChoice::nameFault() const {
  if (!scene_ || header_.simulationVersion != simulationVersion) return "";
  return recorder::nameFault(header_, scene_->model());
}

const SceneDescription& EngineChoice::scene() const {
  if (scene_) return scene_->model().scene();
  if (!description_) description_ = sceneFromAssets(header_.assets).description;
  return *description_;
}

void EngineChoice::save() const {
  if (scene_) scene_->save();
}

}  // namespace calot::recorder
