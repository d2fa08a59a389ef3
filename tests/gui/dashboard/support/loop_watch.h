// SPDX-License-Identifier: GPL-3.0-or-later
// How long the interface keeps a user waiting, for heavy tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <QElapsedTimer>
#include <QTimer>
#include <string>

namespace calot::gui::test {

/// The longest time between two turns of this thread's event loop, less what the thread waited for a processor that
/// others had: that is the machine's, not the program's (run delay of /proc/thread-self/schedstat; 0 where there is no
/// such file).
class LoopWatch {
 public:
  LoopWatch();
  ~LoopWatch();
  LoopWatch(const LoopWatch&) = delete;
  LoopWatch& operator=(const LoopWatch&) = delete;
  void begin();                                              ///< anew
  [[nodiscard]] double longest() const { return longest_; }  ///< ms
  /// Prints the longest gap and expects it to be below `limit` ms on the usual machine; begins anew.
  void judge(const std::string& what, double limit);

 private:
  void turn();
  [[nodiscard]] std::int64_t runDelay() const;  ///< ns so far

  int file_;
  QTimer timer_;
  QElapsedTimer clock_;
  std::int64_t delayBefore_ = 0;
  double longest_ = 0.0;
};

/// How many times slower this machine is than a usual one, at least 1: by processor time of a fixed piece of work,
/// measured once.
double slowness();

/// Tests of how long a user waits: skipped unless CALOT_HEAVY is set, since they measure the machine, too.
class Waiting : public ::testing::Test {
 protected:
  void SetUp() override;
};

}  // namespace calot::gui::test
