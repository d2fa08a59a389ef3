// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/problem_words.h"

#include <gtest/gtest.h>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

TEST(ProblemWords, SayWhatAWindowsUserCanDo) {
  const Error there(ErrorKind::invalid, Where{"study.html"}, "already exists", {Remedy::replaceExisting});
  EXPECT_EQ(problemText(there), "study.html: already exists; choose another name, or allow it to be replaced");
  const Error several(ErrorKind::refused, Where{"c.db"}, "they start at once", {Remedy::takeMean, Remedy::exclude});
  EXPECT_EQ(problemText(several),
            "c.db: they start at once; choose the mean of a participant's attempts, or exclude one");
}

TEST(ProblemWords, PassOverWhatTheCommandLineAloneCanDo) {
  const Error keys(ErrorKind::refused, Where{"c.db"}, "two keys", {Remedy::mixKeys, Remedy::chooseKey});
  EXPECT_EQ(problemText(keys), "c.db: two keys; choose one scene, device and version");
  EXPECT_EQ(problemText(Error(ErrorKind::undecided, "another version", {Remedy::replayAnyway})), "another version");
  EXPECT_EQ(problemText(std::runtime_error("no memory")), "no memory");
}

TEST(ProblemWords, NameNoFlag) {
  for (int r = 0; r <= static_cast<int>(Remedy::nameCheckpoints); ++r) {
    const Error error(ErrorKind::refused, "refused", {static_cast<Remedy>(r)});
    EXPECT_EQ(problemText(error).find("--"), std::string::npos) << problemText(error);
  }
}

}  // namespace
}  // namespace calot::gui
