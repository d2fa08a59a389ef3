// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "gui/trainer/scene_choice.h"

class QListWidget;
class QPushButton;

namespace calot::gui {

/// What is seen when no scene is given: greets, and offers the scenes.
class ScenesPage : public QWidget {
  Q_OBJECT
 public:
  explicit ScenesPage(QWidget* parent = nullptr);
  void setScenes(const std::vector<SceneChoice>& scenes);
  void focusList();

 signals:
  void chosen(const QString& file);

 private:
  void choose();

  QListWidget* list_;
  QPushButton* begin_;
};

}  // namespace calot::gui
