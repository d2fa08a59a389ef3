// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <QPoint>

#include "gui/view/scene_picture_widget.h"

namespace calot::gui {

/// A camera that turns around a point: what gravity calls up stays up.
class OrbitCamera {
 public:
  /// Beside the endoscope of a view, all of its surfaces in the picture.
  explicit OrbitCamera(const SceneView& view);

  void turn(double right, double up);  ///< rad
  void zoom(double factor);            ///< of the distance, which stays within what the scene makes of it
  /// Moves the point across the picture. @param right, down shares of the picture's height
  void shift(double right, double down);
  [[nodiscard]] CameraSample sample() const;
  [[nodiscard]] const Vec3& centre() const { return centre_; }
  [[nodiscard]] double distance() const { return distance_; }
  static constexpr double field = 0.7;  ///< vertical field of view (rad)

 private:
  [[nodiscard]] Vec3 back() const;  ///< from the point to the camera, unit

  Vec3 up_, ahead_, centre_;  ///< ahead_: horizontal, where angle_ is 0
  double angle_ = 0.0, pitch_ = 0.0, distance_ = 0.0, least_ = 0.0, most_ = 0.0;
};

/// The scene from anywhere: dragged with the mouse it turns, with the right button it moves, the wheel comes nearer;
/// so do arrows, Shift and arrows, plus and minus. Home goes back to where it began.
class FreeView : public ScenePictureWidget {
  Q_OBJECT
 public:
  FreeView();
  /// Any thread; returns at once. While hidden it draws nothing. @pre not null, changed by nobody any more
  void follow(std::shared_ptr<const SceneView> view);
  void home();
  /// Forgets the view and where it was looked at from, and shows a text.
  void forget(const QString& text);
  [[nodiscard]] std::optional<CameraSample> camera() const;

 protected:
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  void move(const std::function<void(OrbitCamera&)>& change);
  [[nodiscard]] std::shared_ptr<const SceneView> seen() const;  ///< @pre guard_ is held, there is a view

  mutable std::mutex guard_;
  bool draws_ = false;  ///< it is seen
  std::shared_ptr<const SceneView> newest_;
  std::optional<OrbitCamera> camera_;
  QPoint last_;
};

}  // namespace calot::gui
