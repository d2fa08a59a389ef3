// SPDX-License-Identifier: GPL-3.0-or-later
// Where an attempt's figures stand within a norm. Knows no window.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/grade.h"

namespace calot::gui {

/// One figure against the competent members of a norm; everything in the unit that the checkpoint displays.
struct FigureStanding {
  std::string checkpoint, subject;
  /// Quantiles of type 7 of the competent members; none where fewer than analytics::leastForPercentile have the figure.
  struct Band {
    double p10 = 0.0, p25 = 0.0, p50 = 0.0, p75 = 0.0, p90 = 0.0;
  };
  std::optional<Band> band;
  std::optional<double> value, cut;
  std::optional<double> percentile;  ///< 0 to 100, of the competent; 100: none of them was better
  std::optional<bool> passed;
  bool open = false;        ///< the value lies within the interval of the cut
  bool undecided = false;   ///< the cut lies within the simulation's interval of the value
  std::string explanation;  ///< sentences for a person
};

/// How the whole attempt stands.
struct AttemptStanding {
  std::string norm;     ///< "residents version 2"
  std::string verdict;  ///< one sentence; or why there is no judgement
  bool judged = false;
  std::optional<analytics::Grade> grade;  ///< where it is judged; alone, without the participant's other attempts
  std::vector<FigureStanding> figures;
};

/// Names of the norms that an attempt can be held against, those of its own comparability key, newest version of each
/// name; by name.
std::vector<const analytics::Norm*> normsFor(const analytics::AttemptRow& attempt,
                                             const std::vector<analytics::Norm>& norms);

/// An attempt that did not verify, or is not whole, is not judged: the verdict then says why, and the bands stand.
AttemptStanding standingOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                           const analytics::Norm& norm, const std::vector<analytics::ValueInterval>& intervals = {});

}  // namespace calot::gui
