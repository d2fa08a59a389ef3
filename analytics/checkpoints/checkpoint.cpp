// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

namespace calot::analytics {

std::string nameOf(Direction direction) {
  switch (direction) {
    case Direction::none:
      return "none";
    case Direction::lower:
      return "lower";
    case Direction::higher:
      return "higher";
  }
  return "unknown";
}

std::string nameOf(Origin origin) {
  switch (origin) {
    case Origin::resimulated:
      return "re-simulated";
    case Origin::observables:
      return "observables";
    case Origin::samples:
      return "samples";
    case Origin::external:
      return "external";
  }
  return "unknown";
}

std::string nameOf(Aggregation aggregation) {
  switch (aggregation) {
    case Aggregation::attempt:
      return "attempt";
    case Aggregation::hand:
      return "hand";
    case Aggregation::organ:
      return "organ";
    case Aggregation::phase:
      return "phase";
    case Aggregation::handAndPhase:
      return "hand and phase";
  }
  return "unknown";
}

std::string nameOf(Finality finality) { return finality == Finality::running ? "running" : "final"; }

std::string nameOf(Availability availability) {
  switch (availability) {
    case Availability::value:
      return "value";
    case Availability::notApplicable:
      return "not applicable";
    case Availability::notAvailable:
      return "not available";
    case Availability::absentHand:
      return "absent hand";
    case Availability::tooLittleCoverage:
      return "too little coverage";
  }
  return "unknown";
}

std::string nameOf(CheckpointFamily family) {
  switch (family) {
    case CheckpointFamily::paper:
      return "Table 2";
    case CheckpointFamily::motion:
      return "motion";
    case CheckpointFamily::phases:
      return "phases";
    case CheckpointFamily::contact:
      return "contact and force";
    case CheckpointFamily::safety:
      return "errors and safety";
    case CheckpointFamily::exactness:
      return "exactness of the simulation";
  }
  return "unknown";
}

void Checkpoint::onStep(const recorder::StepRecord& /*record*/, const Judgement& /*judgement*/) {}

std::string whyTooOld(const AttemptContext& context, std::uint32_t needed) {
  if (context.resultVersion >= needed) return {};
  return fmt::format("results of version {} do not tell of it", context.resultVersion);
}

std::string coverageText(const CheckpointDefinition& definition) {
  if (definition.minCoverage <= 0.0) return {};
  return fmt::format("at least {:g} % of the window", 100.0 * definition.minCoverage);
}

std::string stretchNote(const AttemptEnd& end) {
  return end.stretched > 0.0 ? fmt::format("tick clock stretched by {:.3f} s", end.stretched) : std::string();
}

CheckpointValue makeMissing(const CheckpointDefinition& definition, std::string subject, Origin origin,
                            Availability availability, std::string reason) {
  assert(availability != Availability::value && !reason.empty());
  CheckpointValue v;
  v.name = definition.name;
  v.subject = std::move(subject);
  v.version = definition.version;
  v.availability = availability;
  v.reason = std::move(reason);
  v.unit = definition.unit;
  v.origin = origin;
  v.filter = definition.filter;
  return v;
}

CheckpointValue makeValue(const CheckpointDefinition& definition, std::string subject, Origin origin, double value,
                          std::string note) {
  if (!std::isfinite(value)) {
    return makeMissing(definition, std::move(subject), origin, Availability::notAvailable, "the figure is not finite");
  }
  CheckpointValue v;
  v.name = definition.name;
  v.subject = std::move(subject);
  v.version = definition.version;
  v.value = value;
  v.note = std::move(note);
  v.unit = definition.unit;
  v.origin = origin;
  v.filter = definition.filter;
  return v;
}

}  // namespace calot::analytics
