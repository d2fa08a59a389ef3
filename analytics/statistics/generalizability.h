// SPDX-License-Identifier: GPL-3.0-or-later
// Generalizability theory of one crossed facet: people by raters, or people by occasions.
#pragma once

#include <cstddef>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/rating_table.h"

namespace calot::analytics {

/// What a decision on the mean of k raters (occasions) is worth.
struct DecisionStudy {
  double g = 0.0;              ///< relative: p / (p + e / k), ranks people
  double phi = 0.0;            ///< absolute: p / (p + (f + e) / k), holds them against a mark
  double relativeError = 0.0;  ///< sqrt(e / k), the figure's unit
  double absoluteError = 0.0;  ///< sqrt((f + e) / k)
};

struct Generalizability {
  std::size_t people = 0, levels = 0;
  double person = 0.0;     ///< variance p of people
  double facet = 0.0;      ///< variance f of the raters' leniency, or of occasions
  double residual = 0.0;   ///< variance e of interaction and error
  bool truncated = false;  ///< a negative estimate was set to 0

  [[nodiscard]] DecisionStudy at(std::size_t k) const;  ///< @pre k > 0
};

/// Variance components of a complete table by the analysis of variance (Brennan 2001, Generalizability Theory, 3.2):
/// with mean squares S of people, R of raters and E of the rest, p = (S - E) / k, f = (R - E) / n, e = E. With all k
/// raters G is ICC(3,k) and Phi is ICC(2,k). No answer as objection(table).
Expected<Generalizability> generalizability(const RatingTable& table);

}  // namespace calot::analytics
