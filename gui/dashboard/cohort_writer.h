// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <QObject>
#include <QThreadPool>
#include <QUndoCommand>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/long_work.h"

namespace calot::analytics {
class CohortDatabase;
}

namespace calot::gui {

/// Writes what people decide into a cohort, one decision after the other, on a thread of its own: a disk may take its
/// time, and another program may be writing.
class CohortWriter : public QObject {
  Q_OBJECT
 public:
  using Change = std::function<void(analytics::CohortDatabase&)>;

  explicit CohortWriter(QObject* parent = nullptr);
  /// Waits until all is written.
  ~CohortWriter() override;
  /// Ends with written() or failed(). @param change throws calot::Error where it cannot be
  /// @param undone called on the writer's thread where nothing was written, before failed()
  void write(const std::string& database, Change change, std::function<void()> undone);

 signals:
  void written();
  void failed(const QString& reason);

 private:
  std::shared_ptr<Link<CohortWriter>> back_;
  QThreadPool thread_;  // last: it uses what is above
};

/// Decisions of a person about attempts, and their reversal; the database notes both.
class DecisionCommand : public QUndoCommand {
 public:
  /// @param writer outlives this
  DecisionCommand(CohortWriter& writer, std::string database, const QString& text, CohortWriter::Change redo,
                  CohortWriter::Change undo);
  void redo() override { write(redo_); }
  void undo() override { write(undo_); }

 private:
  struct State;
  void write(const CohortWriter::Change& change);

  CohortWriter& writer_;
  std::string database_;
  CohortWriter::Change redo_, undo_;
  std::shared_ptr<State> state_;
};

/// Who decides, and about which attempts of which database.
struct Decision {
  std::string database, by;
  std::vector<analytics::AttemptRow> attempts;
};

/// Keeps the attempts out of studies, or takes that back.
std::unique_ptr<DecisionCommand> exclusionCommand(CohortWriter& writer, const Decision& decision, bool exclude,
                                                  const std::string& reason);
/// Puts a tag on those attempts that do not have it, or takes it off those that do.
std::unique_ptr<DecisionCommand> tagCommand(CohortWriter& writer, const Decision& decision, bool add,
                                            const std::string& tag);

}  // namespace calot::gui
