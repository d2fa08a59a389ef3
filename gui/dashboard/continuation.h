// SPDX-License-Identifier: GPL-3.0-or-later
// A moment of an attempt that somebody else goes on from: a performer, or a person in the trainer.
#pragma once

#include <QDialog>
#include <QString>

class QComboBox;
class QRadioButton;
class QSpinBox;

namespace calot::gui {

/// A performer's continuation of a recording.
struct BranchRequest {
  QString parent;     ///< the recording, an absolute path
  double time = 0.0;  ///< where it is left (s)
  QString profile;    ///< "skilled"
  int seconds = 20;   ///< how long it goes on
  QString file;       ///< the branch's own recording, which does not exist yet
};

/// Asks who is to go on, and for how long.
class ContinuationDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param time s
  ContinuationDialog(double time, QWidget* parent);

  [[nodiscard]] bool byPerformer() const;
  [[nodiscard]] QString profile() const;
  [[nodiscard]] int seconds() const;

 private:
  QRadioButton *performer_, *person_;
  QComboBox* profile_;
  QSpinBox* seconds_;
};

/// A name beside the parent that no file has: "attempt-skilled-from-62.5.h5", with "-2" and so on where it is taken.
[[nodiscard]] QString branchFile(const QString& parent, const QString& who, double time);

}  // namespace calot::gui
