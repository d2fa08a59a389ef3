// SPDX-License-Identifier: GPL-3.0-or-later
// Ten minutes recorded take no more than 1.3 times the bytes of the same file repacked.
#include <gtest/gtest.h>

#include <cstdlib>

#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"

namespace calot::recorder {
namespace {

TEST(Size, TenMinutesAgainstRepacked) {
  const test::Folder folder;
  const AttemptHeader header = test::makeHeader();
  constexpr std::uint64_t steps = 60000;
  RecordingWriter writer(folder / "r.h5", header);
  test::feed(
      writer, header, steps, [&](std::uint64_t n) { return test::plausibleStep(header, n); }, 100000);
  writer.onEnd(Outcome::timeLimit);
  writer.finish();
  const WriterStatistics statistics = writer.statistics();
  const auto recorded = std::filesystem::file_size(folder / "r.h5");
  // Time of the writing thread per recorded second; the loop's thread only copies.
  std::printf("recorded: %.1f kB/s, writer %.2f ms CPU a recorded second, longest flush %.1f ms, blocks grown %llu\n",
              static_cast<double>(recorded) / 600e3, statistics.writerSeconds / 0.6, statistics.maxFlushSeconds * 1e3,
              static_cast<unsigned long long>(statistics.blocksGrown));
  {
    Recording r(folder / "r.h5");
    EXPECT_EQ(r.stepCount(), steps);
    EXPECT_EQ(r.seconds(), 600.0);
  }
  if (std::system("command -v h5repack >/dev/null 2>&1") != 0) GTEST_SKIP() << "h5repack is not installed";
  for (const char* format : {"-L", ""}) {
    const std::string out = (folder / "p.h5").string();
    const std::string command =
        std::string("h5repack ") + format + " '" + (folder / "r.h5").string() + "' '" + out + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const auto repacked = std::filesystem::file_size(out);
    std::printf("h5repack %s: %.1f kB/s, ratio %.3f\n", format, static_cast<double>(repacked) / 600e3,
                static_cast<double>(recorded) / static_cast<double>(repacked));
    EXPECT_LE(static_cast<double>(recorded), 1.3 * static_cast<double>(repacked));
    // Repacking makes no second attempt: same content, same chain.
    if (*format != '\0') {
      Recording p(out);
      EXPECT_TRUE(p.verifyChain().intact());
      EXPECT_EQ(p.header().attempt, header.attempt);
    }
  }
}

}  // namespace
}  // namespace calot::recorder
