// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/tissue_viewer.h"

namespace calot {

namespace {

class OrganViewer final : public TissueViewer {
 public:
  explicit OrganViewer(const Model& model) : model_(model) {}

  void addTo(SceneView& view, const State& state) override {
    for (std::size_t o = 0; o < model_.organs().size(); ++o) {
      const OrganModel& organ = model_.organs()[o];
      SurfaceView& surface = view.surface.emplace_back();
      surface.organ = organ.name;
      surface.appearance = organ.appearance;
      surface.role = model_.structures()[o].role;
      surface.rest = organ.skin;
      organ.embedding.map(state.organ[o].position, surface.position);
      surface.triangle = organ.surface.triangles();
      const CharState& charred = state.charred[o];
      if (!(charred.area > 0.0)) continue;
      const auto full = static_cast<float>(model_.scene().cautery.charTime);
      for (const float exposure : charred.exposure) surface.charred.push_back(exposure / full);
    }
  }

 private:
  const Model& model_;
};

}  // namespace

std::unique_ptr<TissueViewer> OrganTissue::makeViewer(const Model& model) {
  return std::make_unique<OrganViewer>(model);
}

}  // namespace calot
