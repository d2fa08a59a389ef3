// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/hand_haptics.h"

#include "sim/scene/measurement.h"

namespace calot {

HapticState initialHaptics(const State& state, std::size_t hand) {
  HapticState haptics;
  haptics.tip = state.hand[hand].realPosition;
  haptics.orientation = state.hand[hand].realOrientation;
  return haptics;
}

void takeSample(const Model& model, std::size_t hand, const InstrumentSample& sample, HapticState& haptics) {
  if (!isMeasurement(sample)) return;
  const Pose pose = realPose(model.scene(), hand, sample, haptics.tip);
  haptics.tip = pose.position;
  haptics.orientation = pose.orientation;
}

HapticModel hapticModel(const Model& model, std::size_t hand) {
  const HandDescription& description = model.scene().hands[hand];
  HapticModel haptics;
  haptics.maxForce = description.maxForce;
  haptics.maxStretch = description.maxForce / description.couplingStiffness;
  haptics.ticksPerStep = model.scene().ticksPerStep;
  haptics.port = {description.port, axisOf(description.port, description.home), description.trocarFriction,
                  description.wallStiffness, description.couplingStiffness};
  return haptics;
}

}  // namespace calot
