// SPDX-License-Identifier: GPL-3.0-or-later
// Where a time stands on a page: one scale for timeline and traces, so that they stand under one another.
#pragma once

#include <algorithm>

#include "gui/attempt/theme.h"

namespace calot::gui {

struct TimeScale {
  static constexpr double rightMargin = 16.0;  ///< pixels
  /// Pixels for an axis and its numbers.
  [[nodiscard]] static double leftMargin() { return theme::inType(64); }

  double seconds = 0.0;  ///< the whole, from 0
  double width = 0.0;    ///< of the widget (pixels)

  [[nodiscard]] double span() const { return std::max(1.0, width - leftMargin() - rightMargin); }
  [[nodiscard]] double x(double time) const { return leftMargin() + (seconds > 0.0 ? time / seconds * span() : 0.0); }
  /// Clamped to the attempt.
  [[nodiscard]] double time(double x) const { return std::clamp((x - leftMargin()) / span(), 0.0, 1.0) * seconds; }
};

}  // namespace calot::gui
