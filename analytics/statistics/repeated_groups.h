// SPDX-License-Identifier: GPL-3.0-or-later
// Two groups over several occasions: group, occasion and their interaction in one model.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

struct OccasionValue {
  std::size_t participant = 0;
  bool inX = false;      ///< group; one for all attempts of a participant
  double occasion = 0.0; /**< number of the attempt, or the place of a named occasion: 0, 1, ... */
  double value = 0.0;
};

enum class OccasionKind {
  number,  ///< one slope over the occasion, counted from the first
  named    ///< each occasion against the first
};

/// One coefficient with its test. Effects of the group are of x less y.
struct ModelTerm {
  double estimate = 0.0, error = 0.0, t = 0.0, df = 0.0, p = 1.0;
  Interval interval;
};

struct RepeatedGroups {
  ModelTerm group;                     ///< difference of the groups at the first occasion
  std::vector<ModelTerm> occasion;     ///< of y: change for each step, or at each later occasion against the first
  std::vector<ModelTerm> interaction;  ///< by how much that of x differs
  double betweenVariance = 0.0, withinVariance = 0.0, restrictedLogLikelihood = 0.0;
  std::size_t participants = 0, attempts = 0, occasions = 0;
};

/// value = a + b [x] + c occasion + d [x] occasion + u_participant + e by restricted maximum likelihood
/// (intercept_model.h). Student's t with the degrees of freedom of inner and outer terms (Pinheiro and Bates
/// 2000, 2.4): the group's has participants - 2, terms of the occasion attempts - participants - their number. Each
/// site is a constant of its own where `sites` names more than one, which takes their number less one from the group's.
/// No answer for an empty group, a participant in two groups, fewer than two occasions, a named occasion without both
/// groups, fewer than four participants, or as fitInterceptModel().
/// @param sites of each value, as many as values, or empty
Expected<RepeatedGroups> repeatedGroups(std::span<const OccasionValue> values, OccasionKind kind,
                                        std::span<const std::size_t> sites = {}, double level = 0.95);

}  // namespace calot::analytics
