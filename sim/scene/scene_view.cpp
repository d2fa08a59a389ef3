// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/scene_view.h"

#include <utility>

#include "sim/scene/scene_view_parts.h"
#include "sim/scene/scene_viewer.h"

namespace calot {

class SceneViewer::Fat : public FatViewer {
 public:
  using FatViewer::FatViewer;
};

class SceneViewer::Vessel : public VesselViewer {
 public:
  using VesselViewer::VesselViewer;
};

SceneViewer::SceneViewer(const Model& model) : model_(model) {
  for (const StructureModel& structure : model.structures())
    if (structure.kind == StructureKind::vessel) vessel_.push_back(std::make_unique<Vessel>(model, structure));
  for (const auto& fat : model.fat()) fat_.push_back(std::make_unique<Fat>(*fat));
}

SceneViewer::~SceneViewer() = default;

SceneView viewOf(const Model& model, const State& state) { return SceneViewer(model).view(state); }

SceneView SceneViewer::view(const State& state) {
  const Model& model = model_;
  SceneView view;
  view.step = state.clock.step;
  view.time = static_cast<double>(state.clock.step) * model.stepSeconds();
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    const OrganModel& organ = model.organs()[o];
    SurfaceView surface;
    surface.organ = organ.name;
    surface.appearance = organ.appearance;
    surface.role = model.structures()[o].role;
    surface.rest = organ.skin;
    organ.embedding.map(state.organ[o].position, surface.position);
    surface.triangle = organ.surface.triangles();
    const CharState& charred = state.charred[o];
    if (charred.area > 0.0) {
      const auto full = static_cast<float>(model.scene().cautery.charTime);
      for (const float exposure : charred.exposure) surface.charred.push_back(exposure / full);
    }
    view.surface.push_back(std::move(surface));
  }
  std::size_t vessel = 0;
  for (const StructureModel& structure : model.structures()) {
    if (structure.kind == StructureKind::organ) continue;
    SurfaceView surface;
    surface.organ = structure.name;
    surface.appearance = structure.appearance;
    surface.role = structure.role;
    if (structure.kind == StructureKind::vessel)
      vessel_[vessel++]->fill(state, surface);
    else
      fat_[structure.index]->fill(state.fat[structure.index], surface);
    view.surface.push_back(std::move(surface));
  }
  addClips(model, state, view);
  for (std::size_t c = 0; c < model.connective().size(); ++c) {
    const ConnectiveModel& tie = model.connective()[c];
    const ConnectiveState& tissue = state.connective[c];
    ConnectiveView connective;
    connective.name = tie.name;
    connective.condition = tissue.condition;
    connective.sheet = tie.tissue.sheets();
    for (const Strand& strand : tie.tissue.strands()) {
      connective.strand.push_back({strand.a.of(state.organ[tie.a].position), strand.b.of(state.organ[tie.b].position)});
    }
    for (const double alpha : tissue.alpha) connective.alpha.push_back(static_cast<float>(alpha));
    view.connective.push_back(std::move(connective));
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    InstrumentView& instrument = view.instrument[h];
    const HandDescription& description = model.scene().hands[h];
    instrument.kind = state.hand[h].instrument;
    instrument.pose = {state.hand[h].simulatedPosition, state.hand[h].simulatedOrientation};
    instrument.port = description.port;
    instrument.radius = description.shaftRadius;
    instrument.jaw = state.hand[h].jaw;
    instrument.touching = state.hand[h].touching != 0;
  }
  view.camera.position = state.camera.position;
  view.camera.orientation = state.camera.orientation;
  view.verticalFieldOfView = model.scene().verticalFieldOfView;
  return view;
}

}  // namespace calot
