// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/trainer_window.h"

#include <chrono>
#include <iterator>
#include <QBoxLayout>
#include <QCoreApplication>
#include <QLabel>
#include <QMenuBar>
#include <QStackedWidget>
#include <utility>

#include "gui/trainer/operation_view.h"
#include "gui/trainer/run_panel.h"
#include "gui/trainer/scenes_page.h"
#include "gui/words/problem_words.h"
#include "recorder/errors.h"

namespace calot::gui {
namespace {
constexpr int refreshPeriod = 50;  // ms
}

TrainerWindow::TrainerWindow(TrainerSetup setup, QWidget* parent)
    : QMainWindow(parent),
      setup_(std::move(setup)),
      problem_(new QLabel),
      stack_(new QStackedWidget),
      scenes_(new ScenesPage),
      operation_(new QWidget),
      view_(new OperationView(setup_.mouse, setup_.scope)),
      panel_(new RunPanel(setup_.settings.attempt.mode, setup_.mouse != nullptr, setup_.scope != nullptr)) {
  setWindowTitle("Calot trainer");
  problem_->setObjectName("problem");
  problem_->setTextFormat(Qt::PlainText);
  problem_->setWordWrap(true);
  problem_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  problem_->setStyleSheet(
      "QLabel { background: #fbe3d6; color: #5a1e00; border-left: 6px solid #d55e00; padding: 8px; }");
  problem_->hide();
  auto* const row = new QHBoxLayout(operation_);
  row->setContentsMargins(0, 0, 0, 0);
  row->addWidget(view_, 1);
  row->addWidget(panel_);
  stack_->addWidget(scenes_);
  stack_->addWidget(operation_);
  auto* const centre = new QWidget;
  auto* const layout = new QVBoxLayout(centre);
  layout->addWidget(problem_);
  layout->addWidget(stack_, 1);
  setCentralWidget(centre);
  buildMenus();
  resize(sizeHint());  // not what a small screen would make of it: the picture has 1280 by 720
  scenes_->setScenes(setup_.scenes);

  connect(scenes_, &ScenesPage::chosen, this, &TrainerWindow::openScene);
  connect(view_, &OperationView::mountRequested, this, &TrainerWindow::mount);
  connect(view_, &OperationView::pauseRequested, this, &TrainerWindow::togglePause);
  connect(view_, &OperationView::handSwitched, this, &TrainerWindow::refresh);
  connect(view_, &OperationView::pointerHeld, this, [this](bool held) {
    if (held) windowLeft_ = false;
    refresh();
  });
  connect(view_, &ScenePictureWidget::pictureShown, this, [this](quint64 step) {
    if (!session_) return;
    const std::optional<double> delay = session_->shown(step);
    rate_.shown(std::chrono::steady_clock::now(), view_->side(), delay);
  });
  connect(panel_, &RunPanel::pauseRequested, this, &TrainerWindow::togglePause);
  connect(panel_, &RunPanel::finishRequested, finishAction_, &QAction::trigger);
  connect(panel_, &RunPanel::restartRequested, restartAction_, &QAction::trigger);
  connect(panel_, &RunPanel::scenesRequested, this, &TrainerWindow::chooseScene);
  connect(panel_, &RunPanel::backRequested, this, [this](double time) {
    if (!session_ || !session_->goBack(time)) return;
    refresh();
    view_->setFocus();
  });
  connect(&timer_, &QTimer::timeout, this, &TrainerWindow::refresh);
  timer_.setInterval(refreshPeriod);
  refresh();
}

TrainerWindow::~TrainerWindow() { endSession(); }

void TrainerWindow::buildMenus() {
  QMenu* const attempt = menuBar()->addMenu("&Attempt");
  pauseAction_ =
      attempt->addAction("&Pause or go on", QKeySequence(Qt::CTRL | Qt::Key_P), this, [this] { togglePause(); });
  pauseAction_->setVisible(setup_.settings.attempt.mode == recorder::Mode::practice);
  finishAction_ = attempt->addAction("&End", QKeySequence(Qt::CTRL | Qt::Key_E), this, [this] {
    if (session_) session_->finish();
    refresh();
  });
  restartAction_ = attempt->addAction("Start a&gain", QKeySequence(Qt::CTRL | Qt::Key_R), this, [this] {
    if (session_) session_->start();
    refresh();
    view_->setFocus();
  });
  attempt->addAction("&Other scene", QKeySequence(QKeySequence::Open), this, [this] { chooseScene(); });
  attempt->addAction("&Quit", QKeySequence(Qt::CTRL | Qt::Key_Q), this, [this] { close(); });
  QMenu* const look = menuBar()->addMenu("&View");
  look->addAction("&Full screen", QKeySequence(Qt::Key_F11), this,
                  [this] { setWindowState(windowState() ^ Qt::WindowFullScreen); });
  look->addAction("&Operation", QKeySequence(Qt::Key_F6), this, [this] { view_->setFocus(); });
}

void TrainerWindow::begin(recorder::LoadedScene scene) {
  endSession();
  problem_->hide();
  setWindowTitle(QString::fromStdString(scene.description.name) + QString::fromUtf8(" – Calot trainer"));
  TrainingSettings settings = setup_.settings;
  settings.scene = std::move(scene);
  settings.firstPicture = std::chrono::seconds(5);
  view_->showText("Getting ready …");
  rate_ = {};
  session_ = std::make_unique<TrainingSession>(
      std::move(settings), setup_.input,
      [view = view_](std::shared_ptr<const SceneView> seen) { view->showView(std::move(seen)); });
  session_->start();
  stack_->setCurrentWidget(operation_);
  view_->setFocus();
  timer_.start();
  refresh();
}

bool TrainerWindow::openScene(const QString& file) {
  try {
    begin(recorder::loadScene(file.toStdString()));
    return true;
  } catch (const Error& error) {
    showProblem(QString::fromStdString(problemText(error)));
    return false;
  }
}

void TrainerWindow::chooseScene() {
  endSession();
  setWindowTitle("Calot trainer");
  problem_->hide();
  stack_->setCurrentWidget(scenes_);
  scenes_->focusList();
  refresh();
}

void TrainerWindow::endSession() {
  timer_.stop();
  view_->setActive(false);
  if (!session_) return;
  // Its thread shows views: it ends before the picture is cleared. The last attempt is reported when it has ended.
  session_->stop();
  std::vector<std::string> lines = session_->recorded();
  recorded_.insert(recorded_.end(), std::make_move_iterator(lines.begin()), std::make_move_iterator(lines.end()));
  if (rate_.pictures() > 0) {
    recorded_.push_back(session_->scene().name + ": " +
                        rate_.report(view_->width(), view_->height(), view_->drawnBy()));
  }
  session_.reset();
}

std::vector<std::string> TrainerWindow::endAndReport() {
  endSession();
  return recorded_;
}

void TrainerWindow::togglePause() {
  if (!session_) return;
  windowLeft_ = false;
  if (session_->resume())
    view_->setFocus();
  else
    session_->pause();
  refresh();
}

/// Hands that nobody can reach any more are not to go on: practice pauses. An assessment has no pause; what is pressed
/// is let go (OperationView), and the panel says so. Hands of another device are where they were.
void TrainerWindow::changeEvent(QEvent* event) {
  QMainWindow::changeEvent(event);
  if (event->type() != QEvent::ActivationChange || isActiveWindow() || !setup_.mouse || !session_) return;
  const Stage stage = session_->status().stage;
  if (stage != Stage::running) return;
  windowLeft_ = true;
  session_->pause();
  refresh();
}

Pointer TrainerWindow::pointer(const TrainingStatus& status) const {
  if (!setup_.mouse || (status.stage != Stage::running && !windowLeft_)) return Pointer::elsewhere;
  if (view_->holdsPointer()) return Pointer::held;
  return windowLeft_ ? Pointer::windowLeft : Pointer::free;
}

void TrainerWindow::mount(InstrumentKind instrument, bool otherHand) {
  if (!session_) return;
  const Hand driven = setup_.mouse ? setup_.mouse->hand() : Hand::right;
  session_->mount(otherHand ? (driven == Hand::right ? Hand::left : Hand::right) : driven, instrument);
}

void TrainerWindow::showProblem(const QString& message) {
  problem_->setText(message);
  problem_->setVisible(!message.isEmpty());
}

void TrainerWindow::refresh() {
  const bool open = session_ != nullptr;
  for (QAction* const action : {pauseAction_, finishAction_, restartAction_}) action->setEnabled(open);
  if (!open) return;
  const TrainingStatus status = session_->status();
  view_->setActive(status.stage == Stage::running);
  rate_.setRunning(status.stage == Stage::running);
  const SceneDescription& scene = session_->scene();
  const std::optional<Hand> driven = setup_.mouse ? std::optional(setup_.mouse->hand()) : std::nullopt;
  view_->showOver(status.stage == Stage::countdown ? QString::number(status.countdown) : QString());
  panel_->show(status, panelText(status, scene, session_->summary(), session_->mode(), driven, pointer(status)),
               tickLength * scene.ticksPerStep);
  if (QString::fromStdString(status.problem) != problem_->text() || status.problem.empty() == problem_->isVisible())
    showProblem(QString::fromStdString(status.problem));
}

void TrainerWindow::savePicture(const QString& file) {
  QCoreApplication::processEvents();
  if (!grab().save(file, "PNG"))
    throw Error(ErrorKind::failure, Where{file.toStdString()}, "cannot write the picture; does the folder exist?");
}

}  // namespace calot::gui
