// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/checkpoints/registry.h"

namespace calot::analytics {
namespace {

std::string firstObjection(const CheckpointEntry& entry, const AttemptContext& context) {
  for (const Requirement& need : entry.needs) {
    if (!need.met(context)) return need.otherwise;
  }
  return whyTooOld(context, entry.results);
}

std::vector<std::string> subjectsOf(const CheckpointEntry& entry, const AttemptContext& context) {
  if (entry.subjects != nullptr) return entry.subjects(context);
  std::vector<std::string> phases, handsInPhases;
  for (const Phase phase : windowPhases) {
    phases.emplace_back(nameOf(phase));
    for (std::size_t h = 0; h < handNames.size(); ++h) handsInPhases.push_back(handAndPhase(h, phase));
  }
  switch (entry.definition.aggregation) {
    case Aggregation::attempt:
      break;
    case Aggregation::hand:
      return {handNames.begin(), handNames.end()};
    case Aggregation::organ:
      return context.structures;
    case Aggregation::phase:
      return phases;
    case Aggregation::handAndPhase:
      return handsInPhases;
  }
  return {""};
}

}  // namespace

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

CheckpointDefinition completed(CheckpointDefinition definition) {
  const auto fill = [](std::string& text, const std::string& usual) {
    if (text.empty()) text = usual;
  };
  fill(definition.displayUnit, definition.unit);
  fill(definition.window, "whole attempt");
  fill(definition.instruments, "union over instruments");
  fill(definition.filter, "none");
  if (definition.origins.empty()) definition.origins = {Origin::resimulated, Origin::observables};
  return definition;
}

std::unique_ptr<Checkpoint> CheckpointEntry::make(const AttemptContext& context) const {
  return std::make_unique<Checkpoint>(*this, context);
}

Checkpoint::Checkpoint(const CheckpointEntry& entry, AttemptContext context)
    : entry_(entry),
      context_(std::move(context)),
      notApplicable_(firstObjection(entry, context_)),
      subjects_(subjectsOf(entry, context_)),
      accumulator_(notApplicable_.empty() ? entry.accumulate(context_) : nullptr) {}

void Checkpoint::onStep(const recorder::StepRecord& record, const Judgement& judgement) {
  if (accumulator_) accumulator_->add(record, judgement);
}

Measured Checkpoint::measured(const AttemptEnd& end, std::size_t subject) const {
  if (!accumulator_) return Measured::notApplicable(notApplicable_);
  if (isOfPhases(entry_.definition) && !entry_.ofAbsentPhases) {
    const std::size_t perPhase = subjects_.size() / windowPhases.size();
    if (!((*end.phases)[subject / perPhase].seconds > 0.0)) return Measured::notApplicable(noSuchPhase);
  }
  return accumulator_->figure(end, subject, entry_.definition);
}

std::vector<CheckpointValue> Checkpoint::values(const AttemptEnd& end) const {
  const CheckpointDefinition& d = entry_.definition;
  const Origin origin = d.origins == std::vector{Origin::samples} ? Origin::samples : end.origin;
  // Without phases there are no subjects either.
  if (!accumulator_ && isOfPhases(d)) return {makeMissing(d, "", origin, Availability::notApplicable, notApplicable_)};
  const double cutoff = end.motion[0] != nullptr ? end.motion[0]->cutoff : motionCutoff;
  std::vector<CheckpointValue> result;
  for (std::size_t s = 0; s < subjects_.size(); ++s) {
    const Measured m = measured(end, s);
    CheckpointValue& value = result.emplace_back(m.value ? makeValue(d, subjects_[s], origin, *m.value, m.note)
                                                         : makeMissing(d, subjects_[s], origin, m.missing, m.reason));
    if (cutoff != motionCutoff && d.filter == motionFilterText()) value.filter = motionFilterText(cutoff);
    value.coverage = m.coverage;
  }
  return result;
}

}  // namespace calot::analytics
