// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "sim/carving/field_sample.h"
#include "sim/fat/fat_picture.h"
#include "sim/math/bounds.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/tissue_viewer.h"

namespace calot {

namespace {

/// What lies this far below the uncarved surface was laid bare by the hook, in cells: from, fully.
constexpr double bareFrom = 0.4;
constexpr double bareFully = 1.6;
/// Such tissue is seared, not charred through.
constexpr float searing = 0.3F;

/// One body of fat from view to view.
class FatView {
 public:
  explicit FatView(const FatModel& model);

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

FatView::FatView(const FatModel& model) : model_(model), uncarved_(model.field()), picture_(model) {}

void FatView::sear() {
  const BrickLattice& lattice = model_.lattice();
  seared_.clear();
  for (const Vec3& rest : picture_.rest()) {
    const Vec3 at = (rest - lattice.origin()) / lattice.cell();
    const double depth = -sampleField(uncarved_, at).value / lattice.cell();
    const double bare = std::min(notNegative((depth - bareFrom) / (bareFully - bareFrom)), 1.0);
    seared_.push_back(searing * static_cast<float>(bare));
  }
}

void FatView::fill(const FatState& state, SurfaceView& surface) {
  if (picture_.update(state.carved)) sear();
  surface.rest = picture_.rest();
  surface.triangle = picture_.triangles();
  if (!state.carved.brick.empty()) surface.charred = seared_;
  picture_.positions(state.solid.position, surface.position);
}

class FatViewer final : public TissueViewer {
 public:
  explicit FatViewer(const Model& model) : model_(model) {
    for (const auto& fat : model.fat()) fat_.push_back(std::make_unique<FatView>(*fat));
  }

  void addTo(SceneView& view, const State& state) override {
    for (std::size_t f = 0; f < fat_.size(); ++f) {
      const FatDescription& description = model_.scene().fat[f];
      SurfaceView& surface = view.surface.emplace_back();
      surface.organ = description.name;
      surface.appearance = description.appearance;
      surface.role = description.role;
      fat_[f]->fill(state.fat[f], surface);
    }
  }

 private:
  const Model& model_;
  std::vector<std::unique_ptr<FatView>> fat_;
};

}  // namespace

std::unique_ptr<TissueViewer> FatTissue::makeViewer(const Model& model) { return std::make_unique<FatViewer>(model); }

}  // namespace calot
