// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "analytics/assessment/moments.h"

namespace calot::gui {

/// Clicks on figures to moments of the replay: a figure's first click goes to the moment that made most of it, each
/// further one to the next in time, around.
class MomentCycle {
 public:
  /// How long before a moment's begin one looks at it (s): to see what led to it.
  static constexpr double leadIn = 0.5;

  /// @return when to look (s), or none where the figure has no moments
  std::optional<double> next(const analytics::FigureMoments& figure);
  void forget() { figure_.clear(); }

 private:
  std::string figure_;  ///< checkpoint and subject of the last click
  std::size_t at_ = 0;  ///< its moment
};

}  // namespace calot::gui
