// SPDX-License-Identifier: GPL-3.0-or-later
// Clips that an applier closed on nothing and lost. State counts what is left in the applier and knows nothing of where
// the others are: pictures show it.
#pragma once

#include <vector>

#include "sim/scene/description.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/step_result.h"

namespace calot::recorder {

/// Each falls freely from the applier's tip onto the surface below it, as that surface is in the picture, and lies flat
/// there. A function of the events and the view alone: nothing touches such a clip, and it moves with what it lies on.
/// Where no surface of the view is below it, it falls 25 cm: what is drawn around the scene may stop it on the way
/// (gui/render). It is closed on nothing, so its ClipView has no gap; a clip on a vessel has one.
class FallenClips {
 public:
  FallenClips(const ClipDescription& clip, double stepSeconds);

  /// Takes EventKind::clipDropped, and nothing else.
  void add(const Event& event);
  /// Appends to view.clip what was lost until then.
  void show(SceneView& view) const;

 private:
  struct Lost {
    double time = 0.0;        ///< s
    Vec3 p_W = Vec3::Zero();  ///< where (m)
  };
  ClipView clip_;  ///< its measures
  double stepSeconds_;
  std::vector<Lost> lost_;
};

}  // namespace calot::recorder
