// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/thread_rank.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <thread>

namespace calot::gui {
namespace {

int niceness() { return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())); }

TEST(ThreadRank, OneThreadAndThoseItStartsStepBackAndNoOther) {
  const int before = niceness();
  if (before >= 19) GTEST_SKIP() << "this thread is the last already";
  int itself = 0, started = 0;
  std::thread([&] {
    stepBack(behindEverything);
    itself = niceness();
    std::thread([&] { started = niceness(); }).join();
  }).join();
  EXPECT_GT(itself, before);
  EXPECT_EQ(started, itself);
  EXPECT_EQ(niceness(), before);
}

}  // namespace
}  // namespace calot::gui
