// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <QDialog>

class QDoubleSpinBox;
class QLabel;

namespace calot::gui {

/// A calibration for an assessment: of mouse and keyboard it is declared here; of any device, a file is chosen.
class CalibrationDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param mouse mouse and keyboard drive the hands @param target where what is declared is written
  CalibrationDialog(bool mouse, std::filesystem::path target, QWidget* parent);

  /// The calibration's file; empty before the dialog was accepted.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  void declare();
  void choose();

  std::filesystem::path target_, file_;
  QDoubleSpinBox* pixel_;
  QLabel* fault_;
};

}  // namespace calot::gui
