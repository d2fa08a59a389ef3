// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/wire.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

/// Reads a step's results as an engine sends them, in the recording's version of StepResult.
class ResultReader {
 public:
  explicit ResultReader(const AttemptHeader& header);

  /// What is wrong with the columns that an engine declares for these recordings; empty: nothing.
  [[nodiscard]] std::string fault(const std::vector<wire::Column>& declared) const;
  /// Reads a row. @param procedure of version 3 alone
  /// @return what of it no engine makes, or nothing @pre fault() had nothing to say
  [[nodiscard]] std::string read(std::span<const std::byte> row, StepResult& result,
                                 RecordedProcedure& procedure) const;
  /// The scene has a procedure that this version of StepResult judged.
  [[nodiscard]] bool hasProcedure() const { return layout_.procedure; }

 private:
  Layout layout_;
  std::size_t first_ = 0;            ///< of the columns of results
  std::vector<std::size_t> offset_;  ///< in a row, of each of them, and its end
};

}  // namespace calot::recorder
