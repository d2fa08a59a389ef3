// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/scene_view.h"

#include "sim/scene/scene_viewer.h"

namespace calot {

SceneViewer::SceneViewer(const Model& model) : model_(model) {
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) { viewer_.push_back(Kind::makeViewer(model)); });
}

SceneViewer::~SceneViewer() = default;

SceneView viewOf(const Model& model, const State& state) { return SceneViewer(model).view(state); }

SceneView SceneViewer::view(const State& state) {
  const Model& model = model_;
  SceneView view;
  view.step = state.clock.step;
  view.time = static_cast<double>(state.clock.step) * model.stepSeconds();
  for (const auto& viewer : viewer_) viewer->addTo(view, state);
  for (std::size_t h = 0; h < handCount; ++h) {
    InstrumentView& instrument = view.instrument[h];
    const HandDescription& description = model.scene().hands[h];
    instrument.kind = state.hand[h].instrument.kind;
    instrument.pose = {state.hand[h].instrument.position, state.hand[h].instrument.orientation};
    instrument.port = description.port;
    instrument.radius = description.shaftRadius;
    instrument.jaw = state.hand[h].instrument.jaw;
    instrument.touching = state.hand[h].touches.structures != 0;
  }
  view.camera.position = state.camera.position;
  view.camera.orientation = state.camera.orientation;
  view.verticalFieldOfView = model.scene().verticalFieldOfView;
  view.down = downOf(model.scene().gravity);
  return view;
}

}  // namespace calot
