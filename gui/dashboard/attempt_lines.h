// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <QString>
#include <QStringList>
#include <vector>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// The attempts of a cohort with what a table shows of them. Made where the cohort is read: to put ten thousand rows
/// into words and in order takes longer than an interface may be kept waiting. Never changes.
class AttemptLines {
 public:
  enum Column {
    attemptColumn,
    operatorColumn,
    groupColumn,
    sceneColumn,
    modeColumn,
    outcomeColumn,
    startColumn,
    verificationColumn,
    syntheticColumn,
    tagsColumn,
    columnTotal
  };

  explicit AttemptLines(std::vector<analytics::AttemptRow> attempts);

  [[nodiscard]] const std::vector<analytics::AttemptRow>& attempts() const { return attempts_; }
  [[nodiscard]] const QString& cell(int row, int column) const { return lines_[at(row)].cells[at(column)]; }
  /// All that the search box looks through, in small letters.
  [[nodiscard]] const QString& search(int row) const { return lines_[at(row)].search; }
  /// Position of the row in the order of a column; equal cells have equal ranks.
  [[nodiscard]] int rank(int row, int column) const { return ranks_[at(column)][at(row)]; }
  [[nodiscard]] const QStringList& tags() const { return tags_; }  ///< that any attempt has, by name

 private:
  struct Line {
    std::array<QString, columnTotal> cells;
    QString search;
  };
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }

  std::vector<analytics::AttemptRow> attempts_;
  std::vector<Line> lines_;
  std::array<std::vector<int>, columnTotal> ranks_;
  QStringList tags_;
};

}  // namespace calot::gui
