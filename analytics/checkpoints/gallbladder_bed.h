// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

/// The connective tissues that hold a gallbladder, as one: the mean of their shares, each of its own bed's area (a
/// scene has one of them as a rule).
class GallbladderBed {
 public:
  explicit GallbladderBed(const AttemptContext& context);

  /// Empty, or why the scene or its results have none.
  [[nodiscard]] const std::string& notApplicable() const { return notApplicable_; }
  void take(const StepResult& result);
  [[nodiscard]] bool any() const { return any_; }  ///< a step was taken
  [[nodiscard]] double attached() const { return attached_; }
  [[nodiscard]] double torn() const { return torn_; }
  [[nodiscard]] double area() const { return area_; }            ///< of all the beds at rest (m^2)
  [[nodiscard]] double freedArea() const { return freedArea_; }  ///< that is not attached any more (m^2)

 private:
  std::vector<std::size_t> tissue_;  ///< of StepResult::connective
  std::string notApplicable_;
  bool any_ = false;
  double attached_ = 1.0;
  double torn_ = 0.0;
  std::vector<double> areas_;  ///< as tissue_
  double area_ = 0.0;
  double freedArea_ = 0.0;
};

}  // namespace calot::analytics
