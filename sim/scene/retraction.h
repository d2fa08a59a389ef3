// SPDX-License-Identifier: GPL-3.0-or-later
// An assistant's retraction: where its pull is, and how a request moves it.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/scene/description.h"

namespace calot {

/// What changes of a scene's retractions: one number of each. Places are shares of RetractionDescription::displacement;
/// each move runs from one share to another along a cubic that goes on from the speed at hand and ends at rest.
struct RetractionState {
  std::vector<double> from;   ///< share where the move began
  std::vector<double> speed;  ///< and its rate there (1/s)
  std::vector<double> goal;   ///< share where it ends
  std::vector<double> begun;  ///< when it began (s)
  std::vector<double> takes;  ///< how long it lasts (s), above 0

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("from", self.from);
    visit("speed", self.speed);
    visit("goal", self.goal);
    visit("begun", self.begun);
    visit("takes", self.takes);
  }
};

/// A retraction at one moment.
struct RetractionPlace {
  double share = 0.0;
  double rate = 0.0;  ///< of the share (1/s)
};

/// The pulls that the scene itself has: from nothing to the whole displacement.
RetractionState retractionsAtStart(const SceneDescription& scene);

/// One number of each retraction, and moves that take time?
bool fits(const SceneDescription& scene, const RetractionState& state);

/// @param which of the scene's retractions @param time of the attempt (s)
/// @pre fits(scene, state)
RetractionPlace retractionAt(const RetractionState& state, std::size_t which, double time);

/// Is it on its way?
bool isMoving(const RetractionState& state, std::size_t which, double time);

/// The trainee asks for one stage more, or less: the goal moves by RetractionDescription::stage within 0 and `most`,
/// and the pull sets out for it from where it is, at the mean speed of the scene's own pull. At a limit nothing
/// changes.
void askForRetraction(const RetractionDescription& of, std::size_t which, double time, bool more,
                      RetractionState& state);

}  // namespace calot
