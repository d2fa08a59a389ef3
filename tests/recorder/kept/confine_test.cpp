// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine has given up ends it.
#include "apps/calot-engine/confine.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <memory>
#include <vector>

namespace calot::apps {
namespace {

#ifndef CALOT_SANITIZED

/// Ends with 7 where the act was allowed.
template <class Act>
[[noreturn]] void doConfined(Act&& act) {
  if (confine() != recorder::Confinement::own) _exit(8);
  act();
  _exit(7);
}

class ConfinedDeath : public testing::Test {
 protected:
  ConfinedDeath() { testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

TEST_F(ConfinedDeath, OpensNoFile) {
  EXPECT_EXIT(doConfined([] { open("/etc/passwd", O_RDONLY); }), testing::KilledBySignal(SIGSYS), "");
}
TEST_F(ConfinedDeath, StartsNoProgram) {
  EXPECT_EXIT(doConfined([] { fork(); }), testing::KilledBySignal(SIGSYS), "");
  EXPECT_EXIT(doConfined([] { execl("/bin/true", "true", nullptr); }), testing::KilledBySignal(SIGSYS), "");
}
TEST_F(ConfinedDeath, SpeaksToNobody) {
  EXPECT_EXIT(doConfined([] { socket(AF_INET, SOCK_STREAM, 0); }), testing::KilledBySignal(SIGSYS), "");
}
TEST_F(ConfinedDeath, RunsNothingThatItWrote) {
  EXPECT_EXIT(
      doConfined([] { mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0); }),
      testing::KilledBySignal(SIGSYS), "");
}
TEST_F(ConfinedDeath, HasMemoryWithinBoundsAndComputes) {
  EXPECT_EXIT(doConfined([] {
                std::vector<double> numbers(10'000'000, 1.0);  // not small
                double sum = 0.0;
                for (const double x : numbers) sum += x;
                void* const much =
                    mmap(nullptr, engineMemory, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
                _exit(sum == 1e7 && much == MAP_FAILED ? 0 : 9);
              }),
              testing::ExitedWithCode(0), "");
}

#endif

}  // namespace
}  // namespace calot::apps
