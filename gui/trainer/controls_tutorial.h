// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QString>
#include <vector>

#include "gui/trainer/training_session.h"

namespace calot::gui {

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
