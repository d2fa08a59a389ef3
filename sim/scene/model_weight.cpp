// SPDX-License-Identifier: GPL-3.0-or-later
// Loads that carry the weight where the scene is drawn.
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/scene/model.h"
#include "sim/scene/weight_system.h"
#include "sim/vessel/beam_preload.h"

#include <algorithm>
#include <vector>

namespace calot {

namespace {

std::vector<Vec3> times(double factor, std::vector<Vec3> values) {
  for (Vec3& v : values) v *= factor;
  return values;
}

}  // namespace

void Model::carryWeight() {
  held_.assign(bodies(), true);
  if (scene_.gravity.isZero(0.0)) return;
  const WeightMotion x = motionUnderWeight(*this);
  held_ = x.held;
  const std::size_t firstVessel = organs().size();
  const std::size_t firstFat = firstVessel + vesselTrees().size();
  const auto loads = [&](std::size_t body) { return times(x.stiffening[body], x.displacement[body]); };
  const auto ofJoint = [&](std::size_t a, std::size_t b) { return std::min(x.stiffening[a], x.stiffening[b]); };
  for (std::size_t o = 0; o < firstVessel; ++o) organModel[o].solid.preload(loads(o));
  for (std::size_t t = 0; t < vesselTrees().size(); ++t) {
    const std::size_t body = firstVessel + t;
    preload(vesselTree[t].beams, loads(body), times(x.stiffening[body], x.rotation[body]));
  }
  for (std::size_t f = 0; f < fat().size(); ++f) fatModel[f]->preload(loads(firstFat + f));
  for (Tie& tie : tie_) {
    const Vec3 apart = tie.place[0].of(x.displacement[tie.body[0]]) - tie.place[1].of(x.displacement[tie.body[1]]);
    const Vec3 ahead = ofJoint(tie.body[0], tie.body[1]) * apart;
    if (tie.body[0] < firstVessel) {
      tie.offset += ahead;
      continue;
    }
    const BeamModel& beams = vesselTrees()[tie.body[0] - firstVessel].beams;
    tie.offset += beams.restOrientation()[static_cast<std::size_t>(tie.place[0].node[0])].conjugate() * ahead;
  }
  for (ConnectiveModel& connective : connectiveModel) {
    const double factor = ofJoint(connective.a, connective.b);
    connective.tissue.preload(times(factor, x.displacement[connective.a]), times(factor, x.displacement[connective.b]));
  }
}

}  // namespace calot
