// SPDX-License-Identifier: GPL-3.0-or-later
// What SceneViewer puts together. Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/fat/fat_body.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"

namespace calot {

/// Vessels as surfaces, and the clips on them.
void addVessels(const Model& model, const State& state, SceneView& view);

/// One body of fat from view to view.
class FatViewer {
 public:
  explicit FatViewer(const FatModel& model);

  /// Fills in vertices, triangles and what the hook has seared; where nothing was carved since the last call, only
  /// the places are new.
  void fill(const FatState& state, SurfaceView& surface);

 private:
  struct Carrier {
    std::array<int, 8> node{};
    std::array<double, 8> share{};
  };

  [[nodiscard]] bool sameAsLast(const CarvedBricks& carved) const;
  void rebuild(const FatState& state);

  const FatModel& model_;
  FatBody body_;
  CarvedField uncarved_;
  CarvedBricks last_;
  bool made_ = false;
  FatPicture picture_;
  std::vector<Carrier> carrier_;  ///< per vertex
  std::vector<float> seared_;     ///< per vertex
};

}  // namespace calot
