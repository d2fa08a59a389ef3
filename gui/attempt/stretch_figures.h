// SPDX-License-Identifier: GPL-3.0-or-later
// A stretch of two attempts in figures, side by side: a lesson of a branch is what it did otherwise than its parent.
#pragma once

#include <array>
#include <optional>
#include <QString>
#include <string>
#include <vector>

#include "gui/attempt/replay_player.h"

namespace calot::gui {

/// The moment when a branch leaves its parent, or two branches of one parent leave each other: the attempts' own time
/// (s), which is the same for both. None where neither is so.
[[nodiscard]] std::optional<double> partingTime(const AttemptTrack& a, const AttemptTrack& b);

/// A figure of both over the stretch.
struct StretchFigure {
  std::string title;                ///< "path of the right tip"
  std::array<std::string, 2> text;  ///< "212 mm", "none"
  std::string difference;           ///< right less left: "−62 mm"; empty: nothing to subtract
};

/// Errors by severity with their words, paths of the real tips, greatest forces on the hands.
/// @param from own times at which the stretch begins (s) @param seconds its length
[[nodiscard]] std::vector<StretchFigure> stretchFigures(const std::array<const AttemptTrack*, 2>& tracks,
                                                        std::array<double, 2> from, double seconds);

/// The same as rich text: a table under names of both.
[[nodiscard]] QString stretchTable(const std::vector<StretchFigure>& figures, const std::array<QString, 2>& names);

}  // namespace calot::gui
