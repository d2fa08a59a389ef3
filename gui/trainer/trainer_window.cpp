// SPDX-License-Identifier: GPL-3.0-or-later
// The trainer's menus and their keys.

#include "gui/trainer/trainer_window.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <QEvent>
#include <QLabel>
#include <QMenuBar>
#include <QScreen>
#include <QStackedWidget>
#include <utility>

#include "gui/attempt/widget_parts.h"
#include "gui/trainer/calibration_dialog.h"
#include "gui/trainer/end_page.h"
#include "gui/trainer/operation_view.h"
#include "gui/trainer/run_panel.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::gui {
namespace {
constexpr int refreshPeriod = 50;  // ms
constexpr int faultShown = 10000;  // ms, of what stops no attempt

/// Calibration of mouse and keyboard of this station, as the trainer's window declares it.
std::filesystem::path declaredCalibration() {
  return recorder::userFolder("XDG_DATA_HOME", ".local/share") / "calot" / "mouse-calibration.json";
}
}  // namespace

TrainerWindow::TrainerWindow(TrainerSetup setup)
    : setup_(std::move(setup)),
      problem_(parts::selectableLabel("problem")),
      stack_(new QStackedWidget),
      scenes_(new ScenesPage(setup_.demonstration != nullptr)),
      operation_(new QWidget),
      view_(new OperationView(setup_.mouse, setup_.scope)),
      panel_(new RunPanel(setup_.mouse != nullptr, setup_.scope != nullptr)),
      end_(new EndPage({setup_.cohort, setup_.settings.threads})) {
  setWindowTitle("Calot trainer");
  problem_->setStyleSheet(
      "QLabel { background: #fbe3d6; color: #5a1e00; border-left: 6px solid #d55e00; padding: 8px; }");
  problem_->hide();
  operation_->setLayout(parts::bare(parts::row({{view_, 1}, panel_})));
  for (QWidget* const page : {static_cast<QWidget*>(scenes_), operation_, static_cast<QWidget*>(end_)})
    stack_->addWidget(page);
  auto* const centre = new QWidget;
  centre->setLayout(parts::column({problem_, {stack_, 1}}));
  setCentralWidget(centre);
  buildMenus();
  // The stack's own hint is as high as its texts need, however high the picture is.
  const QSize around = sizeHint() - stack_->sizeHint();
  resize((operation_->sizeHint() + around).boundedTo(screen()->availableSize()));
  scenes_->setScenes(setup_.scenes);
  connectPages();
  showMode({});
  connect(&timer_, &QTimer::timeout, this, &TrainerWindow::refresh);
  timer_.setInterval(refreshPeriod);
  readHistory();
  refresh();
}

TrainerWindow::~TrainerWindow() { endSession(); }

void TrainerWindow::connectPages() {
  connect(scenes_, &ScenesPage::chosen, this, &TrainerWindow::openScene);
  connect(scenes_, &ScenesPage::modeChosen, this, [this](recorder::Mode mode) { setMode(mode, {}); });
  connect(scenes_, &ScenesPage::calibrationRequested, this, &TrainerWindow::askForCalibration);
  connect(view_, &OperationView::mountRequested, this, &TrainerWindow::mount);
  connect(view_, &OperationView::retractionRequested, this, [this](bool more) {
    if (session_) session_->askForRetraction(more);
  });
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
  connect(panel_, &RunPanel::restartRequested, this, &TrainerWindow::restart);
  connect(panel_, &RunPanel::scenesRequested, this, &TrainerWindow::chooseScene);
  connect(panel_, &RunPanel::backRequested, this, &TrainerWindow::goBack);
  connect(panel_, &RunPanel::announced, this, [this](const QString& subject, const QString& words) {
    if (aloudAction_->isChecked() && voice_ != nullptr) voice_->say(subject, words);
  });
  connect(end_, &EndPage::againRequested, this, &TrainerWindow::restart);
  connect(end_, &EndPage::nextRequested, this, &TrainerWindow::nextTask);
  connect(end_, &EndPage::scenesRequested, this, &TrainerWindow::chooseScene);
  connect(end_, &EndPage::backRequested, this, &TrainerWindow::goBack);
  connect(end_, &EndPage::problem, this, &TrainerWindow::showProblem);
  connect(end_, &EndPage::stored, this, &TrainerWindow::readHistory);
}

void TrainerWindow::begin(recorder::LoadedScene scene, Purpose purpose) {
  open(std::move(scene), purpose);
  session_->start();
  showOperation();
}

void TrainerWindow::beginBranch(recorder::LoadedScene scene, const std::filesystem::path& recording, double time) {
  open(std::move(scene), Purpose::own);
  session_->branchOf(recording, time);
  showOperation();
}

/// Makes the scene's session.
void TrainerWindow::open(recorder::LoadedScene scene, Purpose purpose) {
  endSession();
  problem_->hide();
  setWindowTitle(QString::fromStdString(scene.description.name) + QString::fromUtf8(" – Calot trainer"));
  TrainingSettings settings = setup_.settings;
  settings.scene = std::move(scene);
  settings.firstPicture = std::chrono::seconds(5);
  purpose_ = purpose;
  tutorial_.reset();
  if (purpose != Purpose::own) settings.attempt.mode = recorder::Mode::practice;
  if (purpose == Purpose::controls) tutorial_.emplace(setup_.mouse != nullptr);
  panel_->showHintIn(tutorial_ ? view_->over().sheet().layout() : nullptr);
  if (purpose == Purpose::demonstration) {
    settings.attempt.participant.clear();  // no attempt of theirs
    settings.folder.clear();
  }
  view_->showText("Getting ready …");
  rate_ = {};
  ended_.clear();
  session_ = std::make_unique<TrainingSession>(
      std::move(settings), purpose == Purpose::demonstration ? setup_.demonstration : setup_.input,
      [view = view_](std::shared_ptr<const SceneView> seen) { view->showView(std::move(seen)); });
  timer_.start();
}

bool TrainerWindow::openScene(const QString& file, Purpose purpose) {
  try {
    begin(recorder::loadScene(file.toStdString()), purpose);
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
  end_->leave();
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

void TrainerWindow::restart() {
  if (!session_) return;
  session_->start();
  if (tutorial_) tutorial_.emplace(setup_.mouse != nullptr);
  showOperation();
}

void TrainerWindow::goBack(double time) {
  if (session_ && session_->goBack(time)) showOperation();
}

void TrainerWindow::showOperation() {
  stack_->setCurrentWidget(operation_);
  end_->leave();
  refresh();
  view_->setFocus();
}

std::optional<std::size_t> TrainerWindow::taskAfterThis() const {
  const auto at = std::find_if(setup_.scenes.begin(), setup_.scenes.end(),
                               [&](const SceneChoice& scene) { return scene.name == session_->scene().name; });
  if (at == setup_.scenes.end() || at->title.empty()) return std::nullopt;
  // Whoever learnt the controls, or watched, does this task first.
  const auto next = purpose_ == Purpose::own ? at + 1 : at;
  if (next == setup_.scenes.end() || next->title.empty()) return std::nullopt;
  return static_cast<std::size_t>(next - setup_.scenes.begin());
}

void TrainerWindow::nextTask() {
  if (!session_) return;
  if (const std::optional<std::size_t> next = taskAfterThis())
    openScene(QString::fromStdString(setup_.scenes[*next].file.string()));
}

/// All pages are of this mode from now on.
void TrainerWindow::showMode(const QString& note) {
  const recorder::Mode mode = setup_.settings.attempt.mode;
  scenes_->showMode(mode, note);
  panel_->setMode(mode);
  end_->setMode(mode);
  pauseAction_->setVisible(mode == recorder::Mode::practice);
}

/// The calibration that was declared on this station, where there is one, if none is named.
void TrainerWindow::setMode(recorder::Mode mode, const std::filesystem::path& calibration) {
  std::error_code ignored;
  const bool declared = setup_.mouse != nullptr && std::filesystem::exists(declaredCalibration(), ignored);
  const std::filesystem::path file =
      calibration.empty() && declared && mode == recorder::Mode::assessment ? declaredCalibration() : calibration;
  try {
    setup_.input->setMode(mode, file);
    setup_.settings.attempt.mode = mode;
    showMode(file.empty() ? QString() : "Calibration: " + QString::fromStdString(file.string()));
  } catch (const Error& error) {
    showMode("No assessment yet: " + QString::fromStdString(problemText(error)) + '.');
  }
}

void TrainerWindow::askForCalibration() {
  CalibrationDialog dialog(setup_.mouse != nullptr, declaredCalibration(), this);
  if (dialog.exec() == QDialog::Accepted) setMode(recorder::Mode::assessment, dialog.file());
}

void TrainerWindow::readHistory() {
  const std::string& participant = setup_.settings.attempt.participant;
  if (setup_.cohort.empty() || participant.empty()) return;
  background_.run(
      [this, cohort = setup_.cohort, participant] {
        return [this, history = historyIn(cohort, participant)] { scenes_->setHistory(history); };
      },
      [this](const QString& reason) { showProblem(reason); });
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
  if (event->type() != QEvent::ActivationChange || isActiveWindow() || !session_ || !driven()) return;
  if (session_->status().stage != Stage::running) return;
  windowLeft_ = true;
  session_->pause();
  refresh();
}

std::optional<Hand> TrainerWindow::driven() const {
  if (!setup_.mouse || purpose_ == Purpose::demonstration) return std::nullopt;
  return setup_.mouse->hand();
}

Pointer TrainerWindow::pointer(const TrainingStatus& status) const {
  const bool drives = status.stage == Stage::running || status.stage == Stage::ready;
  if (!driven() || (!drives && !windowLeft_)) return Pointer::elsewhere;
  if (view_->holdsPointer()) return view_->isPointerBounded() ? Pointer::bounded : Pointer::held;
  return windowLeft_ ? Pointer::windowLeft : Pointer::free;
}

void TrainerWindow::mount(InstrumentKind instrument, bool otherHand) {
  if (!session_) return;
  const Hand own = driven().value_or(Hand::right);
  session_->mount(otherHand ? (own == Hand::right ? Hand::left : Hand::right) : own, instrument);
}

void TrainerWindow::showProblem(const QString& message) { parts::say(problem_, message); }

void TrainerWindow::setAloud(bool on) {
  const auto fail = [this](const QString& why) {
    voiceFault_ = "Nothing can be read aloud: " + why;
    showProblem(voiceFault_);
    aloudAction_->setChecked(false);
    voice_->deleteLater();  // the next try is with another one
    voice_ = nullptr;
    QTimer::singleShot(faultShown, this, [this] { voiceFault_.clear(); });
  };
  aloudAction_->setChecked(on);
  if (!on) {
    if (voice_ != nullptr) voice_->stop();
    return;
  }
  voiceFault_.clear();
  if (voice_ == nullptr) {
    voice_ = new Voice(this);
    connect(voice_, &Voice::failed, this, fail);
  }
  if (const QString why = voice_->fault(); !why.isEmpty()) fail(why);
}

void TrainerWindow::refresh() {
  const bool open = session_ != nullptr;
  for (QAction* const action : {pauseAction_, finishAction_, restartAction_}) action->setEnabled(open);
  skipAction_->setEnabled(open && tutorial_);
  if (!open) return;
  const TrainingStatus status = session_->status();
  const bool drives = status.stage == Stage::running || status.stage == Stage::ready;
  view_->setActive(drives && purpose_ != Purpose::demonstration);
  rate_.setRunning(status.stage == Stage::running);
  const SceneDescription& scene = session_->scene();
  showOver(status);
  PanelText text = panelText(status, scene, session_->summary(), session_->mode(), driven(), pointer(status));
  if (tutorial_) {
    tutorial_->observe(status, driven());
    if (drives || status.stage == Stage::paused) text.hint = tutorial_->text();
  }
  view_->over().sheet().setVisible(tutorial_ && !text.hint.isEmpty());
  panel_->show(status, text, tickLength * scene.ticksPerStep);
  if (status.stage == Stage::ended && status.attempt != ended_) showEnd(status, text.result);
  if (!status.problem.empty() || !end_->isVisible())
    showProblem(status.problem.empty() ? voiceFault_ : QString::fromStdString(status.problem));
}

/// Errors are a score: an assessment shows none.
void TrainerWindow::showOver(const TrainingStatus& status) {
  PictureOverlay& over = view_->over();
  over.showSentence(status.stage == Stage::ready ? "Time starts with your first motion" : QString());
  over.showCount(status.stage == Stage::countdown ? QString::number(status.countdown) : QString());
  const bool moves = status.stage == Stage::running || status.stage == Stage::ready;
  over.showInstruments(moves ? &status.figures : nullptr, session_->scene().verticalFieldOfView);
  const AttemptFigures& figures = status.figures;
  const bool another = status.attempt != noticedIn_;
  if (another) over.clearError();
  const bool news = !another && figures.noticed > noticed_ && status.stage == Stage::running;
  noticedIn_ = status.attempt;
  noticed_ = figures.noticed;
  if (!news || session_->mode() != recorder::Mode::practice) return;
  over.showError(*figures.latest);
  if (aloudAction_->isChecked() && voice_ != nullptr) voice_->say("error", over.error());
}

void TrainerWindow::showEnd(const TrainingStatus& status, const QString& result) {
  ended_ = status.attempt;
  if (status.figures.ticks == 0) return;
  stack_->setCurrentWidget(end_);
  end_->showAttempt(status,
                    {result, tickLength * session_->scene().ticksPerStep, purpose_, taskAfterThis().has_value()});
}

void TrainerWindow::buildMenus() {
  QMenu* const attempt = menuBar()->addMenu("&Attempt");
  pauseAction_ = attempt->addAction("&Pause or go on", Qt::CTRL | Qt::Key_P, this, &TrainerWindow::togglePause);
  pauseAction_->setVisible(setup_.settings.attempt.mode == recorder::Mode::practice);
  finishAction_ = attempt->addAction("&End", Qt::CTRL | Qt::Key_E, this, [this] {
    if (session_) session_->finish();
    refresh();
  });
  restartAction_ = attempt->addAction("Start a&gain", Qt::CTRL | Qt::Key_R, this, &TrainerWindow::restart);
  skipAction_ = attempt->addAction("&Skip this control", Qt::CTRL | Qt::Key_K, this, [this] {
    if (tutorial_) tutorial_->skip();
    refresh();
  });
  attempt->addAction("&Other scene", QKeySequence::Open, this, &TrainerWindow::chooseScene);
  attempt->addAction("&Quit", Qt::CTRL | Qt::Key_Q, this, &TrainerWindow::close);
  QMenu* const look = menuBar()->addMenu("&View");
  look->addAction("&Full screen", Qt::Key_F11, this, [this] { setWindowState(windowState() ^ Qt::WindowFullScreen); });
  aloudAction_ = look->addAction("Read &aloud", Qt::CTRL | Qt::Key_L, this, &TrainerWindow::setAloud);
  aloudAction_->setToolTip("What the panel asks for and says is spoken, too");
  aloudAction_->setCheckable(true);
  QAction* const technical =
      look->addAction("&Technical figures", Qt::CTRL | Qt::Key_T, panel_, &RunPanel::setTechnical);
  technical->setToolTip("How punctual forces are, for who looks after this computer");
  technical->setCheckable(true);
  look->addAction("&Operation", Qt::Key_F6, this, [this] { view_->setFocus(); });
}

}  // namespace calot::gui
