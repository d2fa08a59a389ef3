// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on each hand, and on each organ, vessel and body of fat.
#include "analytics/checkpoints/collector.h"

#include <algorithm>
#include <numeric>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

double quantileOf(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  return quantileOfSorted(values, p);
}

/// A figure of one hand's haptic force.
struct ForceMeasure {
  double (*figure)(const HandForces& forces, double tickSeconds);
  bool needsFelt;  ///< there is no value without a force of leastForce

  [[nodiscard]] Measured of(const HandForces& forces, double tickSeconds) const {
    if (!forces.mounted) return Measured::none(Availability::absentHand, "no instrument in this hand");
    if (needsFelt && forces.felt.empty()) return Measured::notApplicable("no force of 0.01 N or more");
    return Measured::of(figure(forces, tickSeconds));
  }
};

constexpr ForceMeasure maximum{[](const HandForces& f, double) { return f.largest; }, false};
constexpr ForceMeasure p99{[](const HandForces& f, double) { return quantileOf(f.felt, 0.99); }, true};
constexpr ForceMeasure meanFelt{[](const HandForces& f, double) {
                                  const double sum = std::accumulate(f.felt.begin(), f.felt.end(), 0.0);
                                  return sum / static_cast<double>(f.felt.size());
                                },
                                true};
constexpr ForceMeasure impulse{[](const HandForces& f, double tickSeconds) { return f.sum * tickSeconds; }, false};
/// A force that was felt at the first or the last tick alone has no rate of change.
constexpr ForceMeasure rate{
    [](const HandForces& f, double) { return f.rates.empty() ? 0.0 : quantileOf(f.rates, 0.95); }, true};

struct HandForce {
  ForceMeasure measure;

  /// The figure of a hand, or of a hand in a phase.
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t subject,
                                const CheckpointDefinition& declared) const {
    const bool inPhase = declared.aggregation == Aggregation::handAndPhase;
    const ForceTrack& track = inPhase ? end.phaseForce->of(subject / handCount) : *end.force;
    return measure.of(track.of(subject % handCount), track.tickSeconds());
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
  std::vector<CheckpointEntry> rows{
      handForce(50, "force-maximum", "Largest haptic force", "N", maximum, "none", "max |f_W| over all ticks"),
      handForce(60, "force-p99", "99th percentile of the haptic force", "N", p99, felt,
                "quantile of type 7 at 0.99 of |f_W| over the ticks with |f_W| >= 0.01 N"),
      handForce(70, "force-mean", "Mean non-zero haptic force", "N", meanFelt, felt,
                "mean of |f_W| over the ticks with |f_W| >= 0.01 N"),
      handForce(80, "force-impulse", "Impulse of the haptic force", "N s", impulse, "none",
                "tick length * sum of |f_W| over all ticks"),
      handForce(90, "force-rate-p95", "95th percentile of the haptic force's rate of change", "N/s", rate,
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
  rows.push_back(phaseRow(rows[3], 130, "ticks", accumulating<HandForce>(impulse)));
  return rows;
}

}  // namespace calot::analytics
