// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions of people about attempts and participants: each one is a change of the cohort with its reversal. One
// list of a window holds them, for undo and redo.
#pragma once

#include <functional>
#include <QObject>
#include <QString>
#include <string>
#include <vector>

#include "gui/dashboard/cohort_document.h"

class QAction;
class QUndoStack;

namespace calot::gui {

struct Decision {
  using Change = CohortWriter::Change;
  QString text;                          ///< "exclude attempt 3f2a1b9c": stands behind "Undo: "
  Change make, undo;                     ///< the database notes both
  bool made = false;                     ///< it was carried out already: taking it writes nothing
  std::function<void()> takenBack = {};  ///< called on the window's thread whenever it is undone; or empty
};

/// Keeps attempts out of studies, or takes them in again with the former reasons to go back to. Those that are so
/// already, and withdrawn ones, stay as they are.
Decision exclusionDecision(const std::vector<analytics::AttemptRow>& attempts, bool exclude, const std::string& reason,
                           const std::string& by);
/// Puts a tag on those attempts that do not have it, or takes it off those that do. @pre tag as analytics::checkTag()
Decision tagDecision(const std::vector<analytics::AttemptRow>& attempts, bool add, const std::string& tag,
                     const std::string& by);
Decision groupDecision(const std::string& participant, const std::string& group, const std::string& before);
/// A completed form. @param before what it replaces, or nothing @param name of what is rated: "film 3"
Decision ratingDecision(const analytics::StoredDocument& form, const analytics::Rating& rating,
                        const std::optional<analytics::Rating>& before, const QString& name);

/// A norm that was stored just now.
Decision normDecision(const analytics::Norm& norm);

/// The last decisions about a cohort, written one after the other on a thread of its own. One that could not be written
/// leaves nothing to undo.
class Decisions : public QObject {
  Q_OBJECT
 public:
  explicit Decisions(QObject* parent);
  void take(const std::string& database, const Decision& decision);
  void forget();                                               ///< all: another cohort is open
  [[nodiscard]] QAction* undoAction() const { return undo_; }  ///< "Undo: exclude attempt 3f2a1b9c"
  [[nodiscard]] QAction* redoAction() const { return redo_; }

 signals:
  void written();
  void failed(const QString& reason);

 private:
  QUndoStack* stack_;
  QAction *undo_, *redo_;
  CohortWriter writer_;
};

}  // namespace calot::gui
