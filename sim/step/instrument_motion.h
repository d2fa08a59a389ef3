// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 2 of a step: instruments follow the hands as far as free space reaches.
#pragma once

#include <span>

#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/state.h"
#include "sim/step/contact_block.h"
#include "sim/step/grasping.h"
#include "sim/step/instrument_clash.h"
#include "sim/step/step_log.h"
#include "sim/step/surfaces.h"

namespace calot {

/// Contacts nearer than this are watched even at rest (m). Larger: more rows of contact that stay open; smaller: a tip
/// that tissue moves towards is found late. Assumed: the way of tissue at 0.1 m/s in one step.
inline constexpr double contactMargin = 0.001;
/// Travel of a tip near a surface in one step (m). Larger: contact is linearised over more than the surface's curvature
/// allows; smaller: fast hands leave their instrument behind. Assumed: half an instrument's working end.
inline constexpr double maxSlide = 0.005;

/// Conservative advancement (Mirtich 1996): the simulated instrument goes towards the real one as far as free space
/// reaches, so that nothing is passed through on the way. What is left is the stretch of the virtual coupling; the jaws
/// go on by a little whether there is room or not, since a hand closes them. The other instrument bounds free space as
/// tissue does: the left one moves first, and each stops before where the other is at that time.
///
/// Reads: real poses, surfaces. Writes: simulated poses, jaws and grasps of the hands (jaws that open release before,
/// jaws that close grasp after the motion).
class InstrumentMotion {
 public:
  /// @param grasping outlives this
  InstrumentMotion(const Model& model, Grasping& grasping) : model_(model), grasping_(grasping) {}
  /// @pre surfaces are current
  InstrumentTravels run(Surfaces& surfaces, State& state, StepLog& log, ContactResult& contact);

 private:
  void advance(Surfaces& surfaces, std::size_t hand, State& state, InstrumentTravel& travel);
  double gapOf(Surfaces& surfaces, const State& state, std::size_t hand, double limit) const;

  const Model& model_;
  Grasping& grasping_;
  PlacedInstrument instrument_, other_;
};

// Stage 1 of a step: the newest measurement of each hand, and the newest camera.

/// Reads: the step's samples. Writes: each hand's real pose, jaw, buttons and mounted instrument, what is asked of the
/// assistant, the camera, and the digests of the samples as they came. A sample that is no measurement (isMeasurement)
/// changes nothing but is reported when it begins and when it ends.
class SampleStage {
 public:
  explicit SampleStage(const Model& model) : model_(model) {}
  /// @pre samples.size() == ticksPerStep
  void run(std::span<const TickSamples> samples, State& state, StepLog& log) const;

 private:
  void readHand(std::span<const TickSamples> samples, std::size_t hand, State& state, StepLog& log) const;
  void readRequests(std::span<const TickSamples> samples, std::size_t hand, State& state, StepLog& log) const;
  void askAssistant(std::size_t hand, bool more, State& state, StepLog& log) const;
  const Model& model_;
};

}  // namespace calot
