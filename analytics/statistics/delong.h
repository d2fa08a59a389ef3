// SPDX-License-Identifier: GPL-3.0-or-later
// The area under the ROC curve and its variance by DeLong, DeLong and Clarke-Pearson (1988, Biometrics 44:837).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// With psi(x, y) = 1 for x > y, 1/2 for x = y, 0 else: V_i = mean over y of psi(x_i, y), W_j = mean over x of psi(x,
/// y_j); A is the mean of either, and var A = var(V) / nx + var(W) / ny with sample variances.
struct DeLong {
  double a = 0.5;                ///< P(X > Y) + P(X = Y) / 2
  double variance = 0.0;         ///< 0 at A = 0 and A = 1, whatever the sizes: then no interval can be made of it
  std::vector<double> ofX, ofY;  ///< V and W
};
/// No answer for fewer than two values in a group.
Expected<DeLong> deLong(std::span<const double> x, std::span<const double> y);

/// Two figures of the same people, of whom some are expected to be higher (x) and some lower (y): value i of both
/// figures is the same person's.
struct PairedFigures {
  std::span<const double> firstX, secondX;
  std::span<const double> firstY, secondY;
};

struct PairedAreas {
  double first = 0.5, second = 0.5;   ///< A of either figure
  double difference = 0.0;            ///< first less second
  double p = 1.0;                     ///< two-sided
  std::optional<double> z;            ///< of DeLong's method alone
  std::optional<Interval> interval;   ///< of the difference; none where the method fell back
  std::string method;                 ///< "DeLong", or what was done instead and why
  std::optional<std::uint64_t> seed;  ///< of a fallback by random permutations
};

/// Difference of two correlated areas: z = (A1 - A2) / sqrt(var(V1 - V2) / nx + var(W1 - W2) / ny), normal. Where an
/// area is 0 or 1 its variance vanishes, and where both place everybody alike that of the difference; the p is then
/// that of the permutation test that exchanges the ranks of a person's two figures (Bandos, Rockette and Gur 2005,
/// Stat. Med. 24:2873), over all exchanges up to 16 people, else over 9,999 random ones. No answer for groups below
/// two, lengths that differ, or figures that rank everybody alike.
Expected<PairedAreas> compareAreas(const PairedFigures& figures, double level = 0.95, std::uint64_t seed = 1);

}  // namespace calot::analytics
