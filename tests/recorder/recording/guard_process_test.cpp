// SPDX-License-Identifier: GPL-3.0-or-later
// Guarding processes that were made beforehand: as runGuarded, and not a burden to what goes on around them.
#include "recorder/recording/probe.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/recorder/recording/support/synthetic.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

constexpr GuardLimits short_{std::chrono::seconds(1), std::size_t{256} << 20U, std::chrono::seconds(3)};

std::string doAsNamed(const std::string& file) {
  if (file == "crash") ::raise(SIGKILL);
  if (file == "hang")
    for (;;) ::pause();
  if (file == "spin")
    for (volatile unsigned long turns = 0;;) turns = turns + 1;
  if (file == "swell") return std::string(std::size_t{512} << 20U, 'a');
  if (file == "damaged") throw Error(ErrorKind::damaged, Where{"r.h5", "/ticks"}, "cut off", {Remedy::recover});
  if (file == "large") return std::string(1000000, 'a');
  if (file == "parent") return std::to_string(::getppid());
  return "read " + file;
}

std::string outcome(GuardProcesses& processes, const std::string& file) {
  try {
    return processes.run(file, short_);
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(GuardProcesses, AnswerAsRunGuardedDoes) {
  GuardProcesses processes(doAsNamed, 1);
  EXPECT_EQ(outcome(processes, "one.h5"), "read one.h5");
  expectNames(outcome(processes, "crash"), {"crash: ", "signal 9"});
  expectNames(outcome(processes, "spin"), {"spin: ", "1 s"});
  expectNames(outcome(processes, "hang"), {"hang: ", "3 s"});
#ifndef CALOT_SANITIZED  // a sanitizer's allocator has its memory beforehand
  expectNames(outcome(processes, "swell"), {"swell: ", "256 MiB"});
#endif
  EXPECT_EQ(outcome(processes, "large"), std::string(1000000, 'a'));
  EXPECT_EQ(outcome(processes, "two.h5"), "read two.h5");
  expectFault(
      ErrorKind::damaged, "r.h5: /ticks", {"cut"}, [&] { processes.run("damaged", short_); },
      std::vector{Remedy::recover});
}

TEST(GuardProcesses, AreChildrenOfAProcessOfTheirOwn) {
  GuardProcesses processes(doAsNamed, 1);
  const std::string parent = outcome(processes, "parent");
  EXPECT_NE(parent, std::to_string(::getpid()));
  EXPECT_EQ(parent, outcome(processes, "parent"));
}

TEST(GuardProcesses, OneThatWasKilledIsNotMissed) {
  GuardProcesses processes(doAsNamed, 1);
  ASSERT_EQ(::kill(std::stoi(outcome(processes, "parent")), SIGKILL), 0);
  EXPECT_EQ(outcome(processes, "one.h5"), "read one.h5");
  EXPECT_EQ(outcome(processes, "parent"), std::to_string(::getpid()));
}

TEST(GuardProcesses, ServeMoreThreadsThanTheyAre) {
  GuardProcesses processes(doAsNamed, 2);
  std::vector<std::string> wrong(6);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 20; ++i) {
        const std::string file = std::to_string(t) + "-" + std::to_string(i);
        if (const std::string read = outcome(processes, file); read != "read " + file) wrong[t] = read;
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong, std::vector<std::string>(wrong.size()));
}

// Another program that waits for the end of what it is sent would wait as long as the processes live.
TEST(GuardProcesses, HoldNothingOpen) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  GuardProcesses processes(doAsNamed, 1);
  EXPECT_EQ(outcome(processes, "one.h5"), "read one.h5");
  ::close(pipe[1]);
  ASSERT_EQ(::fcntl(pipe[0], F_SETFL, O_NONBLOCK), 0);
  char none = 0;
  EXPECT_EQ(::read(pipe[0], &none, 1), 0);  // the end; -1 where somebody could still write
  ::close(pipe[0]);
}

TEST(ProbeProcesses, SayOfARecordingWhatProbeSays) {
  const test::Folder folder;
  test::writeRecording(folder / "whole.h5", test::makeHeader(), 60);
  std::filesystem::copy_file(folder / "whole.h5", folder / "cut.h5");
  std::filesystem::resize_file(folder / "cut.h5", std::filesystem::file_size(folder / "whole.h5") / 2);
  const auto said = [&](const std::string& name) -> std::string {
    try {
      return probe(folder / name).intact() ? "intact" : "broken";
    } catch (const Error& e) {
      return e.what();
    }
  };
  const std::string cut = said("cut.h5"), none = said("none.h5");
  const ProbeProcesses probes(2);
  const ProbeProcesses more(2);  // does nothing
  EXPECT_EQ(said("whole.h5"), "intact");
  EXPECT_EQ(said("cut.h5"), cut);
  EXPECT_EQ(said("none.h5"), none);
  expectNames(none, {"none.h5"});
}

// Their copies of it would have lost its descriptors.
TEST(ProbeProcesses, AreNotMadeWhileARecordingIsOpen) {
  const test::Folder folder;
  test::writeRecording(folder / "r.h5", test::makeHeader(), 60);
  const Recording open(folder / "r.h5");
  const ProbeProcesses probes(1);
  EXPECT_TRUE(probe(folder / "r.h5").intact());
}

}  // namespace
}  // namespace calot::recorder
