// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/scene_choice.h"

#include "gui/words/problem_words.h"
#include "recorder/errors.h"
#include "recorder/formats/scene_file.h"

namespace calot::gui {

std::vector<SceneChoice> sceneChoices(const std::vector<std::filesystem::path>& roots,
                                      std::vector<std::string>& faults) {
  std::vector<SceneChoice> out;
  for (const std::filesystem::path& file : recorder::listScenes(roots)) {
    try {
      const recorder::LoadedScene scene = recorder::loadScene(file);
      out.push_back({scene.description.name, scene.summary, file});
    } catch (const Error& fault) {
      faults.emplace_back(problemText(fault));
    }
  }
  return out;
}

}  // namespace calot::gui
