// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/model.h"

#include <utility>

#include "sim/math/floating_point.h"
#include "sim/scene/state.h"

namespace calot {

Model::Built Model::build(SceneDescription scene) {
  const FloatingPointScope floatingPoint;
  Built built;
  const std::size_t structures = scene.organs.size() + scene.vessels.size() + scene.fat.size();
  if (structures > maxStructures) {
    built.error = std::to_string(structures) + " structures (organs, vessels and bodies of fat); at most " +
                  std::to_string(maxStructures) + " are allowed";
    return built;
  }
  std::unique_ptr<Model> model(new Model);
  model->scene_ = std::move(scene);
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if (built.error.empty()) built.error = Kind::build(model->scene_, *model);
  });
  if (!built.error.empty()) return built;
  std::size_t firstBody = 0;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId kind) {
    Kind::listStructures(*model, kind, firstBody, model->structure_);
    firstBody += Kind::bodies(*model);
  });
  built.error = model->addProcedure(model->scene_);
  if (built.error.empty()) built.error = model->addRetractions(model->scene_);
  if (!built.error.empty()) return built;
  model->carryWeight();
  model->layout_ = digestLayout(*model);
  built.model = std::move(model);
  return built;
}

std::size_t Model::bodies() const {
  std::size_t count = 0;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) { count += Kind::bodies(*this); });
  return count;
}

std::size_t Model::structureNamed(const std::string& name) const {
  std::size_t s = 0;
  while (s < structure_.size() && structure_[s].name != name) ++s;
  return s;
}

}  // namespace calot
