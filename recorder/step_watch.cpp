// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/step_watch.h"

#include <fmt/format.h>

#include <algorithm>

namespace calot::recorder {

void StepMisses::add(std::uint32_t misses) {
  ++steps;
  any += misses != 0 ? 1U : 0U;
  solver += (misses & miss::solver) != 0 ? 1U : 0U;
  contact += (misses & miss::contact) != 0 ? 1U : 0U;
  heldBack += (misses & miss::speed) != 0 ? 1U : 0U;
}

void StepMisses::add(const StepMisses& other) {
  steps += other.steps;
  any += other.any;
  solver += other.solver;
  contact += other.contact;
  heldBack += other.heldBack;
}

std::string describe(const StepMisses& misses) {
  if (misses.any == 0) return {};
  return fmt::format("{} of {} steps missed a tolerance (solver {}, contact {}, held back {})", misses.any,
                     misses.steps, misses.solver, misses.contact, misses.heldBack);
}

void StepWatch::onStep(const StepRecord& record) {
  misses_.add(record.result.misses);
  if (ranAway_ || (record.result.misses & miss::runaway) == 0) return;
  ranAway_ = true;
  const std::vector<Event>& events = record.result.events;
  const auto at =
      std::find_if(events.begin(), events.end(), [](const Event& e) { return e.kind == EventKind::runaway; });
  if (at != events.end()) event_ = *at;
}

std::string StepWatch::fault(const Model& model) const {
  if (!event_) return {};
  return fmt::format(
      "step {}: the simulation of '{}' ran away ({:.3g} m/s); the attempt ends here, keep the recording to find out "
      "why",
      event_->step, model.structures()[event_->subject].name, event_->value);
}

}  // namespace calot::recorder
