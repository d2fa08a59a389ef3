// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on each hand, and on each organ, vessel and body of fat.
#include "analytics/checkpoints/force.h"

#include <algorithm>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

double quantileOf(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  return quantileOfSorted(values, p);
}

double largest(const ForceTrack& track, int hand) { return track.largest(hand); }
double percentile(const ForceTrack& track, int hand) { return quantileOf(track.felt(hand), 0.99); }
double mean(const ForceTrack& track, int hand) {
  double sum = 0.0;
  for (const double f : track.felt(hand)) sum += f;
  return sum / static_cast<double>(track.felt(hand).size());
}
double impulse(const ForceTrack& track, int hand) { return track.impulse(hand); }
/// A force that was felt at the first or the last tick alone has no rate of change.
double rate(const ForceTrack& track, int hand) {
  return track.rates(hand).empty() ? 0.0 : quantileOf(track.rates(hand), 0.95);
}

/// A figure of one hand's haptic force.
struct ForceMeasure {
  double (*figure)(const ForceTrack& track, int hand);
  bool needsFelt;  ///< there is no value without a force of minForce

  [[nodiscard]] Measured of(const ForceTrack& track, int hand) const {
    if (!track.mounted(hand)) return Measured::none(Availability::absentHand, "no instrument in this hand");
    if (needsFelt && track.felt(hand).empty()) return Measured::notApplicable("no force of 0.01 N or more");
    return Measured::of(figure(track, hand));
  }
};

struct HandForce {
  ForceMeasure measure;

  /// Of a hand, or of a hand in a phase.
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t subject,
                                const CheckpointDefinition& declared) const {
    const bool inPhase = declared.aggregation == Aggregation::handAndPhase;
    return measure.of(inPhase ? end.phaseForce->of(subject / handCount) : *end.force,
                      static_cast<int>(subject % handCount));
  }
};

/// Sum over instruments of their normal forces on a structure and of the pull on it.
struct StructureForce {
  const AttemptContext& context;
  bool impulse;
  std::vector<std::vector<double>> force =
      std::vector<std::vector<double>>(context.structures.size());  ///< of steps in which something touched it (N)
  std::vector<double> sum = std::vector<double>(context.structures.size());  ///< N s

  void add(const StepResult& result) {
    for (std::size_t s = 0; s < sum.size(); ++s) {
      double now = 0.0;
      for (const HandResult& hand : result.hand) {
        if (s < hand.structureForce.size()) now += hand.forceOn(s);
      }
      sum[s] += now * context.stepSeconds();
      if (!impulse && now >= leastForce) force[s].push_back(now);
    }
  }
  [[nodiscard]] Measured figure(std::size_t s) const {
    if (impulse) return Measured::of(sum[s]);
    if (force[s].empty()) return Measured::notApplicable("nothing touched it with 0.01 N");
    return Measured::of(quantileOf(force[s], 0.99));
  }
};

CheckpointEntry handForce(int rank, const char* name, const char* title, const char* unit, ForceMeasure measure,
                          const char* filter, const char* formula) {
  return {.place = {CheckpointFamily::contact, rank},
          .definition = {.name = name,
                         .title = title,
                         .unit = unit,
                         .direction = Direction::lower,
                         .window = "whole attempt, while an instrument is mounted",
                         .aggregation = Aggregation::hand,
                         .instruments = "each hand by itself",
                         .filter = filter,
                         .definition = formula},
          .accumulate = accumulating<HandForce>(measure)};
}

}  // namespace

std::vector<CheckpointEntry> forceRows() {
  constexpr const char* felt = "ticks of at least 0.01 N";
  constexpr ForceMeasure maximum{largest, false}, p99{percentile, true}, dose{impulse, false};
  std::vector<CheckpointEntry> rows{
      handForce(50, "force-maximum", "Largest haptic force", "N", maximum, "none", "max |f_W| over all ticks"),
      handForce(60, "force-p99", "99th percentile of the haptic force", "N", p99, felt,
                "quantile of type 7 at 0.99 of |f_W| over the ticks with |f_W| >= 0.01 N"),
      handForce(70, "force-mean", "Mean non-zero haptic force", "N", {mean, true}, felt,
                "mean of |f_W| over the ticks with |f_W| >= 0.01 N"),
      handForce(80, "force-impulse", "Impulse of the haptic force", "N s", dose, "none",
                "tick length * sum of |f_W| over all ticks"),
      handForce(90, "force-rate-p95", "95th percentile of the haptic force's rate of change", "N/s", {rate, true},
                "ticks of at least 0.01 N; central differences",
                "quantile of type 7 at 0.95 of |f_W(t+1) - f_W(t-1)| / (2 ticks) over the ticks t with |f_W(t)| >= "
                "0.01 N"),
      {.place = {CheckpointFamily::contact, 44},
       .definition = {.name = "structure-force-p99",
                      .title = "99th percentile of the force on the organ",
                      .unit = "N",
                      .direction = Direction::lower,
                      .aggregation = Aggregation::organ,
                      .instruments = "sum over instruments in each step",
                      .filter = "steps of at least 0.01 N",
                      .definition = "quantile of type 7 at 0.99 of F(o) over the steps with F(o) >= 0.01 N; F(o) = "
                                    "sum over instruments of the magnitudes of its normal forces on organ o, and of "
                                    "the pull on it where its jaws hold it"},
       .results = 2,
       .accumulate = accumulating<StructureForce>(false)},
      {.place = {CheckpointFamily::contact, 47},
       .definition = {.name = "structure-force-impulse",
                      .title = "Impulse on the organ",
                      .unit = "N s",
                      .direction = Direction::lower,
                      .aggregation = Aggregation::organ,
                      .instruments = "sum over instruments",
                      .definition = "step length * sum over steps of F(o), F as in structure-force-p99"},
       .results = 2,
       .accumulate = accumulating<StructureForce>(true)}};
  rows.push_back(phaseRow(rows[0], 110, "ticks", accumulating<HandForce>(maximum)));
  rows.push_back(phaseRow(rows[1], 120, "ticks", accumulating<HandForce>(p99)));
  rows.push_back(phaseRow(rows[3], 130, "ticks", accumulating<HandForce>(dose)));
  return rows;
}

}  // namespace calot::analytics
