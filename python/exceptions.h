// SPDX-License-Identifier: GPL-3.0-or-later
// Errors as Python exceptions (calot/_errors.py).
#pragma once

#include <string>

#include "recorder/base/errors.h"
#include "recorder/replay.h"

namespace calot::python {

/// A recording that is not what its re-simulation gives.
class ReplayFault : public Error {
 public:
  /// @pre the report's verdict is `diverged`
  explicit ReplayFault(const recorder::ReplayReport& report);
  [[nodiscard]] const recorder::ReplayReport& report() const { return report_; }

 private:
  recorder::ReplayReport report_;
};

/// Throws what a verdict amounts to; returns where it is exact. @throws ReplayFault; Error (damaged, undecided)
void throwUnlessExact(const recorder::ReplayReport& report);

/// Advice on an error, in words for users of the module.
std::string advice(const std::vector<Remedy>& remedies);

/// Makes C++ errors Python's from here on.
void translateErrors();

}  // namespace calot::python
