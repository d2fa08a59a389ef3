// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <QMainWindow>
#include <QTimer>
#include <string>
#include <vector>

#include "gui/attempt/long_work.h"
#include "gui/trainer/attempt_monitor.h"
#include "gui/trainer/scenes_page.h"
#include "gui/trainer/trainer_texts.h"
#include "gui/trainer/training_session.h"
#include "recorder/sources/devices/window_input.h"

class QAction;
class QLabel;
class QStackedWidget;

namespace calot::gui {

class EndPage;
class OperationView;
class RunPanel;
class ScenesPage;
class Voice;

/// Settings of a window, independent of the scene.
struct TrainerSetup {
  TrainingSettings settings;                    ///< its scene is left empty
  std::shared_ptr<AttemptInput> input;          ///< not null
  std::shared_ptr<recorder::MouseInput> mouse;  ///< what the input listens to; null: another device drives
  std::shared_ptr<recorder::ScopeInput> scope;  ///< what the endoscope listens to; null: it is fixed, or held otherwise
  std::vector<SceneChoice> scenes;
  std::shared_ptr<AttemptInput> demonstration = {};  ///< a performer to be watched; null: there is none
  std::filesystem::path cohort = {};                 ///< where attempts are kept; may not exist yet; empty: none
};

/// The trainer: a page to choose a task, the operation with its panel, and how it went. It puts pages together and asks
/// a TrainingSession twenty times a second; what may be done is decided there.
class TrainerWindow : public QMainWindow {
  Q_OBJECT
 public:
  explicit TrainerWindow(TrainerSetup setup);
  /// Ends what runs; its recording is whole.
  ~TrainerWindow() override;

  /// Begins with a scene: an attempt starts as soon as all is ready.
  void begin(recorder::LoadedScene scene, Purpose purpose = Purpose::own);
  /// Goes on with a recording of this scene, of whomever, from that time of it (s).
  void beginBranch(recorder::LoadedScene scene, const std::filesystem::path& recording, double time);
  /// As begin(), from a file. On failure says why in one line on the window, and returns false.
  bool openScene(const QString& file, Purpose purpose = Purpose::own);
  /// Back to the scenes; what runs ends.
  void chooseScene();

  /// The session of the scene that is open; null on the page of scenes.
  [[nodiscard]] TrainingSession* session() { return session_.get(); }
  [[nodiscard]] OperationView* view() { return view_; }
  [[nodiscard]] EndPage* endPage() { return end_; }
  /// Recordings of all scenes so far, one line each for a terminal, and how many pictures a second each scene was shown
  /// in while it ran. Ends what runs.
  [[nodiscard]] std::vector<std::string> endAndReport();

  /// Sets whether announcements are read aloud. A failure is shown on the window.
  void setAloud(bool on);

 public slots:
  void refresh();

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void buildMenus();
  void connectPages();
  void togglePause();
  void restart();
  void goBack(double time);
  void showOperation();
  void nextTask();
  void readHistory();
  void showOver(const TrainingStatus& status);
  void open(recorder::LoadedScene scene, Purpose purpose);
  void showMode(const QString& note);
  void setMode(recorder::Mode mode, const std::filesystem::path& calibration);
  void askForCalibration();
  void showEnd(const TrainingStatus& status, const QString& result);
  [[nodiscard]] Pointer pointer(const TrainingStatus& status) const;
  [[nodiscard]] std::optional<Hand> driven() const;
  [[nodiscard]] std::optional<std::size_t> taskAfterThis() const;
  void mount(InstrumentKind instrument, bool otherHand);
  void showProblem(const QString& message);
  void endSession();

  TrainerSetup setup_;
  QLabel* problem_;
  QStackedWidget* stack_;
  ScenesPage* scenes_;
  QWidget* operation_;
  OperationView* view_;
  RunPanel* panel_;
  EndPage* end_;
  QAction *pauseAction_, *finishAction_, *restartAction_, *skipAction_, *aloudAction_;
  Voice* voice_ = nullptr;  ///< null where nothing is to be read aloud yet, or could be
  QString voiceFault_;
  QTimer timer_;
  PictureRate rate_;         ///< of the scene
  bool windowLeft_ = false;  ///< the keyboard went elsewhere in the middle of a run, and has not come back to it
  Purpose purpose_ = Purpose::own;
  std::optional<ControlsTutorial> tutorial_;
  std::string noticedIn_;      ///< the attempt whose errors are shown when they happen
  std::uint64_t noticed_ = 0;  ///< of them, so far
  std::string ended_;          ///< the attempt that the end page shows
  std::vector<std::string> recorded_;
  std::unique_ptr<TrainingSession> session_;
  Background background_;  ///< reads the trainee's history
};

}  // namespace calot::gui
