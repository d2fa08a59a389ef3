// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/dashboard/comparison.h"

namespace calot::gui {

/// All values of a cohort, by figure: pages look at one figure of thousands of attempts at a time. Knows no window.
class FigureValues {
 public:
  using Take = std::function<void(const analytics::AttemptValue&)>;
  /// @param each gives every value to what it is called with, by attempt: CohortDatabase::eachValue()
  explicit FigureValues(const std::function<void(const Take&)>& each);
  /// All figures with at least one value, in the order of first appearance.
  [[nodiscard]] const std::vector<Figure>& figures() const { return figures_; }
  /// By attempt. @param index of figures()
  [[nodiscard]] const std::vector<analytics::AttemptValue>& of(std::size_t index) const { return values_[index]; }

 private:
  std::vector<Figure> figures_;
  std::vector<std::vector<analytics::AttemptValue>> values_;
};

}  // namespace calot::gui
