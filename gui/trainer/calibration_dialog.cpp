// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/calibration_dialog.h"

#include <memory>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QLabel>
#include <QPushButton>
#include <system_error>
#include <utility>

#include "gui/attempt/widget_parts.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/mouse_device.h"

namespace calot::gui {
namespace {

constexpr double usualPixel = 0.15;  // mm, as the mouse drives the tip

}  // namespace

CalibrationDialog::CalibrationDialog(bool mouse, std::filesystem::path target, QWidget* parent)
    : QDialog(parent),
      target_(std::move(target)),
      pixel_(parts::named("pixel", new QDoubleSpinBox)),
      fault_(parts::plainLabel("calibration-fault")) {
  setWindowTitle("Calibration");
  auto* const text = new QLabel(
      mouse
          ? "An assessment compares people at like stations, so it says how far the hand moves for a pixel. Move the "
            "mouse slowly along a ruler, count the pixels, and divide. The system sets this value: it is declared, "
            "not measured, and holds for thirty days. A later declaration replaces it."
          : "An assessment needs the calibration of this device: a file, as measured for this station within the last "
            "thirty days.");
  text->setWordWrap(true);
  pixel_->setRange(0.005, 5.0);
  pixel_->setDecimals(3);
  pixel_->setSingleStep(0.01);
  pixel_->setValue(usualPixel);
  pixel_->setSuffix(" mm");
  auto* const declareButton = parts::button("&Declare it", "declare");
  auto* const row =
      parts::boxed(parts::row({{"The hand moves for a &pixel by", pixel_}, declareButton, parts::spring()}));
  row->setVisible(mouse);
  auto* const chooseButton = parts::button("Choose a &file …", "choose-calibration");
  auto* const cancel = new QDialogButtonBox(QDialogButtonBox::Cancel);
  fault_->hide();
  setLayout(parts::column({text, row, chooseButton, fault_, cancel}));
  connect(declareButton, &QPushButton::clicked, this, &CalibrationDialog::declare);
  connect(chooseButton, &QPushButton::clicked, this, &CalibrationDialog::choose);
  connect(cancel, &QDialogButtonBox::rejected, this, &QDialog::reject);
}

void CalibrationDialog::declare() {
  try {
    const recorder::DeviceInfo device = recorder::MouseDevice(std::make_shared<recorder::MouseInput>()).info();
    const recorder::Calibration made = recorder::declaredCalibration(device, 1e-3 * pixel_->value());
    std::error_code ignored;  // writing says what is wrong
    std::filesystem::create_directories(target_.parent_path(), ignored);
    recorder::writeText(target_, recorder::calibrationText(made, false), true);
  } catch (const Error& error) {
    return parts::say(fault_, QString::fromStdString(problemText(error)));
  }
  file_ = target_;
  accept();
}

void CalibrationDialog::choose() {
  const QString chosen =
      QFileDialog::getOpenFileName(this, "A calibration", {}, "Calibrations (*.json);;All files (*)");
  if (chosen.isEmpty()) return;
  file_ = chosen.toStdString();
  accept();
}

}  // namespace calot::gui
