// SPDX-License-Identifier: GPL-3.0-or-later
// Writers that are killed, disks that fill up, readers that look in while a file is being written.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "recorder/base/errors.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recover.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"
#include "tests/recorder/recording/support/torn_writes.h"

namespace calot::recorder {
namespace {

using calot::Random;
using test::Folder;
using test::makeHeader;

/// A counter that survives the process that counts.
class SharedCounter {
 public:
  SharedCounter()
      : count_(static_cast<std::atomic<std::uint64_t>*>(::mmap(
            nullptr, sizeof(std::atomic<std::uint64_t>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  ~SharedCounter() { ::munmap(count_, sizeof *count_); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;
  std::atomic<std::uint64_t>& operator*() const { return *count_; }

 private:
  std::atomic<std::uint64_t>* count_;
};

void feedOne(RecordingWriter& writer, const AttemptHeader& header, std::uint64_t n) {
  const test::Step s = test::randomStep(header, n, 1);
  const StepRecord record{
      n, s.samples, s.ticks, s.result, s.digest, s.lateness, [n] { return test::makeKeyframe(n, 50000); }, {}};
  writer.onStep(record);
}

/// Records at real time until it is killed. `flushed` counts the steps that the writer says are in the file.
[[noreturn]] void recordPaced(const std::filesystem::path& path, const AttemptHeader& header,
                              std::atomic<std::uint64_t>& done, std::atomic<std::uint64_t>& flushed) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  try {
    RecordingWriter writer(path, header);
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint64_t n = 0;; ++n) {
      std::this_thread::sleep_until(begin + std::chrono::milliseconds(10 * (n + 1)));
      feedOne(writer, header, n);
      done.store(n + 1);
      flushed.store(writer.statistics().steps);
    }
  } catch (const std::exception& e) {  // a child that cannot record must not go on as a second test program
    std::fprintf(stderr, "%s\n", e.what());
    ::_exit(1);
  }
}

/// Kills `rounds` times twelve writers, each some time after its file is there. @param rest in the middle of a write
void killAndOpen(int rounds, std::uint64_t seed, std::chrono::microseconds rest) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  Random random(seed);
  double worst = 0.0;
  constexpr int together = 12;
  std::fflush(nullptr);
  for (int round = 0; round < rounds; ++round) {
    struct Writer {
      pid_t process;
      std::chrono::milliseconds life;
    };
    std::vector<Writer> writers;
    std::vector<SharedCounter> done(together), flushed(together);
    for (std::size_t i = 0; i < together; ++i) {
      const std::filesystem::path path = folder / fmt::format("r{}.h5", i);
      std::filesystem::remove(path);
      const pid_t child = ::fork();
      if (child == 0) {
        test::tearWrites(rest);
        recordPaced(path, header, *done[i], *flushed[i]);
      }
      writers.push_back({child, std::chrono::milliseconds(600 + random.next() % 2400)});
    }
    std::vector<std::thread> killers;
    for (const Writer& w : writers) {
      killers.emplace_back([&w, path = folder / fmt::format("r{}.h5", killers.size())] {
        // From when there is a file: on a busy machine a child may be slow to begin.
        for (int i = 0; i < 6000 && !std::filesystem::exists(path); ++i)
          std::this_thread::sleep_for(std::chrono::milliseconds(10));
        std::this_thread::sleep_for(w.life);
        ::kill(w.process, SIGKILL);
      });
    }
    for (std::thread& t : killers) t.join();
    for (std::size_t i = 0; i < together; ++i) {
      int status = 0;
      ASSERT_EQ(::waitpid(writers[i].process, &status, 0), writers[i].process);
      const std::filesystem::path path = folder / fmt::format("r{}.h5", i);
      ASSERT_TRUE(WIFSIGNALED(status));
      const ChainVerdict verdict = probe(path);
      EXPECT_TRUE(verdict.intact()) << verdict.flush;
      Recording r(path);
      EXPECT_FALSE(r.complete());
      const double lost = 0.01 * static_cast<double>((*done[i]).load() - r.stepCount());
      worst = std::max(worst, lost);
      EXPECT_GE(r.stepCount(), (*flushed[i]).load()) << (*done[i]).load() << " steps recorded";
      const Recovered saved = recover(path, folder / "saved.h5", true);
      EXPECT_EQ(saved.steps, r.stepCount());
      EXPECT_TRUE(saved.lost.empty()) << saved.lost;
      const Recording o(folder / "saved.h5");
      EXPECT_EQ(o.status().back().chain, r.status().back().chain);
      EXPECT_FALSE(o.complete());
    }
  }
  std::printf("%d kills: at most %.2f s lost\n", rounds * together, worst);
}

// That this is at most half a second by the clock is `command_line.killed`'s to show, with the machine for itself.
TEST(Killed, AtAnyMomentOpensAndLosesNothingThatWasFlushed) { killAndOpen(1, 77, std::chrono::microseconds(0)); }

// A kill that falls between two pages of one write leaves it half done. No piece of a recording's structure and no row
// of /status lies across two pages, so only what nothing vouches for can be torn.
TEST(Killed, InTheMiddleOfAWriteLosesNothingThatWasFlushed) { killAndOpen(1, 78, std::chrono::milliseconds(20)); }

TEST(Live, AReaderSeesWholeFlushesWhileTheyAreWritten) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  SharedCounter done, flushed;
  const std::filesystem::path path = folder / "r.h5";
  const pid_t child = ::fork();
  if (child == 0) recordPaced(path, header, *done, *flushed);
  for (int i = 0; i < 500 && !std::filesystem::exists(path); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::uint64_t seen = 0;
  int grew = 0;
  for (int look = 0; look < 40; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    Recording r(path, Access::live);
    EXPECT_GE(r.stepCount(), seen);
    grew += r.stepCount() > seen ? 1 : 0;
    seen = r.stepCount();
    EXPECT_TRUE(r.verifyChain().intact());
    if (seen > 0) {
      EXPECT_EQ(r.step(seen - 1).forces, forceDigest(test::randomStep(header, seen - 1, 1).ticks));
    }
  }
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_GE(grew, 4);
}

TEST(DiskFull, TheLoopGoesOnAndWhatWasFlushedStays) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  const std::filesystem::path path = folder / "r.h5";
  // Wherever in a flush it happens: the library forgives some places of it less than others.
  for (std::uint64_t kilobytes = 400; kilobytes <= 2100; kilobytes += 85) {
    const std::uint64_t limit = kilobytes << 10U;
    std::filesystem::remove(path);
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit most{limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &most);
      int code = 10;
      try {
        RecordingWriter writer(path, header);
        for (std::uint64_t n = 0; n < 3000; ++n) feedOne(writer, header, n);
        writer.onEnd(Outcome::completed);
        code = 11;
        writer.finish();
        code = 12;
      } catch (const Error& e) {
        const std::string what = e.what();
        const bool good = code == 11 && e.kind() == ErrorKind::failure && what.find("r.h5") != std::string::npos &&
                          what.find(std::strerror(EFBIG)) != std::string::npos && what.find('\n') == std::string::npos;
        if (!good) std::fprintf(stderr, "%s\n", what.c_str());
        code = good ? 0 : 13;
      }
      std::exit(code);  // with the library's own clean-up
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0);
    const ChainVerdict verdict = probe(path);
    EXPECT_TRUE(verdict.intact()) << verdict.flush;
    Recording r(path);
    EXPECT_FALSE(r.complete());
    EXPECT_GE(r.stepCount(), 25U);
    EXPECT_EQ(r.stepCount() % 25, 0U);
    const Recovered saved = recover(path, folder / "saved.h5", true);
    EXPECT_EQ(saved.steps, r.stepCount());
    std::printf("disk full at %llu kB: %llu steps kept\n", static_cast<unsigned long long>(limit >> 10U),
                static_cast<unsigned long long>(r.stepCount()));
  }
}

TEST(DiskFull, AtTheStartLeavesNothing) {
  const Folder folder;
  for (const std::uint64_t limit : {1U, 4096U, 12000U, 20000U, 36000U}) {
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit most{limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &most);
      int code = 10;
      try {
        const RecordingWriter writer(folder / "r.h5", makeHeader());
      } catch (const Error& e) {
        code = e.kind() == ErrorKind::failure ? 0 : 11;
      }
      std::exit(code);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << limit << ": signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << limit;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << limit;
  }
}

/// Names of all objects with their number of attributes, as the library lists them.
std::vector<std::string> objects(const std::filesystem::path& path, bool left) {
  std::vector<std::string> names;
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY | (left ? H5F_ACC_SWMR_READ : 0U), access);
  H5Ovisit2(
      file, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t, const char* name, const H5O_info_t* info, void* out) -> herr_t {
        static_cast<std::vector<std::string>*>(out)->push_back(fmt::format("{} {}", name, info->num_attrs));
        return 0;
      },
      &names, H5O_INFO_BASIC | H5O_INFO_NUM_ATTRS);
  H5Fclose(file);
  H5Pclose(access);
  return names;
}

TEST(Swmr, NothingIsCreatedAfterItHasBegun) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  const pid_t child = ::fork();
  if (child == 0) {
    const RecordingWriter writer(folder / "first.h5", header);  // as it is before the first row
    ::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  const std::vector<std::string> first = objects(folder / "first.h5", true);
  EXPECT_TRUE(probe(folder / "first.h5").intact());
  EXPECT_GT(first.size(), 60U);
  test::writeRecording(folder / "r.h5", header, 310);
  EXPECT_EQ(objects(folder / "r.h5", false), first);
}

TEST(Queue, KeepsOrderAcrossThreads) {
  const Folder folder;
  // Far faster than the disk: the queue grows, nothing is lost or swapped.
  const AttemptHeader header = makeHeader(1, 0);
  RecordingWriter writer(folder / "r.h5", header);
  const test::Step s = test::randomStep(header, 0, 1);
  constexpr std::uint64_t steps = 50000;
  for (std::uint64_t n = 0; n < steps; ++n) {
    test::Step one = s;
    one.result.step = n;
    one.result.events.clear();
    one.digest.component[0] = n * 0x9E3779B97F4A7C15ULL;
    one.result.hand[0].insertion = static_cast<double>(n);
    for (TickOutcome& t : one.ticks) {
      for (HandTick& h : t.hand) h.contactSet = static_cast<std::int64_t>(n) - 1;
    }
    writer.onStep({n, one.samples, one.ticks, one.result, one.digest, 0.0F, {}, {}});
  }
  writer.onEnd(Outcome::completed);
  writer.finish();
  EXPECT_EQ(writer.statistics().steps, steps);
  Recording r(folder / "r.h5");
  ASSERT_EQ(r.stepCount(), steps);
  for (std::uint64_t n = 0; n < steps; ++n) ASSERT_EQ(r.step(n).result.hand[0].insertion, static_cast<double>(n));
}

}  // namespace
}  // namespace calot::recorder
