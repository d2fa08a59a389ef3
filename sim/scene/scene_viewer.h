// SPDX-License-Identifier: GPL-3.0-or-later
// From State to SceneView, frame after frame.
#pragma once

#include <memory>
#include <vector>

#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/structure.h"

namespace calot {

/// Makes views of one Model's States and keeps from one to the next what stays the same: the surface of fat, which is
/// rebuilt only where something was carved since the last view (or in full where the State went back), and
/// vessels at rest. What it returns depends on the State alone: viewOf() gives the same. Use it where frames follow
/// each other.
class SceneViewer {
 public:
  /// @param model outlives this
  explicit SceneViewer(const Model& model);
  ~SceneViewer();
  SceneViewer(const SceneViewer&) = delete;
  SceneViewer& operator=(const SceneViewer&) = delete;

  /// @pre the state is one of the model's
  [[nodiscard]] SceneView view(const State& state);

 private:
  const Model& model_;
  std::vector<std::unique_ptr<TissueViewer>> viewer_;  ///< per kind of tissue
};

/// Surfaces, instruments and camera of a State.
SceneView viewOf(const Model& model, const State& state);

}  // namespace calot
