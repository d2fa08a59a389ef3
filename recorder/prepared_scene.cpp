// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/prepared_scene.h"

#include <algorithm>
#include <future>
#include <list>
#include <utility>

#include "recorder/compliance_cache.h"
#include "recorder/formats/scene_assets.h"

namespace calot::recorder {

namespace {

/// Scenes that a process keeps: those of a study's tasks. An operation's takes some 40 MB.
constexpr std::size_t keptScenes = 4;
/// A file is written anew for no fewer new columns than these, and than this share of all.
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

}  // namespace calot::recorder
