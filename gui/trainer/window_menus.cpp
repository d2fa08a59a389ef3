// SPDX-License-Identifier: GPL-3.0-or-later
// The trainer's menus and their keys.
#include <QMenuBar>

#include "gui/trainer/operation_view.h"
#include "gui/trainer/trainer_window.h"

namespace calot::gui {

void TrainerWindow::buildMenus() {
  QMenu* const attempt = menuBar()->addMenu("&Attempt");
  pauseAction_ =
      attempt->addAction("&Pause or go on", QKeySequence(Qt::CTRL | Qt::Key_P), this, [this] { togglePause(); });
  pauseAction_->setVisible(setup_.settings.attempt.mode == recorder::Mode::practice);
  finishAction_ = attempt->addAction("&End", QKeySequence(Qt::CTRL | Qt::Key_E), this, [this] {
    if (session_) session_->finish();
    refresh();
  });
  restartAction_ = attempt->addAction("Start a&gain", QKeySequence(Qt::CTRL | Qt::Key_R), this, [this] { restart(); });
  skipAction_ = attempt->addAction("&Skip this control", QKeySequence(Qt::CTRL | Qt::Key_K), this, [this] {
    if (tutorial_) tutorial_->skip();
    refresh();
  });
  attempt->addAction("&Other scene", QKeySequence(QKeySequence::Open), this, [this] { chooseScene(); });
  attempt->addAction("&Quit", QKeySequence(Qt::CTRL | Qt::Key_Q), this, [this] { close(); });
  QMenu* const look = menuBar()->addMenu("&View");
  look->addAction("&Full screen", QKeySequence(Qt::Key_F11), this,
                  [this] { setWindowState(windowState() ^ Qt::WindowFullScreen); });
  aloudAction_ = look->addAction("Read &aloud");
  aloudAction_->setShortcut(QKeySequence(Qt::CTRL | Qt::Key_L));
  aloudAction_->setToolTip("What the panel asks for and says is spoken, too");
  aloudAction_->setCheckable(true);
  connect(aloudAction_, &QAction::triggered, this, &TrainerWindow::setAloud);
  look->addAction("&Operation", QKeySequence(Qt::Key_F6), this, [this] { view_->setFocus(); });
}

}  // namespace calot::gui
