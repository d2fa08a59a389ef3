// SPDX-License-Identifier: GPL-3.0-or-later
// The pages of schemas/ are the contract: a reader written from them alone must agree with what the writer writes.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "tests/recorder/recording/support/synthetic.h"

namespace calot::recorder {
namespace {

/// Exit code of the checker; its lines go to the test's output.
int check(const std::filesystem::path& recording) {
  const std::string root = CALOT_SOURCE_DIR;
  const std::string command = "/usr/bin/python3 '" + root + "/tests/command_line/schema_names.py' '" + root +
                              "/schemas' '" + recording.string() + "'";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Schema, NamesAllThatIsThereAndNothingElse) {
  const test::Folder folder;
  test::writeRecording(folder / "a.h5", test::makeHeader(), 260);
  const int first = check(folder / "a.h5");
  if (first == 77 || first == 127) GTEST_SKIP() << "needs /usr/bin/python3 with h5py";
  EXPECT_EQ(first, 0);
  test::writeRecording(folder / "b.h5", test::makeHeader(10, 0), 60);
  EXPECT_EQ(check(folder / "b.h5"), 0);
  test::writeRecording(folder / "c.h5", test::makeHeader(7, 1), 40);
  EXPECT_EQ(check(folder / "c.h5"), 0);
  const AttemptHeader whole = test::withStructures(test::makeHeader(), 3, 2);
  test::writeRecording(folder / "f.h5", whole, 60);
  EXPECT_EQ(check(folder / "f.h5"), 0);
  test::writeRecording(folder / "g.h5", test::withStructures(test::makeHeader(10, 0), 0, 0), 30);
  EXPECT_EQ(check(folder / "g.h5"), 0);
  for (const std::uint32_t version : {1U, 2U}) {
    AttemptHeader earlier = test::makeHeader();
    earlier.stepResultVersion = version;
    test::writeRecording(folder / "h.h5", earlier, 30);
    EXPECT_EQ(check(folder / "h.h5"), 0) << "version " << version;
  }
  AttemptHeader bare = test::makeHeader(1, 0);
  bare.layout = {};
  bare.assets.resize(1);
  test::writeRecording(folder / "d.h5", bare, 300);
  EXPECT_EQ(check(folder / "d.h5"), 0);
  AttemptHeader ofDevice = test::makeHeader();
  ofDevice.deviceSamples = true;
  test::writeRecording(folder / "e.h5", ofDevice, 60);
  EXPECT_EQ(check(folder / "e.h5"), 0);
}

TEST(Schema, CheckerSeesWhatIsTooMuchAndTooLittle) {
  const test::Folder folder;
  const std::filesystem::path r = folder / "r.h5";
  test::writeRecording(r, test::makeHeader(), 30);
  if (const int first = check(r); first == 77 || first == 127) GTEST_SKIP() << "needs /usr/bin/python3 with h5py";
  const auto change = [&](const std::string& statement) {
    test::writeRecording(r, test::makeHeader(), 30);
    const std::string command =
        "/usr/bin/python3 -c \"import h5py; f = h5py.File('" + r.string() + "', 'r+'); " + statement + "\"";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return check(r);
  };
  EXPECT_EQ(change("f['/extra'] = 1"), 1);
  EXPECT_EQ(change("f.create_group('/device')"), 1);
  EXPECT_EQ(change("f['/ticks'].attrs['extra'] = 1"), 1);
  EXPECT_EQ(change("del f['/observables/misses']"), 1);
  EXPECT_EQ(change("f.create_group('/observables/procedure')"), 1);
  EXPECT_EQ(change("f['/scene/vessels'] = f['/scene/organs'][()]"), 1);
  EXPECT_EQ(change("del f.attrs['seed']; f.attrs['seed'] = 1.0"), 1);
  EXPECT_EQ(change("f['/ticks/left/position'][7, 1] = 0.5"), 1);
  EXPECT_EQ(change("f['/ticks/lateness'][7] = 0.5"), 0);  // outside the chain
}

}  // namespace
}  // namespace calot::recorder
