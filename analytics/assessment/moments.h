// SPDX-License-Identifier: GPL-3.0-or-later
// When in an attempt a figure came about.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/recording/reader.h"

namespace calot::analytics {

struct Moment {
  double begin = 0.0, end = 0.0;  ///< s of the attempt
  double share = 0.0;             ///< of all by which it got worse, from 0 to 1
};

struct FigureMoments {
  std::string checkpoint, subject;
  std::vector<Moment> moments;  ///< by time
  std::string none;             ///< why there are none, or empty
};

/// The windows in which a figure got worse that made most of it. A figure is asked for after every window (a second, or
/// a two hundredth of the attempt where that is longer). Where it only ever gets worse, the up to three windows that
/// added most, and at least twice the mean, are its moments; neighbours are joined. A figure that also gets better is
/// one of the whole.
/// @param series its value, or none as NaN, at the end of each window; @param length of a window (s)
FigureMoments momentsOf(const std::vector<double>& series, double length, Direction better);

/// When an attempt went wrong, by what its recording's steps hold.
struct AttemptMoments {
  std::vector<FigureMoments> figures;
  std::vector<ErrorLine> errors = {};  ///< the gravest first
};

/// The moments of these figures, and the errors, from what a recording's steps say of themselves.
/// @param figures checkpoint and subject
/// @param progress steps done, of all
/// @throws Error (damaged) as valuesFromObservables().
AttemptMoments findMoments(recorder::Recording& recording,
                           const std::vector<std::pair<std::string, std::string>>& figures,
                           const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace calot::analytics
