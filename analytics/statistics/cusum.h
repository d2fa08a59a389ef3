// SPDX-License-Identifier: GPL-3.0-or-later
// Cumulative sums of failures and successes, against a failure rate p0 that is acceptable and one, p1, that is not. The
// log-likelihood form and the scaled form differ by the factor ln(odds ratio): a design holds steps and limits
// together, so that those of different forms cannot be mixed.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// All declared before the first attempt.
struct CusumGoal {
  double acceptable = 0.05;    ///< failure rate p0
  double unacceptable = 0.15;  ///< failure rate p1 > p0
  double alpha = 0.1;          ///< chance to call p0 unacceptable
  double beta = 0.1;           ///< chance to call p1 acceptable
};

class CusumDesign {
 public:
  /// Steps ln(p1 / p0) and ln((1 - p1) / (1 - p0)); limits ln((1 - beta) / alpha) above and ln(beta / (1 - alpha))
  /// below (Wald 1947, the sequential probability ratio test).
  static Expected<CusumDesign> logLikelihood(const CusumGoal& goal);
  /// The same divided by ln(p1 (1 - p0) / (p0 (1 - p1))), so that a failure and a success are one apart: steps 1 - s
  /// and -s (Williams, Parry and Schlup 1992, BMJ 304:1359).
  static Expected<CusumDesign> scaled(const CusumGoal& goal);

  [[nodiscard]] double failureStep() const { return failure_; }  ///< > 0
  [[nodiscard]] double successStep() const { return success_; }  ///< < 0
  [[nodiscard]] double upperLimit() const { return upper_; }     ///< reached: unacceptable
  [[nodiscard]] double lowerLimit() const { return lower_; }     ///< reached: acceptable

 private:
  CusumDesign(double failure, double success, double upper, double lower)
      : failure_(failure), success_(success), upper_(upper), lower_(lower) {}
  double failure_, success_, upper_, lower_;
};

struct CusumChart {
  std::vector<double> sums;                 ///< after each attempt
  std::optional<std::size_t> unacceptable;  ///< first attempt (from 0) at which the upper limit is reached
  std::optional<std::size_t> acceptable;    ///< the same of the lower limit; never while held at zero
};

enum class CusumKind {
  sequential,  ///< plain sum, which tests whether someone has reached the goal; only the first limit reached counts
  monitoring   ///< bounded below by zero (Page 1954), which detects a drop in performance; no lower limit
};

/// @param failures true for a failed attempt, in order.
CusumChart cusum(const CusumDesign& design, const std::vector<bool>& failures, CusumKind kind);

}  // namespace calot::analytics
