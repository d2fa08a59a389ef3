// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/recording_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/gui/dashboard/support/recorded.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::gui {
namespace {

using recorder::test::Folder;

TEST(FindRecording, TakesTheFileOfItsNameThatHoldsTheAttempt) {
  const Folder folder, other;
  analytics::AttemptRow attempt;
  attempt.uuid = test::recordPerformer(other / "r.h5", 0.1);
  attempt.fileName = "r.h5";
  const std::filesystem::path database = folder / "c.db";
  const std::vector<std::filesystem::path> places{(other / "r.h5").parent_path()};
  EXPECT_TRUE(findRecording(attempt, database, {}).empty());
  test::recordPerformer(folder / "r.h5", 0.1, 9);
  EXPECT_TRUE(findRecording(attempt, database, {}).empty()) << "another attempt's";
  EXPECT_EQ(findRecording(attempt, database, places), other / "r.h5") << "not hidden by the one before";
  std::ofstream(folder / "r.h5", std::ios::trunc) << "x";
  EXPECT_EQ(findRecording(attempt, database, places), other / "r.h5") << "nor by a damaged one";
  EXPECT_EQ(findRecording(attempt, database, {}), folder / "r.h5") << "which is named where there is no other";
  // A database from elsewhere cannot name files outside of the places.
  attempt.fileName = "../" + (other / "r.h5").parent_path().filename().string() + "/r.h5";
  EXPECT_EQ(findRecording(attempt, database, {}), folder / "r.h5") << "only the file's name counts";
  attempt.fileName = "c.db";
  std::ofstream(folder / "c.db") << "x";
  EXPECT_TRUE(findRecording(attempt, database, places).empty()) << "no recording by its name";
}

TEST(ReadThrough, HoldsForAFileAsItIsThen) {
  const Folder folder;
  const std::string attempt = test::recordPerformer(folder / "r.h5", 0.1);
  EXPECT_FALSE(wasReadThrough(folder / "r.h5"));
  EXPECT_EQ(openBeginning(folder / "r.h5", attempt).header().attempt, attempt);
  EXPECT_FALSE(wasReadThrough(folder / "r.h5")) << "its beginning alone";
  EXPECT_EQ(openRecording(folder / "r.h5", attempt).header().attempt, attempt);
  EXPECT_TRUE(wasReadThrough(folder / "r.h5"));
  std::filesystem::copy_file(folder / "r.h5", folder / "copy.h5");
  EXPECT_FALSE(wasReadThrough(folder / "copy.h5"));
  const auto before = std::filesystem::last_write_time(folder / "r.h5");
  std::fstream(folder / "r.h5", std::ios::in | std::ios::out | std::ios::binary) << "no HDF5";
  std::filesystem::last_write_time(folder / "r.h5", before);
  EXPECT_FALSE(wasReadThrough(folder / "r.h5")) << "its time was set back";
  EXPECT_ANY_THROW(openRecording(folder / "r.h5", attempt));
}

}  // namespace
}  // namespace calot::gui
