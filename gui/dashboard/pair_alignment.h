// SPDX-License-Identifier: GPL-3.0-or-later
// Two recordings in step: which moment of one stands beside which moment of the other. Knows no window.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "gui/attempt/attempt_track.h"

namespace calot::gui {

/// A common time, 0 at the moment that both are aligned by: a recording's own time is common + offset.
class PairAlignment {
 public:
  /// @param seconds lengths of both; @param offsets own times of the moment that they are aligned by
  PairAlignment(std::array<double, 2> seconds, std::array<double, 2> offsets);

  /// Common times in which at least one of them runs.
  [[nodiscard]] double begin() const { return begin_; }
  [[nodiscard]] double end() const { return end_; }
  /// A recording's own time, clamped: where one has ended its last picture stands.
  [[nodiscard]] double own(std::size_t which, double common) const;
  [[nodiscard]] double common(std::size_t which, double own) const { return own - offsets_[which]; }
  /// Whether a recording runs at a common time, rather than waiting for its begin or standing at its end.
  [[nodiscard]] bool runs(std::size_t which, double common) const;

 private:
  std::array<double, 2> seconds_, offsets_;
  double begin_, end_;
};

/// Begin of the first stretch of a phase; none where it was never reached.
std::optional<double> firstOf(const AttemptTrack& track, Phase phase);
/// Phases that both have, in the procedure's order.
std::vector<Phase> commonPhases(const AttemptTrack& a, const AttemptTrack& b);

}  // namespace calot::gui
