// SPDX-License-Identifier: GPL-3.0-or-later
// Loads that carry the weight where the scene is drawn.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/scene/model.h"
#include "sim/scene/weight_system.h"
#include "sim/vessel/beam_preload.h"

namespace calot {

void Model::carryWeight() {
  held_.assign(bodies(), true);
  if (scene_.gravity.isZero(0.0)) return;
  const WeightMotion x = motionUnderWeight(*this);
  held_ = x.held;
  const std::size_t firstVessel = organs().size();
  const std::size_t firstFat = firstVessel + vesselTrees().size();
  for (std::size_t o = 0; o < firstVessel; ++o) organModel[o].solid.preload(x.displacement[o]);
  for (std::size_t t = 0; t < vesselTrees().size(); ++t) {
    preload(vesselTree[t].beams, x.displacement[firstVessel + t], x.rotation[firstVessel + t]);
  }
  for (std::size_t f = 0; f < fat().size(); ++f) fatModel[f]->preload(x.displacement[firstFat + f]);
  for (Tie& tie : tie_) {
    const Vec3 ahead = tie.place[0].of(x.displacement[tie.body[0]]) - tie.place[1].of(x.displacement[tie.body[1]]);
    if (tie.body[0] < firstVessel) {
      tie.offset += ahead;
      continue;
    }
    const BeamModel& beams = vesselTrees()[tie.body[0] - firstVessel].beams;
    tie.offset += beams.restOrientation()[static_cast<std::size_t>(tie.place[0].node[0])].conjugate() * ahead;
  }
  for (ConnectiveModel& connective : connectiveModel) {
    connective.tissue.preload(x.displacement[connective.a], x.displacement[connective.b]);
  }
}

}  // namespace calot
