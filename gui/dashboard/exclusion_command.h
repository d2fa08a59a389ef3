// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <QUndoCommand>
#include <string>

namespace calot::gui {

/// Keeps an attempt out of studies, or takes that back; both can be undone, and the database notes reason and name.
class ExclusionCommand : public QUndoCommand {
 public:
  struct Change {
    std::string database, attempt, reason, by;
    bool exclude = true;
    std::string formerReason;  ///< of an exclusion that is taken back: what undoing it says
  };
  /// @param done called after each change, with what went wrong or an empty text
  ExclusionCommand(Change change, std::function<void(const QString&)> done);
  void redo() override { apply(change_.exclude, change_.reason); }
  void undo() override;

 private:
  void apply(bool exclude, const std::string& reason);
  Change change_;
  std::function<void(const QString&)> done_;
};

}  // namespace calot::gui
