// SPDX-License-Identifier: GPL-3.0-or-later
// Cut, killed, flipped, overwritten: what a recording that went through something bad still says.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>
#include <thread>

#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recover.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using calot::Random;
using test::Folder;
using test::makeHeader;

std::string bytesOfFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void writeFile(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// What opening, reading all, and verifying a file in a child process says.
struct Judgement {
  std::optional<ErrorKind> kind;
  std::string message;
};
Judgement judge(const std::filesystem::path& path) {
  try {
    const ChainVerdict verdict = probe(path);
    return {verdict.intact() ? std::nullopt : std::optional(ErrorKind::refused), ""};
  } catch (const Error& e) {
    return {e.kind(), e.what()};
  }
}

/// Copies the first `count` steps' flushes of a whole recording must agree with what was recovered.
void expectAgrees(const std::filesystem::path& whole, const std::filesystem::path& part) {
  Recording a(whole), b(part);
  ASSERT_LE(b.status().size(), a.status().size());
  for (std::size_t i = 0; i < b.status().size(); ++i)
    EXPECT_EQ(a.status()[i].chain, b.status()[i].chain) << "flush " << i;
  EXPECT_EQ(a.header().attempt, b.header().attempt);
  EXPECT_TRUE(b.verifyChain().intact());
}

TEST(Cut, AClosedFileCutInHalfIsSavedInPart) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 2000, 1, 60000);
  const std::string all = bytesOfFile(folder / "r.h5");
  for (const double part : {0.999, 0.75, 0.5, 0.3}) {
    writeFile(folder / "cut.h5", all.substr(0, static_cast<std::size_t>(static_cast<double>(all.size()) * part)));
    const Judgement j = judge(folder / "cut.h5");
    EXPECT_EQ(j.kind, ErrorKind::damaged);
    EXPECT_NE(j.message.find("cut.h5"), std::string::npos) << j.message;
    const Recovered saved = recover(folder / "cut.h5", folder / "saved.h5", true);
    std::printf("%.3f of the file: %llu of 2000 steps saved; %s\n", part, static_cast<unsigned long long>(saved.steps),
                saved.lost.c_str());
    EXPECT_FALSE(saved.complete);
    EXPECT_FALSE(saved.lost.empty());
    EXPECT_GE(static_cast<double>(saved.steps), 2000 * part * 0.8);
    expectAgrees(folder / "r.h5", folder / "saved.h5");
  }
}

TEST(Cut, AKilledFileCutInHalfIsSavedInPart) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  const pid_t child = ::fork();
  if (child == 0) {
    RecordingWriter writer(folder / "r.h5", header);
    test::feed(
        writer, header, 1010, [&](std::uint64_t n) { return test::randomStep(header, n, 1); }, 60000);
    while (writer.statistics().steps < 1000) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const std::string all = bytesOfFile(folder / "r.h5");
  for (const double part : {0.9, 0.5}) {
    writeFile(folder / "cut.h5", all.substr(0, static_cast<std::size_t>(static_cast<double>(all.size()) * part)));
    EXPECT_EQ(judge(folder / "cut.h5").kind, ErrorKind::damaged);
    const Recovered saved = recover(folder / "cut.h5", folder / "saved.h5", true);
    EXPECT_GE(static_cast<double>(saved.steps), 1000 * part * 0.8);
    EXPECT_FALSE(saved.complete);
    expectAgrees(folder / "r.h5", folder / "saved.h5");
  }
}

TEST(Cut, WhereNothingIsLeftNothingIsWritten) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 100);
  const std::string all = bytesOfFile(folder / "r.h5");
  for (const std::size_t bytes :
       {std::size_t{0}, std::size_t{1}, std::size_t{20}, std::size_t{100}, std::size_t{3000}}) {
    writeFile(folder / "cut.h5", all.substr(0, bytes));
    EXPECT_EQ(judge(folder / "cut.h5").kind, ErrorKind::damaged) << bytes;
    expectFault(ErrorKind::damaged, "", {"cut.h5"}, [&] { recover(folder / "cut.h5", folder / "saved.h5", false); });
  }
  // Neither an output nor anything on the way to one.
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 2U);
}

TEST(Open, WhatIsNoRecordingIsDamaged) {
  const Folder folder;
  EXPECT_EQ(judge(folder / "none.h5").kind, ErrorKind::damaged);
  EXPECT_EQ(judge(folder.path()).kind, ErrorKind::damaged);
  writeFile(folder / "text.h5", "time,x,y,z\n0,0,0,0\n0.1,0,0,0\n0.2,0,0,0\n");
  EXPECT_EQ(judge(folder / "text.h5").kind, ErrorKind::damaged);
  const hid_t other = H5Fcreate((folder / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(other);
  const Judgement j = judge(folder / "other.h5");
  EXPECT_EQ(j.kind, ErrorKind::damaged);
  EXPECT_NE(j.message.find("other.h5"), std::string::npos);
}

/// Place of a data set's chunk in the file (bytes).
std::pair<std::uint64_t, std::uint64_t> chunkPlace(const std::filesystem::path& path, const char* dataset,
                                                   hsize_t index) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t d = H5Dopen2(file, dataset, H5P_DEFAULT);
  const hid_t space = H5Dget_space(d);
  haddr_t at = 0;
  hsize_t size = 0;
  std::array<hsize_t, 2> offset{};
  unsigned mask = 0;
  H5Dget_chunk_info(d, space, index, offset.data(), &mask, &at, &size);
  H5Sclose(space);
  H5Dclose(d);
  H5Fclose(file);
  return {at, size};
}

TEST(Flip, AByteOfAChunkIsFoundAndItsDataSetNamed) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 300);
  const std::string all = bytesOfFile(folder / "r.h5");
  Random random(20);
  for (const char* dataset :
       {"/ticks/left/position", "/ticks/right/orientation", "/ticks/right/force", "/ticks/left/contact_set",
        "/camera/position", "/steps/state_digest", "/steps/field_digest", "/events", "/observables/organs/volume",
        "/observables/left/tip_real", "/keyframes/bytes", "/keyframes/index", "/status"}) {
    const auto [at, size] = chunkPlace(folder / "r.h5", dataset, 0);
    ASSERT_GT(size, 0U) << dataset;
    for (int i = 0; i < 5; ++i) {
      std::string bytes = all;
      const std::size_t place = static_cast<std::size_t>(at + random.next() % size);
      bytes[place] = static_cast<char>(bytes[place] ^ (1 << (random.next() % 8)));
      writeFile(folder / "flipped.h5", bytes);
      const Judgement j = judge(folder / "flipped.h5");
      EXPECT_EQ(j.kind, ErrorKind::damaged) << dataset;
      EXPECT_NE(j.message.find(dataset), std::string::npos) << dataset << ": " << j.message;
      expectNames(j.message, {"checksum"});
    }
  }
}

/// Changes one stored value through the library, as an editor of HDF5 files would.
template <class T>
void change(const std::filesystem::path& path, const char* dataset, hid_t type, hsize_t row, hsize_t column, T value) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t d = H5Dopen2(file, dataset, H5P_DEFAULT);
  const hid_t space = H5Dget_space(d);
  const hid_t one = H5Screate(H5S_SCALAR);
  const std::array<hsize_t, 2> point{row, column};
  H5Sselect_elements(space, H5S_SELECT_SET, 1, point.data());
  EXPECT_GE(H5Dwrite(d, type, one, space, H5P_DEFAULT, &value), 0);
  H5Sclose(one);
  H5Sclose(space);
  H5Dclose(d);
  H5Fclose(file);
}

TEST(Changed, AValueBreaksTheChainAndItsFlushIsNamed) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 300);
  const struct {
    const char* dataset;
    hid_t type;
    hsize_t row;
    std::uint64_t flush;
  } cases[] = {{"/ticks/left/position", H5T_NATIVE_DOUBLE, 1234, 5},
               {"/ticks/right/torque", H5T_NATIVE_DOUBLE, 0, 1},
               {"/observables/right/tip_simulated", H5T_NATIVE_DOUBLE, 299, 12},
               {"/camera/position", H5T_NATIVE_DOUBLE, 2500, 11}};
  for (const auto& c : cases) {
    std::filesystem::copy_file(folder / "r.h5", folder / "c.h5", std::filesystem::copy_options::overwrite_existing);
    change(folder / "c.h5", c.dataset, c.type, c.row, 1, 0.123);
    const ChainVerdict v = probe(folder / "c.h5");
    EXPECT_FALSE(v.intact()) << c.dataset;
    EXPECT_EQ(v.flush, c.flush) << c.dataset;
    EXPECT_EQ(v.firstStep, 25 * (c.flush - 1));
    // What stood before the change can be had.
    if (c.flush > 1) {
      const Recovered saved = recover(folder / "c.h5", folder / "saved.h5", true);
      EXPECT_EQ(saved.steps, 25 * (c.flush - 1));
      expectAgrees(folder / "r.h5", folder / "saved.h5");
    } else {
      EXPECT_THROW(recover(folder / "c.h5", folder / "saved2.h5", true), Error);
      EXPECT_FALSE(std::filesystem::exists(folder / "saved2.h5"));
    }
  }
}

TEST(Changed, AttributesAndSceneAreUnderTheChain) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 30);
  const hid_t file = H5Fopen((folder / "r.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t a = H5Aopen(file, "simulation_version", H5P_DEFAULT);
  const std::uint32_t other = 4;
  EXPECT_GE(H5Awrite(a, H5T_NATIVE_UINT32, &other), 0);
  H5Aclose(a);
  H5Fclose(file);
  const ChainVerdict v = probe(folder / "r.h5");
  EXPECT_FALSE(v.intact());
  EXPECT_EQ(v.flush, 0U);

  test::writeRecording(folder / "s.h5", makeHeader(), 30);
  change<std::uint8_t>(folder / "s.h5", "/scene/description", H5T_NATIVE_UINT8, 3, 0, 255);
  const Judgement j = judge(folder / "s.h5");  // its SHA-256 stands beside it
  EXPECT_EQ(j.kind, ErrorKind::damaged);
  EXPECT_NE(j.message.find("/scene/description"), std::string::npos);
}

TEST(Changed, ValuesThatNoSourceMakesAreNamedWithTheirRow) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(), 60);
  const auto expectNamed = [&](const char* place) {
    const Judgement j = judge(folder / "c.h5");
    EXPECT_EQ(j.kind, ErrorKind::damaged) << place;
    EXPECT_NE(j.message.find(place), std::string::npos) << j.message;
  };
  const auto fresh = [&] {
    std::filesystem::copy_file(folder / "r.h5", folder / "c.h5", std::filesystem::copy_options::overwrite_existing);
  };
  fresh();
  change(folder / "c.h5", "/ticks/left/position", H5T_NATIVE_DOUBLE, 333, 2, std::nan(""));
  expectNamed("/ticks/left/position[333]");
  fresh();
  change(folder / "c.h5", "/camera/orientation", H5T_NATIVE_DOUBLE, 77, 0, 2.0);
  expectNamed("/camera/orientation[77]");
  fresh();
  change<std::uint8_t>(folder / "c.h5", "/ticks/right/instrument", H5T_NATIVE_UINT8, 412, 0, 9);
  expectNamed("/ticks/right/instrument[412]");
  fresh();
  change<std::uint8_t>(folder / "c.h5", "/ticks/right/valid", H5T_NATIVE_UINT8, 5, 0, 2);
  expectNamed("/ticks/right/valid[5]");
  fresh();
  change<std::int64_t>(folder / "c.h5", "/ticks/right/contact_set", H5T_NATIVE_INT64, 599, 0, 1000);
  expectNamed("contact_set[599]");
}

TEST(Fuzz, OverwrittenBytesNeverCrashHangOrPass) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", makeHeader(10, 1), 60, 1, 3000);
  const std::string all = bytesOfFile(folder / "r.h5");
  Recording whole(folder / "r.h5");
  const auto head = whole.status().back().chain;
  Random random(424242);
  int refused = 0, broken = 0, unharmed = 0;
  // The first part holds superblock and object headers, the rest chunks and their index: two thirds of the hits go to
  // the front.
#ifdef CALOT_SANITIZED
  constexpr int files = 80;
#else
  constexpr int files = 400;
#endif
  for (int i = 0; i < files; ++i) {
    std::string bytes = all;
    const std::size_t reach = i % 3 != 0 ? std::min<std::size_t>(all.size(), 40000) : all.size();
    const std::size_t at = random.next() % reach;
    const std::size_t count = 1 + random.next() % 8;
    for (std::size_t b = at; b < std::min(at + count, all.size()); ++b) bytes[b] = static_cast<char>(random.next());
    writeFile(folder / "f.h5", bytes);
    const std::string answer = [&]() -> std::string {
      try {
        return runGuarded(
            "f.h5",
            [&]() -> std::string {
              Recording r(folder / "f.h5");
              for (std::uint64_t n = 0; n < r.stepCount(); ++n) r.step(n);
              for (std::size_t k = 0; k < r.keyframeSteps().size(); ++k) static_cast<void>(r.keyframe(k));
              if (!r.verifyChain().intact()) return "broken";
              return r.status().back().chain == head && r.complete() ? "same" : "SILENT";
            },
            GuardLimits{std::chrono::seconds(20)});
      } catch (const Error& e) {
        const std::string what = e.what();
        EXPECT_EQ(e.kind(), ErrorKind::damaged) << what;
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        for (const char* limit : {"signal", "20 s", "MiB"})  // crashed, hung or swelled
          EXPECT_FALSE(holdsToken(what, limit)) << "at " << at << ": " << what;
        return "refused";
      }
    }();
    EXPECT_NE(answer, "SILENT") << "bytes from " << at;
    (answer == "refused" ? refused : answer == "broken" ? broken : unharmed) += 1;
  }
  std::printf("%d overwritten files: %d refused, %d broken chains, %d unharmed (slack, or outside the chain)\n", files,
              refused, broken, unharmed);
  EXPECT_GT(refused, files / 4);
}

TEST(Guarded, ACrashOrAHangBecomesAnError) {
  const auto becomes = [](ErrorKind kind, const std::string& value, const std::function<std::string()>& task) {
    expectFault(kind, kind == ErrorKind::damaged ? "file" : "", {value},
                [&] { runGuarded("file", task, GuardLimits{std::chrono::seconds(1)}); });
  };
  becomes(ErrorKind::damaged, "signal 9", []() -> std::string {
    ::raise(SIGKILL);
    return "";
  });
  becomes(ErrorKind::damaged, "1 s", []() -> std::string {
    for (volatile unsigned long turns = 0;;) turns = turns + 1;
  });
  expectFault(ErrorKind::failure, "file", {"2 s"}, [] {  // no fault of the file's
    runGuarded(
        "file",
        []() -> std::string {
          for (;;) ::pause();
        },
        GuardLimits{std::chrono::seconds(1), std::size_t{1} << 30U, std::chrono::seconds(2)});
  });
  becomes(ErrorKind::undecided, "x", []() -> std::string { throw Error(ErrorKind::undecided, "x"); });
  becomes(ErrorKind::damaged, "MiB", []() -> std::string { throw std::bad_alloc(); });
  becomes(ErrorKind::failure, "x", []() -> std::string { throw std::runtime_error("x"); });
  const std::string large(1000000, 'a');
  EXPECT_EQ(runGuarded("file", [&] { return large; }), large);
}

TEST(Guarded, TheMessageSaysWhichLimitItWas) {
  const auto guarded = [](const std::function<std::string()>& task) {
    return runGuarded("file", task, {std::chrono::seconds(1), std::size_t{256} << 20U});
  };
  expectFault(ErrorKind::damaged, "file", {"1 s"}, [&] {
    guarded([]() -> std::string {
      for (volatile unsigned long turns = 0;;) turns = turns + 1;
    });
  });
#ifndef CALOT_SANITIZED  // a sanitizer's allocator has its memory beforehand
  expectFault(ErrorKind::damaged, "file", {"256 MiB"},
              [&] { guarded([] { return std::string(std::size_t{512} << 20U, 'a'); }); });
#endif
  EXPECT_EQ(guarded([] { return std::string(std::size_t{1} << 20U, 'a'); }).size(), std::size_t{1} << 20U);
}

TEST(Guarded, AnErrorComesOutOfTheChildAsItWas) {
  const Error made(ErrorKind::damaged, Where{"r.h5", "/ticks"}, "short", {Remedy::recover, Remedy::replayAnyway});
  const auto got = caught([&] { runGuarded("file", [&]() -> std::string { throw made; }); });
  expectFault(made.kind(), "r.h5: /ticks", {"short"}, got, made.remedies());
  ASSERT_TRUE(got);
  EXPECT_EQ(got->where().place, made.where().place);
  EXPECT_STREQ(got->what(), made.what());
}

}  // namespace
}  // namespace calot::recorder
