// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QPointF>

#include "gui/trainer/key_bindings.h"
#include "gui/view/scene_picture_widget.h"
#include "recorder/sources/devices/mouse_input.h"
#include "recorder/sources/devices/scope_input.h"

namespace calot::gui {

/// The picture of the operation, and the hands of whoever looks at it: what mouse and keyboard do over it goes to a
/// MouseInput while it is active. The pointer moves a hand only while it is over the picture, so that leaving it and
/// coming back elsewhere, or holding Ctrl, puts the mouse elsewhere without moving the hand.
class OperationView : public ScenePictureWidget {
  Q_OBJECT
 public:
  /// @param mouse null: another device drives; keys still exchange instruments and hold the run
  /// @param scope null: the endoscope is fixed, or held by another
  explicit OperationView(std::shared_ptr<recorder::MouseInput> mouse,
                         std::shared_ptr<recorder::ScopeInput> scope = nullptr, QWidget* parent = nullptr);

  /// Whether a run is there to take what is done.
  void setActive(bool active);

  [[nodiscard]] QSize sizeHint() const override { return {1280, 720}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {480, 270}; }

 signals:
  void mountRequested(calot::InstrumentKind instrument, bool otherHand);
  void pauseRequested();
  void handSwitched();

 protected:
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override { mousePressEvent(event); }
  void wheelEvent(QWheelEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;

 private:
  void press(const KeyAction& action);
  void release(const KeyAction& action);
  void releaseAll();
  void holdButton(Qt::MouseButton button, bool held);

  std::shared_ptr<recorder::MouseInput> mouse_;
  std::shared_ptr<recorder::ScopeInput> scope_;
  bool active_ = false;
  std::optional<QPointF> last_;  ///< of the pointer over the picture
};

}  // namespace calot::gui
