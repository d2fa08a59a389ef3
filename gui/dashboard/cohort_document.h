// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// An open cohort database, for looking only: what the dashboard's models stand on. Knows no window.
class CohortDocument {
 public:
  /// Opens for reading and reads the list of attempts. @throws calot::Error as CohortDatabase does.
  explicit CohortDocument(const std::string& path);

  [[nodiscard]] const std::string& path() const { return database_.path(); }
  [[nodiscard]] const std::vector<analytics::AttemptRow>& attempts() const { return attempts_; }
  /// @throws calot::Error
  [[nodiscard]] std::vector<analytics::CheckpointValue> values(const std::string& uuid) const {
    return database_.values(uuid);
  }
  /// @throws calot::Error
  [[nodiscard]] std::vector<analytics::AttemptValue> allValues() const { return database_.allValues(); }

 private:
  analytics::CohortDatabase database_;
  std::vector<analytics::AttemptRow> attempts_;
};

}  // namespace calot::gui
