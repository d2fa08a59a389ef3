// SPDX-License-Identifier: GPL-3.0-or-later
// /device: what a device measured, from its feed into the file and back; killed, damaged, hostile, recovered.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <deque>
#include <fstream>
#include <limits>
#include <set>
#include <thread>

#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recorded_columns.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/recording/recover.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using test::Folder;

/// Samples that are there from the beginning.
class Feed final : public RawSampleFeed {
 public:
  bool take(std::uint64_t endTick, RawSample& out) override {
    if (waiting.empty() || waiting.front().tick >= endTick) return false;
    out = waiting.front();
    waiting.pop_front();
    return true;
  }
  [[nodiscard]] std::array<std::uint64_t, handCount> dropped() const override { return lost; }

  std::deque<RawSample> waiting;
  std::array<std::uint64_t, handCount> lost{};
};

AttemptHeader deviceHeader() {
  AttemptHeader header = test::makeHeader();
  header.deviceSamples = true;
  return header;
}

/// Random bits in every field that may be anything; a sample of each hand every `every` ticks, about a tenth invalid.
std::deque<RawSample> randomSamples(std::uint64_t ticks, std::uint64_t every, std::uint64_t seed) {
  Random random(seed, 17);
  std::deque<RawSample> out;
  for (std::uint64_t tick = 0, n = 0; tick < ticks; tick += every, ++n) {
    for (const Hand hand : {Hand::left, Hand::right}) {
      RawSample raw;
      raw.tick = tick;
      DeviceSample& s = raw.sample;
      s.hand = hand;
      s.deviceTime = hand == Hand::left ? -1 : static_cast<std::int64_t>(random.next());
      s.hostTime = 77'000'000'000 + static_cast<std::int64_t>(tick) * 1'000'000;
      s.sequence = n;
      s.valid = random.next() % 10 != 0;
      for (int i = 0; i < 3; ++i) s.position[i] = random.uniform(-1.0, 1.0);
      if (!s.valid) s.position[0] = std::numeric_limits<double>::quiet_NaN();
      s.orientation = Quat(random.normal(), random.normal(), random.normal(), random.normal());
      s.gripper = random.uniform();
      s.buttons = static_cast<std::uint8_t>(random.next());
      raw.used = s.valid && random.next() % 2 == 0;
      out.push_back(raw);
    }
  }
  return out;
}

void write(const std::filesystem::path& path, Feed& feed, std::uint64_t steps, std::uint64_t firstTick = 0) {
  const AttemptHeader header = deviceHeader();
  RecordingWriter writer(path, header, {true});
  const std::uint64_t before = firstTick / header.ticksPerStep;
  for (std::uint64_t n = 0; n < steps; ++n) {
    if (n == before) writer.takeRawSamples(feed, firstTick);
    const test::Step s = test::randomStep(header, n, 1);
    writer.onStep(
        {n, s.samples, s.ticks, s.result, s.digest, s.lateness, [n] { return test::makeKeyframe(n, 999); }, {}});
  }
  writer.onEnd(Outcome::completed);
  writer.finish();
}

bool same(const RawSample& a, const RawSample& b) {
  const auto bits = [](const RawSample& r) {
    const DeviceSample& s = r.sample;
    std::array<double, 8> v{s.position[0],     s.position[1],     s.position[2],     s.orientation.w(),
                            s.orientation.x(), s.orientation.y(), s.orientation.z(), s.gripper};
    std::array<std::uint64_t, 8> out{};
    std::memcpy(out.data(), v.data(), sizeof out);
    return out;
  };
  return bits(a) == bits(b) && a.tick == b.tick && a.used == b.used && a.sample.deviceTime == b.sample.deviceTime &&
         a.sample.hostTime == b.sample.hostTime && a.sample.sequence == b.sample.sequence &&
         a.sample.hand == b.sample.hand && a.sample.buttons == b.sample.buttons && a.sample.valid == b.sample.valid;
}

std::vector<RawSample> all(Recording& r, Hand hand) { return r.rawSamples(hand, 0, r.rawSampleCount(hand)); }

void expectSame(const std::deque<RawSample>& made, Recording& read) {
  for (const Hand hand : {Hand::left, Hand::right}) {
    const std::vector<RawSample> got = all(read, hand);
    std::size_t i = 0;
    for (const RawSample& raw : made) {
      if (raw.sample.hand != hand) continue;
      ASSERT_LT(i, got.size());
      ASSERT_TRUE(same(raw, got[i])) << i;
      ++i;
    }
    EXPECT_EQ(i, got.size());
  }
}

int python(const std::string& statements) {
  const int status = std::system(("/usr/bin/python3 -c \"import h5py, numpy\n" + statements + "\"").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(RawSamples, EveryBitComesBack) {
  const Folder folder;
  Feed feed;
  const auto made = feed.waiting = randomSamples(3010, 7, 1);
  feed.lost = {0, 3};
  write(folder / "r.h5", feed, 301);
  EXPECT_TRUE(feed.waiting.empty());
  const ChainVerdict verdict = probe(folder / "r.h5");
  EXPECT_TRUE(verdict.intact()) << verdict.flush;
  Recording r(folder / "r.h5");
  EXPECT_TRUE(r.header().deviceSamples);
  expectSame(made, r);
  EXPECT_EQ(r.rawSamplesDropped(Hand::left), 0U);
  EXPECT_EQ(r.rawSamplesDropped(Hand::right), 3U);
}

TEST(RawSamples, OnlyWhatRecordedTicksCouldUse) {
  const Folder folder;
  Feed feed;
  feed.waiting = randomSamples(500, 5, 2);  // of 50 steps; 30 are recorded
  write(folder / "r.h5", feed, 30);
  Recording r(folder / "r.h5");
  EXPECT_EQ(r.rawSampleCount(Hand::left), 60U);
  EXPECT_EQ(all(r, Hand::left).back().tick, 295U);
}

TEST(RawSamples, OfABranchBeginAtTheFork) {
  const Folder folder;
  Feed feed;
  const auto made = feed.waiting = randomSamples(200, 5, 3);
  write(folder / "r.h5", feed, 80, 600);
  EXPECT_TRUE(probe(folder / "r.h5").intact());
  Recording r(folder / "r.h5");
  const std::vector<RawSample> right = all(r, Hand::right);
  ASSERT_EQ(right.size(), 40U);
  EXPECT_EQ(right.front().tick, 600U);
  EXPECT_EQ(right.back().tick, 795U);
}

TEST(RawSamples, OfNoDeviceHaveNoGroup) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", test::makeHeader(), 30);
  Recording r(folder / "r.h5");
  EXPECT_FALSE(r.header().deviceSamples);
  EXPECT_EQ(r.rawSampleCount(Hand::left), 0U);
  EXPECT_TRUE(r.rawSamples(Hand::left, 0, 0).empty());
  EXPECT_EQ(rawStatistics(r, Hand::right).rate, 0.0);
}

TEST(RawSamples, LieOutsideTheChain) {
  const Folder folder;
  Feed with, without;
  with.waiting = randomSamples(500, 5, 4);
  write(folder / "a.h5", with, 50);
  write(folder / "b.h5", without, 50);
  EXPECT_EQ(Recording(folder / "a.h5").status().back().chain, Recording(folder / "b.h5").status().back().chain);
}

TEST(RawSamples, Statistics) {
  const Folder folder;
  Feed feed;
  feed.waiting = randomSamples(1000, 10, 5);
  for (RawSample& raw : feed.waiting) raw.sample.valid = true;
  for (RawSample& raw : feed.waiting) raw.sample.position = Vec3(1, 2, 3);
  std::erase_if(feed.waiting, [](const RawSample& raw) {
    return raw.sample.hand == Hand::left && raw.sample.sequence >= 20 && raw.sample.sequence < 25;
  });
  write(folder / "r.h5", feed, 100);
  Recording r(folder / "r.h5");
  const RawStatistics left = rawStatistics(r, Hand::left), right = rawStatistics(r, Hand::right);
  EXPECT_EQ(left.samples, 95U);
  EXPECT_EQ(left.missing, 5U);
  EXPECT_NEAR(left.rate, 94 / 0.99, 1e-9);
  EXPECT_NEAR(left.maxInterval, 0.06, 1e-9);
  EXPECT_EQ(right.samples, 100U);
  EXPECT_EQ(right.missing, 0U);
  EXPECT_NEAR(right.rate, 100.0, 1e-9);
}

TEST(RawSamples, AreExported) {
  const Folder folder;
  Feed feed;
  const auto made = feed.waiting = randomSamples(500, 5, 6);
  write(folder / "r.h5", feed, 50);
  Recording r(folder / "r.h5");
  exportCsv(r, folder / "csv", false, {});
  std::ifstream in(folder / "csv" / "device_right.csv");
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line.find("device_time (ns),host_time (ns),sequence,tick,position_x (m)"), 0U) << line;
  std::getline(in, line);
  EXPECT_EQ(line.find(std::to_string(made[1].sample.deviceTime) + ",77000000000,0,0,"), 0U) << line;
  std::size_t rows = 1;
  while (std::getline(in, line)) ++rows;
  EXPECT_EQ(rows, 100U);
}

TEST(RawSamples, OfAKilledWriterAreThereUpToTheLastFlush) {
  const Folder folder;
  const std::filesystem::path path = folder / "r.h5";
  const std::deque<RawSample> made = randomSamples(100000, 5, 7);
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const AttemptHeader header = deviceHeader();
    Feed feed;
    feed.waiting = made;
    RecordingWriter writer(path, header);
    writer.takeRawSamples(feed);
    for (std::uint64_t n = 0; n < 10000; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const test::Step s = test::randomStep(header, n, 1);
      writer.onStep(
          {n, s.samples, s.ticks, s.result, s.digest, s.lateness, [n] { return test::makeKeyframe(n, 999); }, {}});
    }
    ::_exit(1);
  }
  const auto flushes = [&path] {
    try {
      return Recording(path, Access::live).status().size() - 1;
    } catch (const Error&) {
      return std::size_t{0};
    }
  };
  for (int i = 0; i < 3000 && flushes() < 5; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(probe(path).intact());
  Recording r(path);
  EXPECT_FALSE(r.complete());
  ASSERT_GE(r.stepCount(), 125U);
  std::deque<RawSample> there;
  for (const RawSample& raw : made) {
    if (raw.tick < r.tickCount()) there.push_back(raw);
  }
  expectSame(there, r);
  recover(path, folder / "saved.h5", false);
  Recording saved(folder / "saved.h5");
  expectSame(there, saved);
  EXPECT_EQ(saved.status().back().chain, r.status().back().chain);
}

/// A recording in which Python did something to `f`; empty where there is no h5py.
class RawSamplesChanged : public ::testing::Test {
 protected:
  void SetUp() override {
    if (python("") != 0) GTEST_SKIP() << "needs /usr/bin/python3 with h5py";
  }
  void change(const std::string& statement) {
    Feed feed;
    feed.waiting = randomSamples(1000, 5, 8);
    write(path, feed, 100);
    ASSERT_EQ(python("f = h5py.File('" + path.string() +
                     "', 'r+'); s = f['/device/left/samples']; c = f['/device/counts']\n" + statement),
              0);
  }
  /// The message with which the file is refused as damaged, or why that is not so.
  [[nodiscard]] std::string refusal() const {
    try {
      probe(path);
    } catch (const Error& e) {
      return e.kind() == ErrorKind::damaged ? e.what() : std::string("another code: ") + e.what();
    }
    return "accepted";
  }
  Folder folder;
  std::filesystem::path path = folder / "r.h5";
};

TEST_F(RawSamplesChanged, IsReadByPython) {
  change(
      "n = f['/status'][-1]['ticks']; k = c[len(f['/status']) - 1]\n"
      "assert len(s) == k['left'] == 200 and c[0]['left'] == 0 and s.dtype.itemsize == 99, (len(s), k)\n"
      "assert s[7]['sequence'] == 7 and s[7]['tick'] == 35 and s[7]['host_time'] == 77035000000 and (s['tick'] < "
      "n).all()\n"
      "assert s.fletcher32 and not s.compression and not s.shuffle");
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(RawSamplesChanged, WhatNoWriterMakesIsNamedWithItsRow) {
  const auto row = [](const std::string& what) { return "r = s[7]; " + what + "; s[7] = r"; };
  std::set<std::string> messages;
  for (const auto& [statement, place] : std::vector<std::pair<std::string, std::string>>{
           {row("r['valid'] = 2"), "/device/left/samples: row 7"},
           {row("r['used'] = 255"), "/device/left/samples: row 7"},
           {row("r['valid'] = 0; r['used'] = 1"), "/device/left/samples: row 7"},
           {row("r['valid'] = 1; r['position'][1] = numpy.inf"), "/device/left/samples: row 7"},
           {row("r['sequence'] = 5"), "/device/left/samples: row 7"},
           {row("r['tick'] = 2**63"), "/device/left/samples: row 7"},
           {"s.resize(199, axis=0)", "/device/left/samples: holds 199"},
           {"c.resize(2, axis=0)", "/device/counts: holds 2"},
           {"r = c[2]; r['left'] = 2**62; c[2] = r", "/device/counts: row 2"},
           {"r = c[2]; r['left_dropped'] = 1; c[2] = r", "/device/counts: row 3"},
           {"r = c[0]; r['right'] = 1; c[0] = r", "/device/counts: row 0"},
           {"del f['/device/left/samples']", "/device/left/samples: "},
           {"del f['/device/counts']", "/device/counts: "},
           {"del f['/device/left/samples']; f['/device/left/samples'] = numpy.zeros(200)", "/device/left/samples: "},
       }) {
    change(statement);
    SCOPED_TRACE(statement);
    messages.insert(refusal());
    expectNames(refusal(), {place});
    // Damaged provenance costs nothing but itself.
    const Recovered saved = recover(path, folder / "saved.h5", true);
    EXPECT_EQ(saved.steps, 100U) << statement << saved.lost;
    EXPECT_TRUE(saved.complete);
    EXPECT_TRUE(probe(folder / "saved.h5").intact());
    Recording r(folder / "saved.h5");
    if (r.header().deviceSamples) {
      EXPECT_LE(r.rawSampleCount(Hand::left), 200U);
      EXPECT_EQ(all(r, Hand::right).size(), r.rawSampleCount(Hand::right));
    }
  }
  EXPECT_EQ(messages.size(), 13U) << "two flags, and otherwise each its own fault";
}

TEST_F(RawSamplesChanged, AFlippedByteIsFoundAndRecoveryCountsWhatItCost) {
  change(
      "at = s.id.get_chunk_info(0)\nf.close()\n"
      "b = open('" +
      path.string() +
      "', 'r+b'); b.seek(at.byte_offset + 500); x = b.read(1)[0]; "
      "b.seek(at.byte_offset + 500); b.write(bytes([x ^ 16]))");
  expectNames(refusal(), {"/device/left/samples: rows 0 to 49: ", "checksum"});
  const Recovered saved = recover(path, folder / "saved.h5", false);
  EXPECT_EQ(saved.steps, 100U);
  Recording r(folder / "saved.h5");
  // The first chunk of 40 rows holds samples of the first flush alone, which is lost with its 50.
  EXPECT_EQ(r.rawSampleCount(Hand::left), 150U);
  EXPECT_EQ(r.rawSamplesDropped(Hand::left), 50U);
  EXPECT_EQ(all(r, Hand::left).front().sample.sequence, 50U);
}

TEST_F(RawSamplesChanged, WithoutTheGroupItIsTheSameAttempt) {
  change("del f['/device']");
  EXPECT_EQ(refusal(), "accepted");
  Recording r(path);
  EXPECT_FALSE(r.header().deviceSamples);
  EXPECT_EQ(r.stepCount(), 100U);
}

}  // namespace
}  // namespace calot::recorder
