// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QWidget>
#include <vector>

#include "gui/trainer/scene_choice.h"
#include "gui/trainer/training_history.h"

class QLabel;
class QListWidget;
class QPushButton;

namespace calot::gui {

/// What is seen when no scene is given: greets, and offers the course's tasks and all other scenes with their pictures;
/// of the one that is chosen, what the trainee has done so far.
class ScenesPage : public QWidget {
  Q_OBJECT
 public:
  /// @param practice the controls can be learnt @param demonstrates a performer can be watched
  ScenesPage(bool practice, bool demonstrates, QWidget* parent = nullptr);
  void setScenes(const std::vector<SceneChoice>& scenes);
  /// @param history none: nobody's is known
  void setHistory(std::optional<std::vector<PastAttempt>> history);
  void focusList();

 signals:
  void chosen(const QString& file);
  void tutorialRequested(const QString& file);       ///< the controls, on this scene
  void demonstrationRequested(const QString& file);  ///< a performer, on this scene

 private:
  void showTexts();
  void showPast();
  [[nodiscard]] QString chosenFile() const;

  std::vector<SceneChoice> choices_;
  std::optional<std::vector<PastAttempt>> history_;
  QListWidget *list_, *past_;
  QLabel* pastTitle_;
  QWidget* pastSide_;
  QPushButton *begin_, *tutorial_, *demonstration_;
};

}  // namespace calot::gui
