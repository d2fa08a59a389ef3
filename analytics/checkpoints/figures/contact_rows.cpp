// SPDX-License-Identifier: GPL-3.0-or-later
// Times that instruments touch structures, or each other, in both readings of several at once: the paper's duct time
// exceeds its task time, so it cannot be a union.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"

namespace calot::analytics {
namespace {

/// Time with each organ, vessel and body of fat.
struct ContactTime {
  const AttemptContext& context;
  bool sum;
  std::vector<std::uint64_t> steps = std::vector<std::uint64_t>(context.structures.size());

  void add(const StepResult& result) {
    for (std::size_t o = 0; o < steps.size(); ++o) {
      std::uint64_t touching = 0;
      for (const HandResult& hand : result.hand) touching += hand.contacts() >> o & 1U;
      steps[o] += sum ? touching : std::min<std::uint64_t>(touching, 1);
    }
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t o) const {
    return Measured::of(context.seconds(steps[o]), stretchNote(end));
  }
};

/// Tissue held in jaws: for how long, and how hard it was squeezed.
struct Holding {
  const AttemptContext& context;
  bool dose;
  std::vector<double> sum = std::vector<double>(context.structures.size());

  void add(const StepResult& result) {
    for (const HandResult& hand : result.hand) {
      for (std::size_t s = 0; s < sum.size(); ++s) {
        if ((hand.grasping >> s & 1U) != 0) sum[s] += dose ? hand.gripForce : 1.0;
      }
    }
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t s) const {
    return Measured::of(sum[s] * context.stepSeconds(), stretchNote(end));
  }
};

/// Time at whose steps' ends instruments touch or hold some of a scene's vessels.
class VesselContact {
 public:
  /// @param sum over instruments and vessels: two at once count twice; else any instrument on any of the vessels
  VesselContact(const AttemptContext& context, bool SceneFacts::Vessel::*chosen, bool sum)
      : context_(context), sum_(sum) {
    const std::vector<SceneFacts::Vessel>& vessels = context.scene.vessel;
    for (std::size_t v = 0; v < vessels.size(); ++v) {
      if (vessels[v].*chosen)
        vessel_.push_back({std::uint32_t{1} << (context.scene.organ.size() + v), vessels[v].name, 0});
    }
  }

  void add(const StepResult& result) {
    bool any = false;
    for (const HandResult& hand : result.hand) {
      for (Vessel& vessel : vessel_) {
        if ((hand.contacts() & vessel.bit) == 0) continue;
        ++vessel.steps;
        any = true;
      }
    }
    united_ += any ? 1 : 0;
  }
  /// The note of a sum lists the vessels' parts: "cystic-duct 0.50 s, cystic-artery 0.25 s".
  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    const std::string stretch = stretchNote(end);
    if (!sum_) return Measured::of(context_.seconds(united_), stretch);
    std::uint64_t steps = 0;
    std::string parts;
    for (const Vessel& vessel : vessel_) {
      steps += vessel.steps;
      parts += fmt::format("{}{} {:.2f} s", parts.empty() ? "" : ", ", vessel.name, context_.seconds(vessel.steps));
    }
    return Measured::of(context_.seconds(steps), parts + (stretch.empty() ? "" : "; ") + stretch);
  }

 private:
  struct Vessel {
    std::uint32_t bit = 0;  ///< of HandResult::contacts()
    std::string name;
    std::uint64_t steps = 0;  ///< over both hands
  };
  const AttemptContext& context_;
  bool sum_;
  std::vector<Vessel> vessel_;
  std::uint64_t united_ = 0;
};

/// How often, and for how long, one instrument touched the other.
struct InstrumentClashes {
  const AttemptContext& context;
  bool time;
  bool two = false;
  std::uint64_t touches = 0, steps = 0;

  void add(const StepResult& result) {
    two =
        two || (result.hand[0].instrument != InstrumentKind::none && result.hand[1].instrument != InstrumentKind::none);
    steps += result.contact.instrumentsTouch ? 1 : 0;
    for (const Event& event : result.events) touches += event.kind == EventKind::instrumentsTouched ? 1 : 0;
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    if (!two) return Measured::notApplicable("there were never two instruments");
    if (!time) return Measured::of(static_cast<double>(touches));
    return Measured::of(context.stepSeconds() * static_cast<double>(steps), stretchNote(end));
  }
};

}  // namespace

std::vector<CheckpointEntry> contactRows() {
  const CheckpointEntry cystic{
      .place = {CheckpointFamily::paper, 60, "cystic"},
      .definition = {.name = "cystic-contact-time",
                     .title = "Time colliding with cystic duct and artery",
                     .unit = "s",
                     .direction = Direction::lower,
                     .instruments = "sum over instruments and over the vessels: two at once count twice",
                     .version = 2,
                     .definition =
                         "C = step length * sum over instruments and cystic vessels #{steps at whose end the one "
                         "exerts a force on the other or holds it}; cystic: of role cystic-duct or cystic-artery",
                     .paperReading =
                         "Time colliding cystic ducts (s), in its text \"collision time with the cystic duct and "
                         "artery\": both vessels; 41.57 s in a task of 38.86 s can only be a sum over vessels or "
                         "instruments, and this is the sum over both"},
      .needs = {hasCystic},
      .results = 3,
      .accumulate = accumulating<VesselContact>(&SceneFacts::Vessel::cystic, true)};
  return {
      cystic,
      phaseRow(cystic, 140, "steps", accumulating<PerPhase<VesselContact>>(&SceneFacts::Vessel::cystic, true), 2),
      {.place = {CheckpointFamily::contact, 10},
       .definition = {.name = "contact-time-union",
                      .title = "Contact time with the organ (any instrument)",
                      .unit = "s",
                      .aggregation = Aggregation::organ,
                      .instruments = "union over instruments: two at once count once",
                      .version = 2,
                      .definition = "C_union(o) = step length * #{steps at whose end any instrument exerts a force on "
                                    "organ o or holds it}"},
       .accumulate = accumulating<ContactTime>(false)},
      {.place = {CheckpointFamily::contact, 20},
       .definition = {.name = "contact-time-sum",
                      .title = "Contact time with the organ (summed over instruments)",
                      .unit = "s",
                      .aggregation = Aggregation::organ,
                      .instruments = "sum over instruments: two at once count twice",
                      .version = 2,
                      .definition = "C_sum(o) = step length * sum over instruments #{steps at whose end it exerts a "
                                    "force on organ o or holds it}"},
       .accumulate = accumulating<ContactTime>(true)},
      {.place = {CheckpointFamily::contact, 23},
       .definition = {.name = "time-held",
                      .title = "Time that jaws held the organ",
                      .unit = "s",
                      .aggregation = Aggregation::organ,
                      .instruments = "sum over instruments: two at once count twice",
                      .definition = "H(o) = step length * sum over instruments #{steps at whose end its jaws hold "
                                    "organ o}"},
       .results = 2,
       .accumulate = accumulating<Holding>(false)},
      {.place = {CheckpointFamily::contact, 26},
       .definition = {.name = "crush-dose",
                      .title = "Crush dose of the organ",
                      .unit = "N s",
                      .direction = Direction::lower,
                      .aggregation = Aggregation::organ,
                      .instruments = "sum over instruments",
                      .definition = "D(o) = step length * sum over instruments and steps of the grip force, while its "
                                    "jaws hold organ o"},
       .results = 5,
       .accumulate = accumulating<Holding>(true)},
      {.place = {CheckpointFamily::contact, 30},
       .definition = {.name = "spared-contact-time-union",
                      .title = "Time touching a vessel that is to be spared (any instrument)",
                      .unit = "s",
                      .direction = Direction::lower,
                      .instruments = "union over instruments and over the vessels: two at once count once",
                      .version = 2,
                      .definition = "step length * #{steps at whose end any instrument exerts a force on, or holds, "
                                    "any vessel that the scene's procedure tells to spare}"},
       .needs = {hasProcedure, hasSpared},
       .results = 3,
       .accumulate = accumulating<VesselContact>(&SceneFacts::Vessel::spared, false)},
      {.place = {CheckpointFamily::contact, 40},
       .definition = {.name = "spared-contact-time-sum",
                      .title = "Time touching vessels that are to be spared (summed over instruments)",
                      .unit = "s",
                      .direction = Direction::lower,
                      .instruments = "sum over instruments and over the vessels: two at once count twice",
                      .version = 2,
                      .definition = "step length * sum over instruments and vessels that the scene's procedure tells "
                                    "to spare #{steps at whose end the one exerts a force on the other or holds it}"},
       .needs = {hasProcedure, hasSpared},
       .results = 3,
       .accumulate = accumulating<VesselContact>(&SceneFacts::Vessel::spared, true)},
      {.place = {CheckpointFamily::contact, 41},
       .definition = {.name = "instrument-clashes",
                      .title = "Times that the instruments touched each other",
                      .direction = Direction::lower,
                      .instruments = "both together",
                      .domain = Domain::whole,
                      .definition = "#{touches of both instruments}; contact that is interrupted for less than 0.1 s "
                                    "is one touch"},
       .results = 6,
       .accumulate = accumulating<InstrumentClashes>(false)},
      {.place = {CheckpointFamily::contact, 42},
       .definition = {.name = "instrument-clash-time",
                      .title = "Time that the instruments touched each other",
                      .unit = "s",
                      .direction = Direction::lower,
                      .instruments = "both together",
                      .definition = "step length * #{steps in which the instruments exert a force on each other}"},
       .results = 6,
       .accumulate = accumulating<InstrumentClashes>(true)},
  };
}

}  // namespace calot::analytics
