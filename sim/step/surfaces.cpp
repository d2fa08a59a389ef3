// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/surfaces.h"

#include "sim/geometry/closest_point.h"
#include "sim/step/body.h"

namespace calot {

Surfaces::Surfaces(const Model& model, Bodies& bodies, MakeBroadPhase make) : model_(model) {
  const std::size_t structures = model.structures().size();
  for (std::size_t s = 0; s < structures; ++s) {
    broad_.push_back(make != nullptr ? make() : std::make_unique<SortedGrid>(broadPhaseCell));
    const StructureModel& structure = model.structures()[s];
    switch (structure.kind) {
      case tissueId<OrganTissue>:
        skin_.push_back(std::make_unique<OrganSkin>(model, structure.index));
        break;
      case tissueId<VesselTissue>:
        skin_.push_back(std::make_unique<TubeSkin>(model, structure.index, structure.branch));
        break;
      case tissueId<FatTissue>:
        skin_.push_back(std::make_unique<FatSkin>(bodies.fat(structure.index)));
        break;
    }
  }
  points_.resize(structures);
  bounds_.resize(structures);
  invalidate();
}

void Surfaces::invalidate() {
  current_.assign(size(), false);
  refittable_.assign(size(), false);
}

void Surfaces::markBodyStale(std::size_t body) {
  for (std::size_t s = 0; s < size(); ++s) {
    if (model_.structures()[s].body == body) current_[s] = false;
  }
}

void Surfaces::refresh(const State& state) {
  for (std::size_t s = 0; s < size(); ++s) {
    if (current_[s]) continue;
    if (skin_[s]->follow(state)) refittable_[s] = false;
    skin_[s]->place(state, points_[s]);
    earlierBounds_.swap(bounds_[s]);
    patchBounds(skin_[s]->surface(), points_[s], 0.0, bounds_[s]);
    if (earlierBounds_.size() == bounds_[s].size() && refittable_[s]) {
      changedBounds(earlierBounds_, bounds_[s], changed_);
      broad_[s]->refit(bounds_[s], changed_);
    } else {
      broad_[s]->update(bounds_[s]);
    }
    refittable_[s] = true;
    current_[s] = true;
  }
}

std::span<const std::uint32_t> Surfaces::patchesNear(std::size_t structure, const Vec3& p0, const Vec3& p1,
                                                     double far) {
  Box box;
  box.include(p0);
  box.include(p1);
  box.grow(far);
  broad_[structure]->pairs({&box, 1}, pairs_);
  near_.clear();
  for (const BroadPhase::Pair& p : pairs_) {
    // The box of an oblique shaft holds much that is not near it.
    const Box& patch = bounds_[structure][p.leaf];
    const Vec3 middle = 0.5 * (patch.lower + patch.upper);
    const Vec3 onAxis = p0 + closestOnSegment(middle, p0, p1) * (p1 - p0);
    const double radius = far + 0.5 * (patch.upper - patch.lower).norm();
    if ((middle - onAxis).squaredNorm() <= radius * radius * (1.0 + 1e-9)) near_.push_back(p.leaf);
  }
  return near_;
}

}  // namespace calot
