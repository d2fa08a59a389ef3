// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <QObject>
#include <QString>
#include <QStringList>
#include <QThreadPool>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/long_work.h"
#include "gui/dashboard/comparison.h"

namespace calot::gui {

[[nodiscard]] QStringList textsOf(const std::vector<std::string>& texts);
/// Calls. @return one line for the user where it threw, or empty
[[nodiscard]] QString faultOf(const std::function<void()>& call);

/// The attempts of a cohort with what a table shows of them. Made where the cohort is read: to put ten thousand rows
/// into words and in order takes longer than an interface may be kept waiting. Never changes.
class AttemptLines {
 public:
  enum Column {
    operatorColumn,
    groupColumn,
    sceneColumn,
    startColumn,
    safetyColumn,
    viewColumn,
    errorsColumn,
    trendColumn,
    outcomeColumn,
    verificationColumn,
    modeColumn,
    syntheticColumn,
    tagsColumn,
    attemptColumn,
    columnTotal
  };

  /// Values of a checkpoint, by attempt.
  using Values = std::map<std::string, analytics::CheckpointValue>;
  struct Figures {
    std::array<Values, severityCount> errors;  ///< as analytics::errorCheckpoints()
    Values criticalView;
  };

  static QString title(int column);
  AttemptLines(std::vector<analytics::AttemptRow> attempts, const Figures& figures);

  [[nodiscard]] const std::vector<analytics::AttemptRow>& attempts() const { return attempts_; }
  [[nodiscard]] const QString& cell(int row, int column) const { return lines_[at(row)].cells[at(column)]; }
  /// All that the search box looks through, in small letters.
  [[nodiscard]] const QString& search(int row) const { return lines_[at(row)].search; }
  /// Is it the newest attempt of its participant, or of its profile where nobody is named?
  [[nodiscard]] bool isLatest(int row) const { return lines_[at(row)].latest; }
  /// Position of the row in the order of a column; equal cells have equal ranks.
  [[nodiscard]] int rank(int row, int column) const { return ranks_[at(column)][at(row)]; }
  [[nodiscard]] const QStringList& tags() const { return tags_; }  ///< that any attempt has, by name

 private:
  struct Line {
    std::array<QString, columnTotal> cells;
    QString search;
    bool latest = false;
  };
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }

  std::vector<analytics::AttemptRow> attempts_;
  std::vector<Line> lines_;
  std::array<std::vector<int>, columnTotal> ranks_;
  QStringList tags_;
};

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

/// An open cohort database, for looking only: what the dashboard's models stand on. Knows no window.
class CohortDocument {
 public:
  /// Opens for reading and reads the list of attempts. @throws calot::Error as CohortDatabase does.
  explicit CohortDocument(const std::string& path);

  [[nodiscard]] const std::string& path() const { return database_.path(); }
  [[nodiscard]] const std::vector<analytics::AttemptRow>& attempts() const { return lines_->attempts(); }
  /// The same, ready to be shown in a table.
  [[nodiscard]] const std::shared_ptr<const AttemptLines>& lines() const { return lines_; }
  /// For what is read attempt by attempt, on the interface's thread.
  [[nodiscard]] const analytics::CohortDatabase& database() const { return database_; }
  /// All values, by figure; any thread, the first that asks reads them. @throws calot::Error
  [[nodiscard]] std::shared_ptr<const FigureValues> figureValues() const;
  [[nodiscard]] const analytics::AttemptRow* attempt(const std::string& uuid) const;  ///< or null
  /// Read when they are first asked for. @throws calot::Error
  [[nodiscard]] const std::vector<analytics::Norm>& norms() const;
  /// Protocols, participants and ratings as they are now. @throws calot::Error
  [[nodiscard]] analytics::CohortDatabase assessment() const {
    return {path(), analytics::CohortDatabase::Access::read};
  }

 private:
  analytics::CohortDatabase database_;
  std::shared_ptr<const AttemptLines> lines_;
  mutable std::optional<std::vector<analytics::Norm>> norms_;
  mutable std::mutex valuesMutex_;
  mutable std::shared_ptr<const FigureValues> values_;
};

/// Writes what people decide into a cohort, one decision after the other, on a thread of its own: a disk may take its
/// time, and another program may be writing. Its destructor waits until all is written.
class CohortWriter : public QObject {
  Q_OBJECT
 public:
  using Change = std::function<void(analytics::CohortDatabase&)>;

  CohortWriter() { thread_.setMaxThreadCount(1); }
  /// Ends with written() or failed(). @param change throws calot::Error where it cannot be
  /// @param undone called on the writer's thread where nothing was written, before failed()
  void write(const std::string& database, Change change, std::function<void()> undone);

 signals:
  void written();
  void failed(const QString& reason);

 private:
  QThreadPool thread_;
};

}  // namespace calot::gui
