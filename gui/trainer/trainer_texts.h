// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the trainer's window, from a session's status. Numbers follow the user's locale. No window.
#pragma once

#include <array>
#include <optional>
#include <QString>
#include <string>
#include <vector>

#include "gui/trainer/attempt_monitor.h"
#include "gui/trainer/training_session.h"
#include "sim/scene/description.h"

namespace calot::gui {

/// Beside the picture. Empty: not said.
struct PanelText {
  QString stage;      ///< "● recording", "❚❚ paused", ...
  QString mode;       ///< "practice", "assessment", with "synthetic" where no person acts
  QString time;       ///< "1:02.5"
  QString late;       ///< one sentence where forces come late at present
  QString technical;  ///< figures of that, for who looks after the computer
  QString phase;
  QString assistant;  ///< how far it retracts; empty where the scene has none that can be asked
  QString score;      ///< critical view and errors; practice only
  QString hint;       ///< practice only: what to do next, or what a performer does
  QString pointer;    ///< who has the mouse, and how that changes
  std::array<QString, handCount> hand;
  QString result;  ///< of an attempt that has ended: outcome and file
};

/// Position of the mouse, while it drives a hand.
enum class Pointer {
  elsewhere,   ///< another device drives, or nothing runs
  held,        ///< the picture holds it
  bounded,     ///< it drives, and stops at the screen's edge: the window system lets no program move it
  free,        ///< it runs and the picture does not hold it
  windowLeft,  ///< likewise, and the window has lost the keyboard
};

/// @param driven the hand that mouse and keyboard drive, if they do
[[nodiscard]] PanelText panelText(const TrainingStatus& status, const SceneDescription& scene,
                                  const std::string& summary, recorder::Mode mode, std::optional<Hand> driven,
                                  Pointer pointer = Pointer::elsewhere);

/// Minutes, seconds and tenths: "1:02.5".
[[nodiscard]] QString clockText(double seconds);
/// "0:41.2  cystic duct: clip half on", a critical one with "critical" before it.
[[nodiscard]] QString errorText(const analytics::ErrorLine& error);

/// Next instruction in an attempt of this scene, in one or two sentences: from what the procedure asks for and what has
/// been done of it. For practice; an assessment has no hints.
/// @param summary of the scene: what is said where it has no procedure
/// @param watched a performer acts: the text says to its watcher what it does
[[nodiscard]] std::string hintFor(const SceneDescription& scene, const std::string& summary,
                                  const AttemptFigures& figures, bool watched = false);

/// Remaining parts of the scene's procedure: "the procedure is at: clipping". Where it has no procedure, it is
/// the trainee who says, but whoever touched nothing has done nothing. Empty: all is done.
[[nodiscard]] std::string whatIsUndone(const SceneDescription& scene, const AttemptFigures& figures);

/// Asks for one control after the other, and sees in the attempt when it was used. Knows no window.
class ControlsTutorial {
 public:
  /// @param mouse both hands are driven by mouse and keyboard; else by another device
  explicit ControlsTutorial(bool mouse);

  /// Looks at the attempt. @param driven the hand that the mouse drives; else none
  /// @return whether what was asked for has just been done
  bool observe(const TrainingStatus& status, std::optional<Hand> driven);
  /// Goes on without.
  void skip();

  [[nodiscard]] std::size_t count() const { return lessons_.size(); }
  [[nodiscard]] std::size_t done() const { return at_; }  ///< or skipped
  [[nodiscard]] bool over() const { return at_ == lessons_.size(); }
  /// "Controls, 3 of 10. ✓ The wheel. Now: open the jaws: right button, or S."
  [[nodiscard]] QString text() const;

 private:
  /// State of the attempt when a control was requested.
  struct Begin {
    AttemptFigures figures;
    std::optional<Hand> driven;
  };
  struct Lesson {
    const char* name;                                                                     ///< "the wheel"
    const char* ask;                                                                      ///< one sentence
    bool (*byHand)(const AttemptFigures::Hand& before, const AttemptFigures::Hand& now);  ///< either did it; or null:
    bool (*used)(const Begin& begin, const TrainingStatus& now, std::optional<Hand> driven) = nullptr;
  };
  static std::vector<Lesson> lessonsFor(bool mouse);

  std::vector<Lesson> lessons_;
  std::size_t at_ = 0;
  bool learnt_ = false;  ///< the last one was used, not skipped
  std::optional<Begin> begin_;
};

}  // namespace calot::gui
