// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "gui/dashboard/attempt_lines.h"
#include "gui/dashboard/figure_values.h"

namespace calot::gui {

/// An open cohort database, for looking only: what the dashboard's models stand on. Knows no window.
class CohortDocument {
 public:
  /// Opens for reading and reads the list of attempts. @throws calot::Error as CohortDatabase does.
  explicit CohortDocument(const std::string& path);

  [[nodiscard]] const std::string& path() const { return database_.path(); }
  [[nodiscard]] const std::vector<analytics::AttemptRow>& attempts() const { return lines_->attempts(); }
  /// The same, ready to be shown in a table.
  [[nodiscard]] const std::shared_ptr<const AttemptLines>& lines() const { return lines_; }
  /// @throws calot::Error
  [[nodiscard]] std::vector<analytics::CheckpointValue> values(const std::string& uuid) const {
    return database_.values(uuid);
  }
  /// @throws calot::Error
  [[nodiscard]] std::vector<analytics::ValueInterval> intervals(const std::string& uuid) const {
    return database_.intervals(uuid);
  }
  /// All values, by figure; any thread, the first that asks reads them. @throws calot::Error
  [[nodiscard]] std::shared_ptr<const FigureValues> figureValues() const;
  [[nodiscard]] const analytics::AttemptRow* attempt(const std::string& uuid) const;  ///< or null
  /// Read when they are first asked for. @throws calot::Error
  [[nodiscard]] const std::vector<analytics::Norm>& norms() const;
  /// Registered, as they are now. @throws calot::Error
  [[nodiscard]] std::vector<analytics::RegisteredProtocol> protocols() const;
  [[nodiscard]] std::vector<std::string> participants() const;   ///< pseudonyms, by name. @throws calot::Error
  [[nodiscard]] std::vector<analytics::Rating> ratings() const;  ///< as they are now. @throws calot::Error

 private:
  analytics::CohortDatabase database_;
  std::shared_ptr<const AttemptLines> lines_;
  mutable std::optional<std::vector<analytics::Norm>> norms_;
  mutable std::mutex valuesMutex_;
  mutable std::shared_ptr<const FigureValues> values_;
};

}  // namespace calot::gui
