// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/gui/dashboard/support/loop_watch.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <QStringList>

#include "gui/dashboard/dialogs.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui::test {
namespace {

constexpr double usualWork = 120.0;  // ms: calibrate() on two cores of 2.5 GHz

double processorMilliseconds() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// Texts made and sorted: what the interface's turns consist of.
double calibrate() {
  const double before = processorMilliseconds();
  QStringList words;
  std::uint32_t state = 1;
  for (int i = 0; i < 100000; ++i) {
    state = state * 1664525U + 1013904223U;
    words += QString::number(state);
  }
  std::sort(words.begin(), words.end());
  EXPECT_LE(words.front(), words.back());
  return processorMilliseconds() - before;
}

}  // namespace

LoopWatch::LoopWatch() : file_(::open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC)) {
  QObject::connect(&timer_, &QTimer::timeout, &timer_, [this] { turn(); });
  timer_.setTimerType(Qt::PreciseTimer);
  begin();
  timer_.start(1);
}

LoopWatch::~LoopWatch() {
  if (file_ >= 0) ::close(file_);
}

std::int64_t LoopWatch::runDelay() const {
  std::array<char, 96> text{};
  if (file_ < 0 || ::pread(file_, text.data(), text.size() - 1, 0) <= 0) return 0;
  char* end = nullptr;
  (void)std::strtoll(text.data(), &end, 10);  // time on a processor
  return std::strtoll(end, nullptr, 10);
}

void LoopWatch::begin() {
  longest_ = 0.0;
  delayBefore_ = runDelay();
  clock_.start();
}

void LoopWatch::turn() {
  const std::int64_t delay = runDelay();
  longest_ = std::max(longest_, 1e-6 * static_cast<double>(clock_.nsecsElapsed() - (delay - delayBefore_)));
  delayBefore_ = delay;
  clock_.start();
}

void LoopWatch::judge(const std::string& what, double limit) {
  turn();
  const double allowed = limit * slowness();
  std::cout << what << ": " << longest_ << " of " << allowed << " ms\n";
  EXPECT_LT(longest_, allowed) << what;
  begin();
}

double slowness() {
  static const double factor = [] {
    const double work = std::min({calibrate(), calibrate(), calibrate()});
    std::cout << "calibration: " << work << " ms, usually " << usualWork << '\n';
    return std::max(1.0, work / usualWork);
  }();
  return factor;
}

void Waiting::SetUp() {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "CALOT_HEAVY=1 measures how long a user waits";
  startApplication();
  settings::setRecordingFolders({});
  settings::setCalotProgram(CALOT_PROGRAM);
  (void)slowness();
}

}  // namespace calot::gui::test
