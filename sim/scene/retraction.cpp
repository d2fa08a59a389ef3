// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/retraction.h"

#include <algorithm>
#include <cmath>

#include "sim/math/bounds.h"

namespace calot {

RetractionState retractionsAtStart(const SceneDescription& scene) {
  RetractionState state;
  for (const RetractionDescription& d : scene.retraction) {
    state.from.push_back(0.0);
    state.speed.push_back(0.0);
    state.goal.push_back(1.0);
    state.begun.push_back(d.start);
    state.takes.push_back(d.duration);
  }
  return state;
}

bool fits(const SceneDescription& scene, const RetractionState& state) {
  const std::size_t count = scene.retraction.size();
  return state.from.size() == count && state.speed.size() == count && state.goal.size() == count &&
         state.begun.size() == count && state.takes.size() == count &&
         std::all_of(state.takes.begin(), state.takes.end(), [](double takes) { return takes > 0.0; });
}

RetractionPlace retractionAt(const RetractionState& state, std::size_t which, double time) {
  const double takes = state.takes[which];
  const double s = std::min(notNegative((time - state.begun[which]) / takes), 1.0);
  const double way = state.goal[which] - state.from[which];
  const double speed = state.speed[which];
  // Hermite's cubic from (from, speed) to (goal, 0).
  return {state.from[which] + way * (s * s * (3.0 - 2.0 * s)) + speed * takes * (s * (1.0 - s) * (1.0 - s)),
          way * (6.0 * s * (1.0 - s) / takes) + speed * ((1.0 - s) * (1.0 - 3.0 * s))};
}

bool isMoving(const RetractionState& state, std::size_t which, double time) {
  return time >= state.begun[which] && time < state.begun[which] + state.takes[which];
}

void askForRetraction(const RetractionDescription& of, std::size_t which, double time, bool more,
                      RetractionState& state) {
  const double goal = std::min(notNegative(state.goal[which] + (more ? of.stage : -of.stage)), of.most);
  if (goal == state.goal[which]) return;
  const RetractionPlace now = retractionAt(state, which, time);
  state.from[which] = now.share;
  state.speed[which] = now.rate;
  state.goal[which] = goal;
  state.begun[which] = std::max(time, of.start);
  state.takes[which] = of.duration * std::max(std::abs(goal - now.share), of.stage);
}

}  // namespace calot
