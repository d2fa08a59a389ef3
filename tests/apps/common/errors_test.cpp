// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <fstream>
#include <new>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>

#include "apps/common/program.h"

namespace calot::apps {
namespace {

TEST(ExitCodes, AreThoseOfTheManual) {
  EXPECT_EQ(static_cast<int>(codeOf(std::nullopt)), 0);
  EXPECT_EQ(static_cast<int>(codeOf(ErrorKind::failure)), 1);
  EXPECT_EQ(static_cast<int>(codeOf(ErrorKind::invalid)), 2);
  EXPECT_EQ(static_cast<int>(codeOf(ErrorKind::refused)), 3);
  EXPECT_EQ(static_cast<int>(codeOf(ErrorKind::damaged)), 4);
  EXPECT_EQ(static_cast<int>(codeOf(ErrorKind::undecided)), 5);
}

TEST(ExitCodes, OfManyInputsAreTheFirstPresentOf14350) {
  using enum ExitCode;
  EXPECT_EQ(worstOf({}), yes);
  EXPECT_EQ(worstOf({yes, undecided, yes}), undecided);
  EXPECT_EQ(worstOf({yes, undecided, no}), no);
  EXPECT_EQ(worstOf({damaged, undecided, no}), damaged);
  EXPECT_EQ(worstOf({damaged, failure, no}), failure);
}

TEST(Advice, NamesTheFlag) {
  const Error there(ErrorKind::invalid, Where{"r.h5"}, "already exists", {Remedy::replaceExisting});
  EXPECT_EQ(messageOf(there), "r.h5: already exists; --force replaces what is there");
  const Error keys(ErrorKind::refused, Where{"c.db"}, "two keys", {Remedy::chooseKey, Remedy::mixKeys});
  EXPECT_EQ(messageOf(keys), "c.db: two keys; choose one with --key, or compare all the same with --mix-keys");
  EXPECT_EQ(messageOf(Error(ErrorKind::damaged, Where{"r.h5", "/ticks"}, "cut off")), "r.h5: /ticks: cut off");
}

/// A flag that is renamed would leave its advice behind.
TEST(Advice, NamesFlagsThatCommandsHave) {
  std::string sources;
  for (const char* file : {"record_command.cpp", "replay_command.cpp", "source_options.cpp", "study_command.cpp",
                           "norm_command.cpp", "grade_command.cpp"}) {
    std::ifstream in(std::string(CALOT_SOURCE_DIR "/apps/calot/") + file);
    ASSERT_TRUE(in) << file;
    std::ostringstream text;
    text << in.rdbuf();
    sources += text.str();
  }
  for (int r = 0; r <= static_cast<int>(Remedy::nameCheckpoints); ++r) {
    const std::string text = advice({static_cast<Remedy>(r)});
    EXPECT_FALSE(text.empty()) << r;
    const std::regex flag("--[a-z-]+");
    for (std::sregex_iterator it(text.begin(), text.end(), flag), end; it != end; ++it)
      EXPECT_NE(sources.find(std::string("\"").append(it->str()).append("\"")), std::string::npos)
          << it->str() << " is the flag of no command";
  }
}

TEST(RunProgram, MakesALineAndACodeOfEveryError) {
  const auto answer = [](const std::function<int()>& body) {
    testing::internal::CaptureStderr();
    const int code = runProgram("calot", body);
    return std::to_string(code) + " " + testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(answer([] { return 3; }), "3 ");
  EXPECT_EQ(answer([]() -> int { throw Error(ErrorKind::damaged, Where{"r.h5"}, "is cut off", {Remedy::recover}); }),
            "4 calot: r.h5: is cut off; calot recover saves what it can\n");
  EXPECT_EQ(answer([]() -> int { throw std::bad_alloc(); }), "1 calot: not enough memory\n");
  EXPECT_EQ(answer([]() -> int { throw std::runtime_error("broken"); }), "1 calot: broken\n");
}

}  // namespace
}  // namespace calot::apps
