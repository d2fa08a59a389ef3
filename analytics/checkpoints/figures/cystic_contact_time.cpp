// SPDX-License-Identifier: GPL-3.0-or-later
// Time of collision with cystic duct and artery, in the one reading under which the paper's figure is possible.
#include "analytics/checkpoints/checkpoint.h"

#include <utility>

#include "analytics/checkpoints/phases.h"
#include "analytics/checkpoints/vessel_contact.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& cysticContactTimeDefinition() {
  static const CheckpointDefinition d{
      .name = "cystic-contact-time",
      .title = "Time colliding with cystic duct and artery",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "sum over instruments and over the vessels: two at once count twice",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 2,
      .definition =
          "C = step length * sum over instruments and cystic vessels #{steps at whose end the one exerts a force on "
          "the "
          "other or holds it}; cystic: of role cystic-duct or cystic-artery",
      .paperReading =
          "Time colliding cystic ducts (s), in its text \"collision time with the cystic duct and artery\": "
          "both vessels; 41.57 s in a task of 38.86 s can only be a sum over vessels or instruments, and "
          "this is the sum over both",
  };
  return d;
}

bool isCystic(const SceneFacts::Vessel& vessel) { return vessel.cystic; }

std::string whyNoCystic(const AttemptContext& context, const VesselContact& contact) {
  return contact.anyVessel() ? whyTooOld(context, 3) : "the scene has no duct or artery that enters a gallbladder";
}

CheckpointValue cysticValueOf(const CheckpointDefinition& d, std::string subject, const VesselContact& contact,
                              const AttemptEnd& end) {
  std::string note = contact.parts();
  if (const std::string stretch = stretchNote(end); !stretch.empty()) note += "; " + stretch;
  return makeValue(d, std::move(subject), end.origin, contact.sum(), std::move(note));
}

class CysticContactTime final : public Checkpoint {
 public:
  explicit CysticContactTime(const AttemptContext& context)
      : contact_(context, isCystic), notApplicable_(whyNoCystic(context, contact_)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    contact_.add(record.result);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(cysticContactTimeDefinition(), "", end.origin, Availability::notApplicable, notApplicable_)};
    return {cysticValueOf(cysticContactTimeDefinition(), "", contact_, end)};
  }

 private:
  VesselContact contact_;
  std::string notApplicable_;
};

const CheckpointDefinition& cysticInPhases() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition phase = phaseDefinition(cysticContactTimeDefinition(), "steps");
    phase.version = judgedVersion(2);
    return phase;
  }();
  return d;
}

class PhaseCysticContactTime final : public Checkpoint {
 public:
  explicit PhaseCysticContactTime(const AttemptContext& context)
      : window_(windowPhases.size(), VesselContact(context, isCystic)), notApplicable_(whyNoPhases(context)) {
    if (notApplicable_.empty()) notApplicable_ = whyNoCystic(context, window_.front());
  }

  void onStep(const recorder::StepRecord& record, const Judgement& judgement) override {
    const std::size_t window = windowOf(judgement.phase);
    if (window < window_.size()) window_[window].add(record.result);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(cysticInPhases(), "", end.origin, Availability::notApplicable, notApplicable_)};
    std::vector<CheckpointValue> result;
    for (std::size_t w = 0; w < window_.size(); ++w) {
      const char* subject = nameOf(windowPhases[w]);
      result.push_back((*end.phases)[w].seconds > 0.0 ? cysticValueOf(cysticInPhases(), subject, window_[w], end)
                                                      : makeMissing(cysticInPhases(), subject, end.origin,
                                                                    Availability::notApplicable, noSuchPhase));
    }
    return result;
  }

 private:
  std::vector<VesselContact> window_;  ///< as windowPhases
  std::string notApplicable_;
};

}  // namespace

std::vector<CheckpointEntry> cysticContactTimeEntries() {
  return {{{CheckpointFamily::paper, 60, "cystic"},
           cysticContactTimeDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<CysticContactTime>(context);
           }},
          {{CheckpointFamily::phases, 140},
           cysticInPhases(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<PhaseCysticContactTime>(context);
           }}};
}

}  // namespace calot::analytics
