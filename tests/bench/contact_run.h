// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a motion with the haptic ticks inline and measures every step against deformation alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/haptics/haptic_tick.h"
#include "sim/step/stepper.h"
#include "tests/bench/touch_motion.h"

namespace calot::bench {

/// The peer: what the organs' motion costs where nothing touches. The same free motion to the scene's relative
/// tolerance, which holds for any scene and version: without its tolerance of speed.
class DeformationAlone {
 public:
  DeformationAlone(const Model& model, Executor& executor);
  /// @return iterations of the linear solves
  std::uint32_t step(std::vector<SolidState>& organ);

 private:
  const Model& model_;
  Executor& executor_;
  SolidSolver::Settings settings_;
  std::vector<SolidSolver> solver_;
};

/// One step: thread CPU time (s) and what it did.
struct StepCost {
  double whole = 0.0;        ///< ticks and step
  double ticks = 0.0;        ///< of both hands
  double deformation = 0.0;  ///< the peer, from the State in which the step began
  ContactResult contact;
  bool bothTouch = false;
  std::uint32_t iterations = 0;      ///< of the step's free motion
  std::uint32_t peerIterations = 0;  ///< of the peer's
};

class ContactRun {
 public:
  /// @param model outlives this
  explicit ContactRun(const Model& model);

  /// Works out the compliance of the skins ahead, as live runs do; otherwise that happens at first touches.
  /// @return what it took (s)
  double prepare();

  /// The whole motion from rest; steps from motion.approach on.
  std::vector<StepCost> run(const Motion& motion);

 private:
  const Model& model_;
  SerialExecutor executor_;
  Stepper stepper_;
  DeformationAlone peer_;
  std::array<HapticModel, handCount> haptic_;
};

}  // namespace calot::bench
