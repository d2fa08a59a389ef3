// SPDX-License-Identifier: GPL-3.0-or-later
// Keyframes in the file: when they are taken, how small they are, and what becomes of those that lie.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>

#include "recorder/recording/keyframe_code.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/recording/recover.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using test::Folder;
using test::makeHeader;

/// Steps after which a keyframe is due, of steps that all report the same work.
std::vector<std::uint64_t> dueSteps(std::uint64_t steps, const StepResult& result, std::size_t stateBytes) {
  const AttemptHeader header = makeHeader();
  KeyframeSchedule schedule(Layout(header), header.tickSeconds);
  std::vector<std::uint64_t> due;
  for (std::uint64_t n = 0; n < steps; ++n) {
    if (!schedule.dueAfter(result)) continue;
    due.push_back(n);
    schedule.taken(stateBytes);
  }
  return due;
}

TEST(Schedule, AboutASecondWhereStepsAreEasy) {
  EXPECT_EQ(dueSteps(450, {}, 1000), (std::vector<std::uint64_t>{99, 199, 299, 399}));
}

TEST(Schedule, AQuarterSecondWhereStepsAreHard) {
  StepResult hard;
  hard.organ.resize(2);
  for (OrganResult& organ : hard.organ) organ.iterations = 40;
  hard.fat.resize(1);
  hard.fat[0].carved = 1e-9;
  hard.contact.rows = 60;
  hard.contact.passes = 5;
  EXPECT_EQ(dueSteps(110, hard, 190000), (std::vector<std::uint64_t>{24, 49, 74, 99}));
}

/// The same work takes longer in a larger scene.
TEST(Schedule, MoreOftenInLargerScenes) {
  StepResult medium;
  medium.organ.resize(1);
  medium.organ[0].iterations = 60;
  const std::vector<std::uint64_t> small = dueSteps(2000, medium, 190000);
  const std::vector<std::uint64_t> large = dueSteps(2000, medium, 570000);
  EXPECT_GT(large.size(), 2 * small.size());
}

TEST(Keyframes, AreFoundByStep) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  RecordingWriter writer(folder / "r.h5", header);
  test::feed(
      writer, header, 450, [&](std::uint64_t n) { return test::plausibleStep(header, n); }, 3001);
  writer.onEnd(Outcome::completed);
  writer.finish();
  Recording r(folder / "r.h5");
  ASSERT_EQ(r.keyframeSteps(), (std::vector<std::uint64_t>{99, 199, 299, 399}));
  EXPECT_FALSE(r.keyframeAtOrBefore(98).has_value());
  EXPECT_EQ(r.keyframeAtOrBefore(99), 0U);
  EXPECT_EQ(r.keyframeAtOrBefore(298), 1U);
  EXPECT_EQ(r.keyframeAtOrBefore(10000), 3U);
  for (const std::size_t k : {3U, 0U, 2U, 1U, 3U}) {  // in any order
    EXPECT_EQ(r.keyframe(k).state, test::makeKeyframe(r.keyframeSteps()[k], 3001).state);
    EXPECT_EQ(r.keyframe(k).haptics, test::makeKeyframe(r.keyframeSteps()[k], 3001).haptics);
  }
}

/// A State of which a twentieth changes from keyframe to keyframe takes a tenth of what it would on its own.
TEST(Keyframes, HoldWhatChanged) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  constexpr std::size_t bytes = 400000;
  constexpr std::uint64_t steps = 2000;
  test::Random random(9);
  Keyframe now;
  now.state.resize(bytes);
  for (std::byte& b : now.state) b = static_cast<std::byte>(random.next());
  now.parts = {{bytes / 2}, {bytes / 2}};
  RecordingWriter writer(folder / "r.h5", header);
  for (std::uint64_t n = 0; n < steps; ++n) {
    const test::Step s = test::plausibleStep(header, n);
    const auto keyframe = [&] {
      const std::size_t at = random.next() % (bytes - bytes / 20);
      for (std::size_t i = 0; i < bytes / 20; ++i) now.state[at + i] = static_cast<std::byte>(random.next());
      now.step = n;
      return now;
    };
    writer.onStep({n, s.samples, s.ticks, s.result, s.digest, s.lateness, keyframe, {}});
  }
  writer.onEnd(Outcome::completed);
  writer.finish();
  const std::size_t count = Recording(folder / "r.h5").keyframeSteps().size();
  ASSERT_GE(count, steps / 100);
  std::uint64_t stored = 0;
  std::uint64_t sum = 0;
  for (const StoredBytes& group : storedBytes(folder / "r.h5")) {
    sum += group.bytes;
    if (group.group == "keyframes") stored = group.bytes;
  }
  EXPECT_EQ(sum, std::filesystem::file_size(folder / "r.h5"));
  std::printf("%zu keyframes of %zu bytes: %llu bytes stored\n", count, bytes, static_cast<unsigned long long>(stored));
  EXPECT_LT(stored - bytes, (count - 1) * bytes / 6);
}

/// Writes over words of /keyframes/bytes through the library; the checksums are right again.
void overwrite(const std::filesystem::path& path, hsize_t first, const std::vector<std::uint64_t>& words) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t d = H5Dopen2(file, "/keyframes/bytes", H5P_DEFAULT);
  const hid_t space = H5Dget_space(d);
  const hsize_t count = words.size();
  const hid_t memory = H5Screate_simple(1, &count, nullptr);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr);
  EXPECT_GE(H5Dwrite(d, H5T_NATIVE_UINT64, memory, space, H5P_DEFAULT, words.data()), 0);
  H5Sclose(memory);
  H5Sclose(space);
  H5Dclose(d);
  H5Fclose(file);
}

TEST(Keyframes, ThatLieAreDamage) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 260);
  constexpr std::uint64_t huge = ~std::uint64_t{0};
  const std::vector<std::vector<std::uint64_t>> lies{
      {2},                // compared with itself
      {huge},             // with one that there never was
      {1, huge},          // of more parts than there are words
      {1, 0},             // of none
      {1, 1, huge},       // a part longer than the keyframe
      {1, 1, 8},          // shorter
      {1, 1, 3104, huge}  // like what is not there
  };
  for (const std::vector<std::uint64_t>& words : lies) {
    std::filesystem::copy_file(folder / "r.h5", folder / "c.h5", std::filesystem::copy_options::overwrite_existing);
    overwrite(folder / "c.h5", 8192, words);  // the second keyframe
    Recording r(folder / "c.h5");
    EXPECT_NO_THROW(static_cast<void>(r.keyframe(0)));
    const auto fault = caught([&] { static_cast<void>(r.keyframe(1)); });
    expectFault(ErrorKind::damaged, "", {std::to_string(r.keyframeSteps()[1])}, fault);
    EXPECT_TRUE(fault && fault->where().place == "/keyframes/bytes");
    EXPECT_FALSE(r.verifyChain().intact());
  }
}

/// Of a killed writer every flushed keyframe can be decoded, and so it can of what is recovered.
TEST(Keyframes, OfAKilledWriterAreWhole) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  const pid_t child = ::fork();
  if (child == 0) {
    RecordingWriter writer(folder / "r.h5", header);
    test::feed(
        writer, header, 910, [&](std::uint64_t n) { return test::plausibleStep(header, n); }, 60000);
    while (writer.statistics().steps < 900) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const Recovered saved = recover(folder / "r.h5", folder / "o.h5", false);
  EXPECT_EQ(saved.steps, 900U);
  for (const char* name : {"r.h5", "o.h5"}) {
    Recording r(folder / name);
    ASSERT_EQ(r.keyframeSteps().size(), 9U);
    for (std::size_t k = 0; k < 9; ++k) {
      const Keyframe made = test::makeKeyframe(r.keyframeSteps()[k], 60000);
      EXPECT_EQ(r.keyframe(k).state, made.state);
      EXPECT_EQ(r.keyframe(k).haptics, made.haptics);
    }
  }
}

}  // namespace
}  // namespace calot::recorder
