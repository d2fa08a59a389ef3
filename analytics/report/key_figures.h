// SPDX-License-Identifier: GPL-3.0-or-later
// The figures that count (countingCheckpoints()) of one attempt, each beside its pass mark: alike in windows, on a
// sheet and in a page.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/drawing.h"

namespace calot::analytics {

/// True if a value is missing because the scene lacks its subject ("the scene has no fat"): true of every attempt on
/// this scene.
bool sceneLacks(const CheckpointValue& value);

/// One figure of an attempt, of one hand or organ where it has several.
struct KeyFigure {
  CheckpointValue value;
  std::string title;           ///< "Path length of the instrument's tip, left"
  std::optional<double> mark;  ///< the norm's pass mark, SI
  bool atLeast = false;        ///< the mark is the least, else the most
  std::optional<bool> passed;  ///< by a norm

  [[nodiscard]] std::string number() const;   ///< "206.9 s"; without a value the reason
  [[nodiscard]] std::string against() const;  ///< "falls short of at most 170 s"; empty without a mark
};

/// Those that the scene has, in the order of countingCheckpoints(). @param grade null: not held against a norm
std::vector<KeyFigure> keyFigures(const std::vector<CheckpointValue>& values, const Grade* grade);

/// Number and mark of each figure in words; where it has a mark, a bar from zero below them, and the mark as a dashed
/// line. Those that fall short are of the second colour, and say so. A mark of the drawing has checkpoint and subject
/// as its key, a blank between them.
/// @param width in the drawing's units, as of PlotFrame @param columns beside each other. @pre at least 1
Drawing drawKeyFigures(const std::vector<KeyFigure>& figures, double width, std::size_t columns);

}  // namespace calot::analytics
