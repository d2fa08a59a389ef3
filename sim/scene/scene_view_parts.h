// SPDX-License-Identifier: GPL-3.0-or-later
// What SceneViewer puts together. Internal to this folder.
#pragma once

#include <vector>

#include "sim/fat/fat_picture.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

/// The clips on all vessels.
void addClips(const Model& model, const State& state, SceneView& view);

/// One vessel from view to view.
class VesselViewer {
 public:
  /// @param structure of `model`, a vessel; both outlive this
  VesselViewer(const Model& model, const StructureModel& structure);

  /// Fills in all but name and appearance; places alone are worked out where nothing was parted since the last call.
  void fill(const State& state, SurfaceView& surface);

 private:
  void layRest(const BeamState& vessels);
  void addChar(const BeamState& vessels, SurfaceView& surface) const;

  const Model& model_;
  const StructureModel& structure_;
  const VesselTree& tree_;
  TubeSurface tube_;
  std::vector<Vec3> rest_;  ///< of the tube, with its partings
};

/// One body of fat from view to view.
class FatViewer {
 public:
  explicit FatViewer(const FatModel& model);

  /// Fills in vertices, triangles and what the hook has seared; where nothing was carved since the last call, only
  /// the places are new.
  void fill(const FatState& state, SurfaceView& surface);

 private:
  void sear();

  const FatModel& model_;
  CarvedField uncarved_;
  FatPicture picture_;
  std::vector<float> seared_;  ///< per vertex; empty: nothing is carved
};

}  // namespace calot
