// SPDX-License-Identifier: GPL-3.0-or-later
// Fat cleared, the gallbladder's bed dissected, and what was burned in doing so.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"
#include "sim/math/linear.h"

namespace calot::analytics {
namespace {

/// Share of all the fat, or of the bed, that is work enough for a ratio of damage to work.
constexpr double minWork = 0.01;
/// Sums of areas: what is attached beyond it is a strand.
constexpr double noShare = 1e-9;

constexpr Requirement hasBed{[](const AttemptContext& context) {
                               const auto& tissues = context.scene.connective;
                               return std::any_of(tissues.begin(), tissues.end(),
                                                  [](const auto& tissue) { return tissue.holdsGallbladder; });
                             },
                             "no connective tissue holds a gallbladder in this scene"};

/// How much of a quantity that only ever grows fell into one phase of the procedure.
class GrowthInPhase {
 public:
  explicit GrowthInPhase(Phase phase) : phase_(phase) {}

  /// @param total so far, after a step of the phase `now`.
  /// @param fromZero the quantity was 0 before the first step that is given; else what it was then is not known, and
  /// that step adds no growth.
  void add(Phase now, double total, bool fromZero) {
    if (!begun_) before_ = fromZero ? 0.0 : total;
    begun_ = true;
    if (now == phase_) growth_ += notNegative(total - before_);
    before_ = total;
  }
  [[nodiscard]] double growth() const { return growth_; }

 private:
  Phase phase_;
  bool begun_ = false;
  double before_ = 0.0;
  double growth_ = 0.0;
};

/// Area over all organs' skins, so far (m^2, in the reference configuration).
double charredArea(const StepResult& result) {
  double area = 0.0;
  for (const OrganResult& organ : result.organ) area += organ.charredArea;
  return area;
}

/// The connective tissues that hold a gallbladder, as one: the mean of their shares, each of its own bed's area (a
/// scene has one of them as a rule).
struct GallbladderBed {
  const AttemptContext& context;
  bool any = false;  ///< a step was taken
  double attached = 1.0, torn = 0.0;
  double freedArea = 0.0;  ///< that is not attached any more (m^2, in the reference configuration)

  void add(const StepResult& result) {
    const std::vector<SceneFacts::Connective>& tissues = context.scene.connective;
    double attachedSum = 0.0, tornSum = 0.0, beds = 0.0;
    freedArea = 0.0;
    for (std::size_t c = 0; c < tissues.size(); ++c) {
      if (!tissues[c].holdsGallbladder) continue;
      attachedSum += result.connective[c].attached;
      tornSum += result.connective[c].torn;
      freedArea += (1.0 - result.connective[c].attached) * tissues[c].area;
      beds += 1.0;
    }
    attached = attachedSum / beds;
    torn = tornSum / beds;
    any = true;
  }
  /// Area of all beds (m^2).
  [[nodiscard]] double area() const {
    double sum = 0.0;
    for (const SceneFacts::Connective& tissue : context.scene.connective)
      sum += tissue.holdsGallbladder ? tissue.area : 0.0;
    return sum;
  }
};

/// Connective tissue that remains once the gallbladder is off its bed: strands that tore instead of being
/// burned.
struct ConnectiveRemaining {
  const AttemptContext& context;
  GallbladderBed bed{context};

  void add(const StepResult& result) { bed.add(result); }
  [[nodiscard]] Measured figure() const {
    if (bed.attached > noShare) {
      return Measured::notAvailable(
          fmt::format("the gallbladder was not freed: {:.1f} % of its bed attached", bed.attached * 100.0));
    }
    return Measured::of(bed.torn);
  }
};

/// Connective tissue that was torn off rather than burned through, freed or not.
struct ConnectiveTorn {
  const AttemptContext& context;
  GallbladderBed bed{context};

  void add(const StepResult& result) { bed.add(result); }
  [[nodiscard]] Measured figure() const { return Measured::of(bed.torn); }
};

/// Charred area for each part of the bed that came free.
struct BurnPerBed {
  const AttemptContext& context;
  GallbladderBed bed{context};
  double charred = 0.0;  ///< m^2

  void add(const StepResult& result) {
    bed.add(result);
    charred = charredArea(result);
  }
  [[nodiscard]] Measured figure() const {
    const double freed = bed.any ? 1.0 - bed.attached : 0.0;
    if (freed < minWork) return Measured::notApplicable("less than 1 % of the bed came free");
    return Measured::of(charred / freed);
  }
};

struct BurnPerDissection {
  const AttemptContext& context;
  GallbladderBed bed{context};
  GrowthInPhase charred{Phase::dissection}, freed{Phase::dissection};

  void add(const recorder::StepRecord& record, const Judgement& judgement) {
    bed.add(record.result);
    charred.add(judgement.phase, charredArea(record.result), record.step == 0);
    freed.add(judgement.phase, bed.freedArea, record.step == 0);
  }
  [[nodiscard]] Measured figure() const {
    if (!(bed.area() > 0.0)) return Measured::notApplicable("the bed has no area");
    if (!(freed.growth() >= minWork * bed.area()))
      return Measured::notApplicable("less than 1 % of the bed came free in this phase");
    return Measured::of(charred.growth() / freed.growth());
  }
};

struct BurnPerFat {
  std::optional<double> whole;  ///< volume after the first step (m^3)
  GrowthInPhase charred{Phase::identification}, taken{Phase::identification};

  void add(const recorder::StepRecord& record, const Judgement& judgement) {
    double volume = 0.0;
    for (const FatResult& fat : record.result.fat) volume += fat.volume;
    if (!whole) whole = volume;
    charred.add(judgement.phase, charredArea(record.result), record.step == 0);
    taken.add(judgement.phase, *whole - volume, true);
  }
  [[nodiscard]] Measured figure() const {
    if (!(whole && *whole > 0.0 && taken.growth() >= minWork * *whole))
      return Measured::notApplicable("less than 1 % of the fat went in this phase");
    return Measured::of(charred.growth() / taken.growth());
  }
};

struct PhaseCharredArea {
  std::vector<GrowthInPhase> charred{windowPhases.begin(), windowPhases.end()};

  void add(const recorder::StepRecord& record, const Judgement& judgement) {
    const double area = charredArea(record.result);
    for (GrowthInPhase& phase : charred) phase.add(judgement.phase, area, record.step == 0);
  }
  [[nodiscard]] Measured figure(std::size_t window) const { return Measured::of(charred[window].growth()); }
};

/// Share of each organ's skin that cautery charred; the paper's table asks for liver and gallbladder in any scene.
constexpr StructureRole askedFor[] = {StructureRole::liver, StructureRole::gallbladder};

std::vector<std::string> burnedOrgans(const AttemptContext& context) {
  std::vector<std::string> names = organNames(context);
  for (const StructureRole role : askedFor) {
    const bool there = std::any_of(context.scene.organ.begin(), context.scene.organ.end(),
                                   [&](const SceneFacts::Organ& organ) { return organ.role == role; });
    if (!there) names.emplace_back(nameOf(role));
  }
  return names;
}

struct OrganBurned {
  const AttemptContext& context;
  std::string tooOld = whyTooOld(context, 3);
  std::vector<double> charred = std::vector<double>(context.scene.organ.size());  ///< m^2

  void add(const StepResult& result) {
    if (!tooOld.empty()) return;
    for (std::size_t o = 0; o < charred.size(); ++o) charred[o] = result.organ[o].charredArea;
  }
  [[nodiscard]] Measured figure(std::size_t o) const {
    if (o >= charred.size())
      return Measured::notApplicable(fmt::format("the scene has no {}", burnedOrgans(context)[o]));
    if (!tooOld.empty()) return Measured::notApplicable(tooOld);
    return Measured::of(charred[o] / context.scene.organ[o].skinArea);
  }
};

/// Fat that is left after identification: all of it (the paper's figure), and its two parts, which want opposite
/// things.
enum class Part : std::uint8_t { all, inside, outside };

struct FatRemaining {
  const AttemptContext& context;
  Part part;
  std::uint64_t steps = 0;
  bool fromStart = false, clipped = false;
  double first = 0.0;  ///< m^3
  double left = 0.0;   ///< when the window ended, or now
  double last = 0.0;   ///< now

  void add(const recorder::StepRecord& record) {
    double now = 0.0;
    for (const FatResult& fat : record.result.fat)
      now += part == Part::all ? fat.volume : part == Part::inside ? fat.toClear : fat.volume - fat.toClear;
    if (steps++ == 0) {
      fromStart = record.step == 0;
      first = now;
    }
    last = now;
    if (clipped) return;
    left = now;
    for (const VesselResult& vessel : record.result.vessel) clipped = clipped || vessel.clips > 0;
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    if (steps == 0) return Measured::notAvailable("no step yet");
    if (!fromStart) return Measured::notAvailable("the steps do not begin with the attempt's first");
    if (!(first > 0.0)) return Measured::notApplicable("there is no such fat at the start");
    const double share = left / first;
    std::string note;
    if (clipped) {
      // Later grasps are not part of identification, even if the operator returned to it.
      const double later = (left - last) / first;
      if (later > 0.0) note = fmt::format("{:.1f} % more were taken after the first clip", later * 100.0);
    } else if (end.outcome == recorder::Outcome::completed) {
      note = "no clip was set: at the end of the attempt";
    } else if (end.outcome != recorder::Outcome::running) {
      return Measured::notAvailable(
          fmt::format("identification was not finished: no clip was set, {:.1f} % left", share * 100.0));
    }
    return Measured::of(share, std::move(note));
  }
};

CheckpointEntry fatRow(int rank, std::string_view summaryTitle, const char* name, const char* title,
                       Direction direction, Part part, const char* formula, const char* paper = "") {
  return {
      .place = {CheckpointFamily::paper, rank, summaryTitle},
      .definition = {.name = name,
                     .title = title,
                     .displayUnit = "%",
                     .direction = direction,
                     .window = "from the first step to the end of the step that sets the first clip; without a clip, "
                               "to the end of a completed attempt",
                     .instruments = "union over instruments: what any of them took is gone",
                     .finality = Finality::final,
                     .definition = formula,
                     .paperReading = paper},
      .needs = part == Part::all ? std::vector{hasFat} : std::vector{hasFat, hasTriangle},
      .results = 3,
      .accumulate = accumulating<FatRemaining>(part)};
}

}  // namespace

std::vector<CheckpointEntry> dissectionRows() {
  return {
      fatRow(30, "fat", "fat-remaining", "Fat left after identification", Direction::none, Part::all,
             "F = V / V_0, V the volume of fat at rest at the end of the window, V_0 after the first step; all bodies "
             "of fat",
             "Remaining fat tissue (%): all fat, by volume, when the first clip ends identification; experts left "
             "more, though the task is to remove it, so this figure gets no direction and its two parts do"),
      fatRow(40, "in", "fat-remaining-inside", "Fat left inside the triangle after identification", Direction::lower,
             Part::inside,
             "F_in = T / T_0, T the volume of fat inside the scene's region to be cleared at the end of the window, "
             "T_0 after the first step"),
      fatRow(50, "out", "fat-remaining-outside", "Fat spared outside the triangle after identification",
             Direction::higher, Part::outside,
             "F_out = (V - T) / (V_0 - T_0): the share left of the fat outside the region to be cleared"),
      {.place = {CheckpointFamily::paper, 70, "connective"},
       .definition = {.name = "connective-remaining",
                      .title = "Connective tissue left after the gallbladder's removal",
                      .displayUnit = "%",
                      .direction = Direction::lower,
                      .window = "whole attempt, those in which the gallbladder came free only",
                      .instruments = "union over instruments: what any of them burned or tore",
                      .definition = "R = area of the bed under torn strands at the end / area of the whole bed, once "
                                    "no strand is attached any more; bed: connective tissue of role cystic-plate",
                      .paperReading = "Remaining connective tissue (%), in its text \"remaining connective tissue "
                                      "after the gallbladder removal\": what is neither burned away nor attached, as "
                                      "a share of the bed's initial area"},
       .needs = {hasBed},
       .results = 2,
       .accumulate = accumulating<ConnectiveRemaining>()},
      {.place = {CheckpointFamily::paper, 80, "burned"},
       .definition = {.name = "organ-burned",
                      .title = "Share of the organ burned",
                      .displayUnit = "%",
                      .direction = Direction::lower,
                      .aggregation = Aggregation::organ,
                      .instruments = "union over instruments: what any of them charred",
                      .version = 2,
                      .definition = "B(o) = area of the organ's skin that is charred / area of all its skin, both at "
                                    "rest",
                      .paperReading = "Amount of liver burned, amount of gallbladder burned (%): by area of the "
                                      "surface, not by volume; the whole organ's surface, not only what can be seen "
                                      "or reached"},
       .accumulate = accumulating<OrganBurned>(),
       .subjects = burnedOrgans},
      {.place = {CheckpointFamily::phases, 160},
       .definition = {.name = "phase-charred-area",
                      .title = "Area charred in the phase",
                      .displayUnit = "cm^2",
                      .direction = Direction::lower,
                      .window = "each phase of the procedure, as often as it recurs",
                      .aggregation = Aggregation::phase,
                      .instruments = "union over instruments: what any of them charred",
                      .version = judgedVersion(1),
                      .definition = "area of all organs' skins at rest that is charred in the steps of the phase"},
       .needs = {hasProcedure},
       .results = 3,
       .accumulate = accumulating<PhaseCharredArea>()},
      {.place = {CheckpointFamily::safety, 30},
       .definition = {.name = "connective-torn",
                      .title = "Connective tissue torn so far",
                      .displayUnit = "%",
                      .direction = Direction::lower,
                      .window = "whole attempt, whatever came of it",
                      .instruments = "union over instruments: what any of them tore",
                      .definition = "area of the bed under torn strands / area of the whole bed; bed as in "
                                    "connective-remaining"},
       .needs = {hasBed},
       .results = 2,
       .accumulate = accumulating<ConnectiveTorn>()},
      {.place = {CheckpointFamily::safety, 50},
       .definition = {.name = "burn-per-bed",
                      .title = "Area charred for a whole bed freed",
                      .displayUnit = "cm^2",
                      .direction = Direction::lower,
                      .window = "whole attempt, those in which at least 1 % of the bed came free only",
                      .instruments = "union over instruments: what any of them charred or freed",
                      .definition = "charred area of all organs' skins at rest / share of the bed's area that is not "
                                    "attached any more; bed as in connective-remaining"},
       .needs = {hasBed},
       .results = 3,
       .accumulate = accumulating<BurnPerBed>()},
      {.place = {CheckpointFamily::safety, 60},
       .definition = {.name = "burn-per-fat",
                      .title = "Area charred for the volume of fat removed",
                      .displayUnit = "cm^2/ml",
                      .direction = Direction::lower,
                      .window = "the phase of identification, as often as it recurs, where at least 1 % of the fat "
                                "went in it",
                      .instruments = "union over instruments: what any of them charred, took or freed",
                      .version = judgedVersion(1),
                      .definition = "area of all organs' skins at rest that is charred in the window / volume of fat "
                                    "at rest that goes in it"},
       .needs = {hasFat, hasProcedure},
       .results = 3,
       .accumulate = accumulating<BurnPerFat>()},
      {.place = {CheckpointFamily::safety, 70},
       .definition = {.name = "burn-per-dissection",
                      .title = "Area charred for the area of connective tissue dissected",
                      .direction = Direction::lower,
                      .window = "the phase of dissection, as often as it recurs, where at least 1 % of the bed came "
                                "free in it",
                      .instruments = "union over instruments: what any of them charred, took or freed",
                      .version = judgedVersion(1),
                      .definition = "area of all organs' skins at rest that is charred in the window / area of the "
                                    "bed at rest that comes free in it; bed as in connective-remaining"},
       .needs = {hasBed, hasProcedure},
       .results = 3,
       .accumulate = accumulating<BurnPerDissection>()},
  };
}

}  // namespace calot::analytics
