// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>

class QComboBox;
class QLineEdit;
class QListWidget;
class QSpinBox;

namespace calot::gui {

/// Where recordings are looked for, which program imports them and with how many threads, who is at the desk,
/// and how the dashboard looks.
class SettingsDialog : public QDialog {
  Q_OBJECT
 public:
  explicit SettingsDialog(QWidget* parent = nullptr);
  void accept() override;  ///< stores what is shown

 private:
  QListWidget* folders_;
  QLineEdit* program_;
  QSpinBox* threads_;
  QLineEdit* person_;
  QComboBox* colours_;
  QSpinBox* type_;
};

}  // namespace calot::gui
