// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/surfaces.h"

#include "sim/geometry/closest_point.h"
#include "sim/math/floating_point.h"
#include "sim/step/body.h"

namespace calot {

Surfaces::Surfaces(const Model& model, Bodies& bodies, MakeBroadPhase make, Executor& executor)
    : model_(model), executor_(executor) {
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
  earlierBounds_.resize(structures);
  changed_.resize(structures);
  invalidate();
}

void Surfaces::invalidate() {
  current_.assign(size(), 0);
  refittable_.assign(size(), 0);
}

void Surfaces::markBodyStale(std::size_t body) {
  for (std::size_t s = 0; s < size(); ++s) {
    if (model_.structures()[s].body == body) current_[s] = 0;
  }
}

void Surfaces::refresh(const State& state) {
  stale_.clear();
  for (std::size_t s = 0; s < size(); ++s) {
    if (current_[s] == 0) stale_.push_back(s);
  }
  executor_.run(stale_.size(), [&](std::size_t i) {
    const FloatingPointScope scope;
    refresh(state, stale_[stale_.size() - 1 - i]);  // fat, the largest, first
  });
}

void Surfaces::refresh(const State& state, std::size_t s) {
  if (skin_[s]->follow(state)) refittable_[s] = 0;
  skin_[s]->place(state, points_[s]);
  earlierBounds_[s].swap(bounds_[s]);
  patchBounds(skin_[s]->surface(), points_[s], 0.0, bounds_[s]);
  if (earlierBounds_[s].size() == bounds_[s].size() && refittable_[s] != 0) {
    changedBounds(earlierBounds_[s], bounds_[s], changed_[s]);
    broad_[s]->refit(bounds_[s], changed_[s]);
  } else {
    broad_[s]->update(bounds_[s]);
  }
  refittable_[s] = 1;
  current_[s] = 1;
}

std::span<const std::uint32_t> Surfaces::patchesNear(std::size_t structure, const Vec3& p0, const Vec3& p1, double far,
                                                     Search& search) const {
  Box box;
  box.include(p0);
  box.include(p1);
  box.grow(far);
  broad_[structure]->pairs({&box, 1}, search.pair);
  search.near.clear();
  for (const BroadPhase::Pair& p : search.pair) {
    // The box of an oblique shaft holds much that is not near it.
    const Box& patch = bounds_[structure][p.leaf];
    const Vec3 middle = 0.5 * (patch.lower + patch.upper);
    const Vec3 onAxis = p0 + closestOnSegment(middle, p0, p1) * (p1 - p0);
    const double radius = far + 0.5 * (patch.upper - patch.lower).norm();
    if ((middle - onAxis).squaredNorm() <= radius * radius * (1.0 + 1e-9)) search.near.push_back(p.leaf);
  }
  return search.near;
}

}  // namespace calot
