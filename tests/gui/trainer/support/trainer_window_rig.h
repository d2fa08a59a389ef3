// SPDX-License-Identifier: GPL-3.0-or-later
// The trainer's window on Qt's offscreen platform, with what a trainee does to it.
#pragma once

#include "gui/trainer/trainer_window.h"

#include <gtest/gtest.h>

#include <QApplication>
#include <QImage>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QMouseEvent>
#include <QPushButton>
#include <QSlider>
#include <QTest>

#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/widget_parts.h"
#include "gui/trainer/end_page.h"
#include "gui/trainer/operation_view.h"
#include "gui/trainer/run_panel.h"
#include "gui/trainer/trainer_texts.h"
#include "gui/trainer/training_session.h"
#include "recorder/recording/reader.h"
#include "recorder/sources/devices/scope_device.h"
#include "recorder/sources/scope/scope_source.h"
#include "tests/gui/trainer/support/spoken.h"
#include "tests/gui/trainer/support/trainer_rig.h"

namespace calot::gui::trainertest {

inline constexpr int patience = 60000;  // ms

class Trainer : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    qputenv("QT_QPA_PLATFORM", "offscreen");
    static int count = 1;
    static char name[] = "test";
    static char* arguments[] = {name, nullptr};
    if (QApplication::instance() == nullptr) new QApplication(count, arguments);
  }
  void SetUp() override { QLocale::setDefault(QLocale::c()); }
  void TearDown() override {
    window_.reset();
    QLocale::setDefault(QLocale::c());
  }

  /// @param device another device's input; null: mouse and keyboard
  TrainerWindow& open(std::shared_ptr<AttemptInput> device = nullptr, recorder::Mode mode = recorder::Mode::practice) {
    return open(std::move(device), mode, nullptr);
  }
  /// @param scope keys of an endoscope that moves; null: it is fixed
  TrainerWindow& open(std::shared_ptr<AttemptInput> device, recorder::Mode mode,
                      const std::shared_ptr<recorder::ScopeInput>& scope) {
    TrainerSetup setup;
    setup.scope = scope;
    setup.settings.attempt.mode = mode;
    setup.settings.attempt.participant = participant_;
    setup.cohort = cohort_;
    setup.demonstration = std::make_shared<trainertest::ScriptInput>(trainertest::swayingScript(20.0));
    setup.settings.folder = folder_ / "";
    setup.settings.countdown = std::chrono::milliseconds(1500);
    setup.settings.exchange = std::chrono::milliseconds(500);
    setup.scenes = {{"touch-liver", "A touch.", CALOT_SOURCE_DIR "/assets/scenes/touch-liver.json"},
                    {"gone", "Is not there.", "/nowhere/gone.json"}};
    if (device) {
      setup.input = std::move(device);
    } else {
      setup.mouse = std::make_shared<recorder::MouseInput>();
      MouseAttemptInput::AddScope addScope;
      if (scope) {
        addScope = [scope](std::unique_ptr<recorder::SampleSource> source, const SceneDescription& scene) {
          return std::make_unique<recorder::ScopeSource>(std::move(source), recorder::Endoscope(scene, 0.0),
                                                         std::make_unique<recorder::ScopeKeys>(scope));
        };
      }
      setup.input = std::make_shared<MouseAttemptInput>(setup.mouse, std::move(addScope));
    }
    window_ = std::make_unique<TrainerWindow>(std::move(setup));
    window_->show();
    window_->activateWindow();
    EXPECT_TRUE(QTest::qWaitForWindowActive(window_.get()));
    return *window_;
  }
  void beginSmall() {
    window_->begin(trainertest::smallLoadedScene());
    ASSERT_TRUE(runs(0.1));
  }
  bool runs(double time) {
    return QTest::qWaitFor(
        [&] {
          const TrainingStatus status = window_->session()->status();
          return status.stage == Stage::running && status.figures.time >= time;
        },
        patience);
  }
  bool reaches(Stage stage) {
    const bool there = QTest::qWaitFor([&] { return window_->session()->status().stage == stage; }, patience);
    window_->refresh();
    return there;
  }
  template <class T>
  T* child(const char* name) {
    T* const found = window_->findChild<T*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  QString text(const char* label) { return child<QLabel>(label)->text(); }
  /// What the panel says of the pointer at this moment, were it there.
  QString saidOf(Pointer pointer) {
    const TrainingSession& session = *window_->session();
    return panelText(session.status(), session.scene(), "", session.mode(), Hand::right, pointer).pointer;
  }
  /// Lets a key be down until something is so.
  void hold(Qt::Key key, const std::function<bool()>& until) {
    QTest::keyPress(window_->view(), key);
    EXPECT_TRUE(QTest::qWaitFor(until, patience));
    QTest::keyRelease(window_->view(), key);
  }
  /// Moves the pointer within the picture. The event is sent: the platform's own comes when it likes, and not at all
  /// where the pointer is there already.
  void pointTo(const QPoint& there) {
    QWidget& view = *window_->view();
    QCursor::setPos(view.mapToGlobal(there));
    QMouseEvent move(QEvent::MouseMove, there, view.mapToGlobal(there), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(&view, &move);
  }
  double jaw() { return window_->session()->status().figures.hand[1].jaw; }

  recorder::test::Folder folder_;
  std::filesystem::path cohort_;  ///< of the next window; empty: none
  std::string participant_;
  std::unique_ptr<TrainerWindow> window_;
};

}  // namespace calot::gui::trainertest
