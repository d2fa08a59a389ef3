// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <QFrame>
#include <QPointF>
#include <QRectF>
#include <QTimer>
#include <QWidget>

#include "gui/trainer/attempt_monitor.h"

namespace calot::gui {

/// Direction of an instrument that is out of the picture: a unit vector across the picture, right and
/// down; none where its tip is seen.
/// @param tip p_CI: right, down, away from the endoscope (m)
/// @param size of the picture (pixels) @param verticalFieldOfView rad
[[nodiscard]] std::optional<QPointF> directionOutside(const Vec3& tip, QSizeF size, double verticalFieldOfView);

/// Over the picture of the operation: a sheet with the controls' tutorial, a countdown, a sentence, an error in words
/// when it happens, and at the rim an arrow towards each instrument that is out of the picture. Takes no mouse.
class PictureOverlay : public QWidget {
  Q_OBJECT
 public:
  explicit PictureOverlay(QWidget* picture);

  /// A sheet with the tutorial's title; its layout takes what else stands there.
  [[nodiscard]] QFrame& sheet() { return *sheet_; }
  /// Large, in the middle: "3". Empty: nothing.
  void showCount(const QString& text);
  /// A sentence below the picture, until another is shown. Empty: nothing.
  void showSentence(const QString& text);
  /// An error for a few seconds, instead of the sentence.
  void showError(const analytics::ErrorLine& error);
  void clearError();
  /// @param figures of the attempt; null: no instruments
  void showInstruments(const AttemptFigures* figures, double verticalFieldOfView);

  [[nodiscard]] const QString& count() const { return count_; }
  [[nodiscard]] const QString& error() const { return error_; }
  /// Direction of each hand's arrow; none: no arrow.
  [[nodiscard]] const std::array<std::optional<QPointF>, handCount>& arrows() const { return arrow_; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  QString count_, sentence_, error_;
  Severity severity_ = Severity::minor;
  std::array<std::optional<QPointF>, handCount> arrow_;
  QTimer errorShown_;
  QFrame* sheet_;
};

}  // namespace calot::gui
