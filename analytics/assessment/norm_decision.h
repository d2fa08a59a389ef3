// SPDX-License-Identifier: GPL-3.0-or-later
// How far decisions by a norm can be trusted: false passes and false failures, agreement of repeated decisions, and
// grades so near to a pass mark that another attempt of the same person might be graded otherwise.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "analytics/assessment/norm.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/power.h"

namespace calot::analytics {

/// People whose repeated attempts an error of measurement needs.
inline constexpr std::size_t minRepeaters = 5;

/// Standard error of a figure beside its pass mark, on the mark's scale (logarithms where that has them).
struct MarkError {
  double value = 0.0;
  std::uint64_t people = 0;  ///< with repeated attempts: an error of measurement; 0: of the mark itself
};

/// By Norm::checkpoints: the error of measurement from repeated attempts of the norm's key (measurementError()), of
/// fewer than minRepeaters people that of the mark, from its interval; none where there is neither.
std::vector<std::optional<MarkError>> markErrors(const Norm& norm, const std::vector<AttemptRow>& attempts,
                                                 const std::vector<AttemptValue>& values);
/// The value is within one standard error of the pass mark. @pre there is a cut
bool isWithinError(const NormCheckpoint& mark, const std::optional<MarkError>& error, double value);

/// Decisions of one kind out of all of them.
struct DecisionShare {
  std::uint64_t hits = 0, of = 0;
  Expected<SimulatedShare> share = NoResult{"nobody to decide on"};
};

struct NormDecisions {
  /// Others who pass, competent members who fail: each is judged by marks made without that member. Fixed marks stay.
  DecisionShare falsePass, falseFail;
  DecisionShare agreement;                                       ///< people whose first two attempts are graded alike
  Expected<double> kappa = NoResult{"nobody was graded twice"};  ///< Cohen's, of the same
  std::uint64_t graded = 0, passed = 0;
  std::uint64_t near = 0;  ///< graded: the other way within one standard error of the marks
};

/// Decisions on the norm's members, and on every attempt of its key that a study could analyse, with or without a
/// group.
/// @param ratings that a norm by borderline regression was made of
NormDecisions decisionsOf(const Norm& norm, const std::vector<AttemptRow>& attempts,
                          const std::vector<AttemptValue>& values, const std::vector<Rating>& ratings);

/// A norm and whom it would let through, before it is made.
struct NormTrial {
  Norm norm;                                    ///< without intervals; a figure counts as far as it has a mark
  std::vector<bool> passed;                     ///< by Norm::members
  std::vector<std::optional<double>> computed;  ///< marks that the members give, by Norm::checkpoints
  /// Members who pass, first of the competent, then of the others: by these marks, and each by marks made without
  /// that member (leave one out); marks that a person set stay.
  std::pair<PassRate, PassRate> rates, withoutSelf;
};

/// Applies decisions, marks and rule of a request to gathered members (gatherNorm()), and refuses nothing: too few
/// members have no marks, and without a figure that counts everybody passes who made no critical error.
NormTrial tryNorm(Norm gathered, const std::vector<Rating>& ratings, const NormRequest& request);

}  // namespace calot::analytics
