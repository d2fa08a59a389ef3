// SPDX-License-Identifier: GPL-3.0-or-later
// How long a user waits. Times of a machine that may be busy: run where CALOT_HEAVY is set.
#include <gtest/gtest.h>
#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <QCoreApplication>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <QElapsedTimer>
#include <QSignalSpy>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>
#include <random>

#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/recording_view.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/loop_watch.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;

constexpr double maxStart = 1000.0;  // ms, of 10,000 attempts
constexpr double maxGap = 50.0;      // ms between two turns of the interface
constexpr double maxSeek = 300.0;    // ms till a picture of about that moment

double medianOf(std::vector<double> times) {
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  return times[times.size() / 2];
}

class InterfaceHeavy : public test::Waiting {
 protected:
  void SetUp() override {
    Waiting::SetUp();
    if (IsSkipped()) return;
    root_ = folder_.path().toStdString();
  }
  static void judge(const char* what, double took, double usual) {
    const double limit = usual * test::slowness();
    std::cout << what << ": " << took << " of " << limit << " ms, " << took / limit << '\n';
    EXPECT_LT(took / limit, 1.0) << what;
  }
  static void fillWithOthers(const fs::path& path) {
    analytics::CohortDatabase database(path.string(), Access::create);
    for (int i = 0; i < 10000; ++i) database.storeAttempt(test::attemptNumber(i), {test::pathLength("left", 0.1)});
  }
  QTemporaryDir folder_;
  fs::path root_;
};

TEST_F(InterfaceHeavy, TenThousandAttemptsAreOnTheScreenWithinASecond) {
  const std::string path = (root_ / "c.db").string();
  fillWithOthers(path);
  QElapsedTimer clock;
  clock.start();
  DashboardWindow window(apps::assessProgram());
  window.setDocument(std::make_shared<const CohortDocument>(path));
  window.show();
  QTest::qWait(1);
  judge("start", static_cast<double>(clock.elapsed()), maxStart);
  test::LoopWatch watch;
  bool shown = false;
  QObject::connect(&window, &DashboardWindow::documentShown, [&] { shown = true; });
  window.reload();
  EXPECT_TRUE(QTest::qWaitFor([&] { return shown; }, 60000));
  QTest::qWait(500);
  watch.judge("10,000 attempts read again", maxGap);
}

TEST_F(InterfaceHeavy, NothingBlocksWhileAReplayAndAnImportRun) {
  // A whole operation where one is named, else a short recording.
  const char* named = std::getenv("CALOT_RECORDING");
  if (named != nullptr)
    fs::copy_file(named, root_ / "one.h5");
  else
    test::recordPerformer(root_ / "one.h5", 6.0, 3);
  for (int i = 0; i < 3; ++i)
    test::recordPerformer(root_ / ("more" + std::to_string(i) + ".h5"), 3.0, 10U + static_cast<unsigned>(i));
  const std::string command = std::string(CALOT_PROGRAM) + " assess " + (root_ / "one.h5").string() + " --cohort " +
                              (root_ / "c.db").string() + " > /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  fillWithOthers(root_ / "c.db");
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(QString::fromStdString((root_ / "c.db").string())));
  QCoreApplication::processEvents();

  test::LoopWatch watch;
  window.findChild<QTabWidget*>()->setCurrentIndex(1);
  AttemptPage& page = *window.findChild<AttemptPage*>();
  ASSERT_TRUE(QTest::qWaitFor([&] { return page.settled(); }, 300000));
  watch.judge("an attempt opened", maxGap);
  window.importRecordings({folder_.path()});
  page.replay().setSpeed(16.0);
  page.replay().play();
  QElapsedTimer clock;
  clock.start();
  while (window.imports().busy() || clock.elapsed() < 5000) {
    QTest::qWait(20);
    if (page.replay().isOpen() && !page.replay().position().playing) page.replay().play();
  }
  watch.judge("a replay and an import run", maxGap);
}

TEST_F(InterfaceHeavy, AnAttemptIsSeenSoonAfterItIsOpened) {
  const char* named = std::getenv("CALOT_RECORDING");
  if (named == nullptr) GTEST_SKIP() << "CALOT_RECORDING names a recording";
  fs::copy_file(named, root_ / "one.h5");
  test::recordPerformer(root_ / "other.h5", 2.0, 3);
  const std::string command = std::string(CALOT_PROGRAM) + " assess " + (root_ / "one.h5").string() + ' ' +
                              (root_ / "other.h5").string() + " --cohort " + (root_ / "c.db").string() + " > /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::vector<double> opened, again, read;
  for (int time = 0; time < 5; ++time) {
    DashboardWindow window(apps::assessProgram());
    window.resize(1366, 768);
    window.show();
    ASSERT_TRUE(window.openDatabase(QString::fromStdString((root_ / "c.db").string())));
    AttemptsPage& list = *window.findChild<AttemptsPage*>();
    AttemptPage& page = *window.findChild<AttemptPage*>();
    std::string one, other;
    for (const analytics::AttemptRow& a :
         analytics::CohortDatabase((root_ / "c.db").string(), Access::read).listAttempts())
      (a.fileName == "one.h5" ? one : other) = a.uuid;
    list.select(QString::fromStdString(one));
    // As the program does when nothing else is to be done; nobody opens an attempt within two seconds.
    window.prepare();
    QTest::qWait(2000);
    const auto timed = [&](const std::function<void()>& open, std::vector<double>& times) {
      QSignalSpy shown(page.findChild<RecordingView*>(), &RecordingView::pictureShown);
      QElapsedTimer clock;
      clock.start();
      open();
      ASSERT_TRUE(QTest::qWaitFor([&] { return shown.count() > 0; }, 300000));
      times.push_back(static_cast<double>(clock.nsecsElapsed()) * 1e-6);
      ASSERT_TRUE(QTest::qWaitFor([&] { return page.settled(); }, 300000));
      if (&times == &opened) read.push_back(static_cast<double>(clock.nsecsElapsed()) * 1e-6);
    };
    std::vector<double> ignored;
    timed([&] { window.findChild<QTabWidget*>()->setCurrentIndex(1); }, opened);
    timed([&] { list.select(QString::fromStdString(other)); }, ignored);
    timed([&] { list.select(QString::fromStdString(one)); }, again);
  }
  std::cout << "first picture of an attempt, medians of 5: " << medianOf(opened) << " ms after opening, "
            << medianOf(again) << " ms at reopening; all read after " << medianOf(read) << " ms\n";
}

TEST_F(InterfaceHeavy, AnyMomentOfALongRecordingIsShownAtOnce) {
  const char* named = std::getenv("CALOT_RECORDING");
  if (named == nullptr) GTEST_SKIP() << "CALOT_RECORDING names a long recording";
  std::mutex mutex;
  std::condition_variable changed;
  PlayerPosition newest;
  std::uint64_t told = 0;
  ReplayPlayer player(named, "",
                      {[&](const std::shared_ptr<const SceneView>&, const PlayerPosition& position) {
                         const std::lock_guard lock(mutex);
                         newest = position;
                         ++told;
                         changed.notify_all();
                       },
                       [&](const std::string& fault) { FAIL() << fault; }});
  const auto seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937 random(seed);
  std::unique_lock lock(mutex);
  ASSERT_TRUE(changed.wait_for(lock, std::chrono::minutes(5), [&] { return told > 0; }));
  const double seconds = newest.seconds;
  double slowest = 0.0, slowestExact = 0.0;
  std::vector<double> first;
  for (int i = 0; i < 40; ++i) {
    const double time = std::uniform_real_distribution<double>(0.0, seconds)(random);
    const std::uint64_t before = told;
    lock.unlock();
    QElapsedTimer clock;
    clock.start();
    player.ask({.time = time});
    lock.lock();
    changed.wait(lock, [&] { return told > before; });
    first.push_back(static_cast<double>(clock.nsecsElapsed()) * 1e-6);
    slowest = std::max(slowest, first.back());
    EXPECT_LT(time - newest.time, 2.0) << "the picture on the way is of a keyframe nearby";
    changed.wait(lock, [&] { return newest.settled && newest.time >= time - 0.011; });
    slowestExact = std::max(slowestExact, static_cast<double>(clock.nsecsElapsed()) * 1e-6);
  }
  std::cout << "first picture after a seek: median " << medianOf(first) << " ms\n";
  std::cout << "exact moment after at most " << slowestExact << " ms\n";
  judge("first picture after a seek", slowest, maxSeek);
}

}  // namespace
}  // namespace calot::gui
