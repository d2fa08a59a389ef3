// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <QImage>
#include <QWidget>
#include <string>

#include "gui/render/graphics.h"
#include "gui/view/picture_loop.h"

namespace calot::gui {

/// Shows scene views, rendered off screen in interactive quality at the widget's size on a separate thread: the GUI
/// thread only copies finished pictures to the screen. Views that arrive faster than they can be rendered are skipped.
class ScenePictureWidget : public QWidget {
  Q_OBJECT
 public:
  /// @param drawers how many views are drawn at a time. @param rate pictures a second that are worth a smaller size,
  /// which is scaled up on the screen; 0: none (PictureLoop)
  explicit ScenePictureWidget(QWidget* parent = nullptr, std::size_t drawers = 1, double rate = 0.0);
  ~ScenePictureWidget() override;

  /// Any thread; returns at once. @pre not null, changed by nobody any more
  void showView(std::shared_ptr<const SceneView> view);
  /// Shows a text instead of a picture, until the next view.
  void showText(const QString& text);

  /// Number of pictures shown so far.
  [[nodiscard]] quint64 shown() const { return shown_; }
  /// Sets the graphics of such widgets, from the next one made on; a graphics card where there is one, at
  /// first. GUI thread.
  static void drawBy(Graphics graphics);
  /// Description of the renderer (Renderer::graphics()); empty before the first picture.
  [[nodiscard]] std::string drawnBy() const;

  /// The picture on the screen; null before the first one.
  [[nodiscard]] const QImage& picture() const { return picture_; }
  /// Its share of the size that it is shown in; 1 before the first one.
  [[nodiscard]] double side() const;

  [[nodiscard]] QSize sizeHint() const override { return {640, 400}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {160, 100}; }

 signals:
  /// A picture came on the screen. @param time since the attempt's start (s)
  void pictureShown(quint64 step, double time);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void takePicture();
  void takeFailure(const QString& text);

  QImage picture_;
  QString text_;
  quint64 shown_ = 0;
  bool awaits_ = false;  ///< a view was given after the last text

  mutable std::mutex mutex_;
  std::string drawnBy_;
  ScenePicture newest_;                ///< drawn and not yet on the screen
  std::unique_ptr<PictureLoop> loop_;  // last: its thread uses what is above
};

}  // namespace calot::gui
