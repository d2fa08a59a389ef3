// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/scene_view.h"

#include <utility>

#include "sim/math/elementary.h"
#include "sim/scene/stepper.h"
#include "sim/vessel/centre_line.h"
#include "sim/vessel/clips.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

namespace {

/// Rounder and smoother than contact has it.
constexpr TubeSurface::Settings pictureTube{16, 2};

void addVessels(const Model& model, const State& state, SceneView& view) {
  for (const StructureModel& structure : model.structures()) {
    if (structure.kind != StructureKind::vessel) continue;
    const VesselTree& tree = model.vesselTrees()[structure.index];
    const BeamState& vessels = state.vessel[structure.index];
    TubeSurface tube(tree.beams, structure.branch, pictureTube);
    tube.update(vessels);
    SurfaceView surface;
    surface.organ = structure.name;
    surface.appearance = structure.appearance;
    tube.place(vessels, surface.position);
    BeamState rest = restState(tree.beams);
    rest.parting = vessels.parting;
    rest.partedAt = vessels.partedAt;
    tube.place(rest, surface.rest);
    surface.triangle = tube.triangles();
    const double through = model.scene().vessels[tree.vessel[structure.branch]].burnThrough;
    bool anywhere = false;
    for (std::size_t v = 0; v < tube.vertices(); ++v) {
      const double exposure = vessels.exposure[tube.where(static_cast<int>(v)).element];
      anywhere = anywhere || exposure > 0.0;
      surface.charred.push_back(static_cast<float>(exposure / through));
    }
    if (!anywhere) surface.charred.clear();
    view.surface.push_back(std::move(surface));
  }
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    const BeamModel& beams = model.vesselTrees()[t].beams;
    const BeamState& vessels = state.vessel[t];
    for (std::size_t c = 0; c < vessels.clips(); ++c) {
      const BeamPlace where = placeAt(beams, vessels.clipBranch[c], vessels.clipPlace[c]);
      const Pose frame = centreLine(beams, vessels, where, stumpAt(vessels, where));
      ClipView clip;
      const double half = 0.5 * vessels.clipRoll[c];
      clip.pose = {frame.position, frame.orientation * Quat(cosine(half), 0.0, 0.0, sine(half))};
      clip.width = vessels.clipWidth[c];
      clip.legs = model.scene().clip.legs;
      clip.halfGap = pinchedSection(beams.branches()[where.branch].section, vessels.clipClosure[c]).thin;
      view.clip.push_back(clip);
    }
  }
}

}  // namespace

SceneView viewOf(const Model& model, const State& state) {
  SceneView view;
  view.step = state.clock.step;
  view.time = static_cast<double>(state.clock.step) * model.stepSeconds();
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    const OrganModel& organ = model.organs()[o];
    SurfaceView surface;
    surface.organ = organ.name;
    surface.appearance = organ.appearance;
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
  addVessels(model, state, view);
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
