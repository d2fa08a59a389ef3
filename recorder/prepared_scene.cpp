// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/prepared_scene.h"

#include <fmt/format.h>
#include <algorithm>
#include <future>
#include <list>
#include <utility>

#include "recorder/compliance_cache.h"
#include "recorder/engine/session.h"
#include "recorder/formats/scene_assets.h"
#include "recorder/kept/kept_engine.h"
#include "sim/scene/version.h"

namespace calot::recorder {

namespace {

/// Scenes that a process keeps: those of a study's tasks. An operation's takes some 40 MB.
constexpr std::size_t keptScenes = 4;
/// A file is rewritten for no fewer new columns than these, and than this share of all.
constexpr std::size_t fewColumns = 32;
constexpr std::size_t shareOfColumns = 20;

struct Known {
  std::mutex mutex;
  std::optional<ComplianceCache> cache;
  std::list<std::pair<std::string, std::shared_future<std::shared_ptr<PreparedScene>>>> scenes;  ///< newest first
};

Known& known() {
  static Known all;
  return all;
}

std::optional<ComplianceCache> cache() {
  const std::lock_guard lock(known().mutex);
  return known().cache;
}

}  // namespace

PreparedScene::PreparedScene(const std::vector<Asset>& assets, const Where& where) : key_(complianceKey(assets)) {
  LoadedScene scene = sceneFromAssets(assets);
  name_ = scene.description.name;
  Model::Built built = Model::build(std::move(scene.description));
  if (!built.model) throw Error(ErrorKind::damaged, where, built.error);
  model_ = std::move(built.model);
  if (const auto stored = cache()) {
    // A column of another length was not made of this Model.
    std::vector<ComplianceColumn> columns = stored->load(key_);
    const std::size_t organs = model_->organs().size();
    std::erase_if(columns, [&](const ComplianceColumn& c) {
      if (c.solid >= organs + model_->fat().size()) return true;
      const std::size_t nodes =
          c.solid < organs ? model_->organs()[c.solid].solid.nodes() : model_->fat()[c.solid - organs]->solid().nodes();
      return c.node >= nodes || c.value.size() != 9 * nodes;
    });
    compliances_.offer(std::move(columns));
  }
}

void PreparedScene::save() {
  const auto stored = cache();
  if (!stored) return;
  const std::lock_guard lock(saving_);
  const std::size_t computed = compliances_.computed();
  const std::size_t fresh = computed - saved_;
  if (fresh < fewColumns) return;
  const std::vector<ComplianceColumn> columns = compliances_.columns();
  if (fresh < columns.size() / shareOfColumns) return;
  if (stored->save(key_, name_, columns)) saved_ = computed;
}

std::shared_ptr<PreparedScene> prepareScene(const std::vector<Asset>& assets, const Where& where) {
  const std::string key = complianceKey(assets);
  std::promise<std::shared_ptr<PreparedScene>> promise;
  std::shared_future<std::shared_ptr<PreparedScene>> scene;
  {
    const std::lock_guard lock(known().mutex);
    auto& scenes = known().scenes;
    const auto at = std::find_if(scenes.begin(), scenes.end(), [&](const auto& s) { return s.first == key; });
    if (at != scenes.end()) {
      scenes.splice(scenes.begin(), scenes, at);
      scene = at->second;
    } else {
      scenes.emplace_front(key, promise.get_future().share());
      if (scenes.size() > keptScenes) scenes.pop_back();
    }
  }
  if (scene.valid()) {
    try {
      return scene.get();
    } catch (const Error&) {
      return std::make_shared<PreparedScene>(assets, where);  // throws the same of this one's own place
    }
  }
  try {
    auto made = std::make_shared<PreparedScene>(assets, where);
    promise.set_value(made);
    return made;
  } catch (...) {
    promise.set_exception(std::current_exception());
    const std::lock_guard lock(known().mutex);
    known().scenes.remove_if([&](const auto& s) { return s.first == key; });
    throw;
  }
}

std::shared_ptr<PreparedScene> sceneOf(const Recording& recording) {
  return prepareScene(recording.header().assets, Where{recording.path().string(), "/scene"});
}

void useComplianceCache(const std::optional<std::filesystem::path>& folder) {
  const std::lock_guard lock(known().mutex);
  known().cache.reset();
  if (folder) known().cache.emplace(*folder);
}

EngineChoice::EngineChoice(const Recording& recording, const EngineRequest& request)
    : header_(recording.header()),
      where_{recording.path().string(), "/scene"},
      makeBroadPhase_(request.makeBroadPhase) {
  const bool own = request.anyway || header_.simulationVersion == simulationVersion;
  version_ = own && request.file.empty() ? simulationVersion : header_.simulationVersion;
  if (!request.file.empty()) {
    command_ = commandOf(request.file);
  } else if (!own) {
    command_ = commandOfEngine(version_);
    if (command_.empty())
      throw Error(ErrorKind::undecided, Where{recording.path().string()},
                  fmt::format("recorded with simulation version {}, this build has {}, and no engine of version {} is "
                              "installed: cannot decide",
                              version_, simulationVersion, version_),
                  {Remedy::installEngine, Remedy::replayAnyway});
  } else if (!request.apart) {
    scene_ = sceneOf(recording);
  } else {
    if (enginePlaces().own.empty())
      throw Error(ErrorKind::failure, "calot-engine is not beside this program: nothing can be decided apart from it");
    command_ = {enginePlaces().own.string()};
  }
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
