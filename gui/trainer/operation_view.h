// SPDX-License-Identifier: GPL-3.0-or-later
// Key bindings in the picture of the operation.
#pragma once

#include <memory>
#include <optional>
#include <QPointF>
#include <string>
#include <vector>

#include "gui/trainer/picture_overlay.h"
#include "gui/view/scene_picture_widget.h"
#include "recorder/sources/devices/window_input.h"
#include "sim/scene/samples.h"

namespace calot::gui {

struct KeyAction {
  enum class Kind : std::uint8_t {
    control,     ///< does it while it is held
    switchHand,  ///< passes mouse and keyboard to the other hand
    toggleLock,
    mount,       ///< exchanges an instrument
    retraction,  ///< asks the assistant for more or less
    scope,       ///< moves the endoscope while it is held
    scopePedal,  ///< while it is held, the mouse moves the endoscope
    pause,       ///< or goes on
  };
  Kind kind = Kind::control;
  recorder::MouseControl control = recorder::MouseControl::right;
  recorder::ScopeControl scope = recorder::ScopeControl::right;
  InstrumentKind instrument = InstrumentKind::none;
  bool otherHand = false;  ///< mount: not the hand that is driven
  bool more = false;       ///< retraction
};

/// @param key of Qt::Key
[[nodiscard]] std::optional<KeyAction> actionOf(int key);

/// For the page of keys: "Space" and "the other hand".
struct KeyHelp {
  std::string keys;
  std::string what;
  bool assistant = false;  ///< only where the scene has one
};
/// @param mouse both hands are driven by mouse and keyboard; else only instruments are exchanged and runs held
/// @param scope keys move the endoscope @param pauses the mode has a pause
[[nodiscard]] std::vector<KeyHelp> keyHelp(bool mouse, bool scope, bool pauses);

/// Motions of a pointer that is put back to the middle now and then, so that it never comes to an edge. Positions of
/// before are still under way when it was put back: they count as what they are.
class PointerTrack {
 public:
  /// The next position is where the pointer begins.
  void begin() {
    last_.reset();
    put_.reset();
  }
  /// The pointer was put there: one of the next positions is that, or what came of it.
  void put(QPointF there) { put_ = there; }
  [[nodiscard]] bool isPutBack() const { return put_.has_value(); }
  /// @return by how much the pointer was moved
  QPointF moved(QPointF now);

 private:
  std::optional<QPointF> last_, put_;
};

/// The picture of the operation, and the hands of whoever looks at it: what mouse and keyboard do over it goes to a
/// MouseInput while it is active. Where the mouse drives a hand, the picture holds the pointer: it is hidden, and comes
/// to no edge. Escape, Tab, or whatever else takes the keyboard from the picture, frees it; a click holds it again.
class OperationView : public ScenePictureWidget {
  Q_OBJECT
 public:
  /// @param mouse null: another device drives; keys still exchange instruments and hold the run
  /// @param scope null: the endoscope is fixed, or held by another
  explicit OperationView(std::shared_ptr<recorder::MouseInput> mouse,
                         std::shared_ptr<recorder::ScopeInput> scope = nullptr);
  ~OperationView() override;

  /// True if a run accepts input.
  void setActive(bool active);
  /// Does the picture hold the pointer?
  [[nodiscard]] bool holdsPointer() const { return holds_; }
  /// It drives a hand, and the window system did not let it be put back to the middle.
  [[nodiscard]] bool isPointerBounded() const { return bounded_; }
  [[nodiscard]] PictureOverlay& over() { return *over_; }

  [[nodiscard]] QSize sizeHint() const override { return {1280, 720}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {480, 270}; }

 signals:
  void mountRequested(calot::InstrumentKind instrument, bool otherHand);
  void retractionRequested(bool more);
  void pauseRequested();
  void handSwitched();
  void pointerHeld(bool held);

 protected:
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override { mousePressEvent(event); }
  void wheelEvent(QWheelEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void focusInEvent(QFocusEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void act(const KeyAction& action, bool held);
  void releaseAll();
  void holdButton(Qt::MouseButton button, bool held);
  void holdPointer(bool hold);
  void putPointerBack();

  std::shared_ptr<recorder::MouseInput> mouse_;
  std::shared_ptr<recorder::ScopeInput> scope_;
  bool active_ = false, holds_ = false, bounded_ = false;
  PointerTrack pointer_;
  PictureOverlay* over_;
};

}  // namespace calot::gui
