// SPDX-License-Identifier: GPL-3.0-or-later
// Engines that are other programs: the same bits, and whatever becomes of them is the recording's error alone.
#include "recorder/kept/kept_engine.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "recorder/kept/transcript.h"
#include "recorder/replay.h"
#include "sim/scene/version.h"
#include "tests/recorder/support/lying_recording.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;
using test::Lie;

const std::string program = CALOT_ENGINE;

/// What programs use besides their own engine, while a test runs.
class Kept : public testing::Test {
 protected:
  Kept() { useEngines({{folder_ / "engines"}, program, {}}); }
  ~Kept() override { useEngines({}); }

  [[nodiscard]] fs::path recorded(const std::string& name = "r.h5", const std::optional<Lie>& lie = {}) const {
    test::recordTouches(folder_ / name, lie);
    return folder_ / name;
  }
  [[nodiscard]] static ReplayReport apart(const fs::path& file, unsigned threads = 1) {
    ReplaySettings settings;
    settings.engine.apart = true;
    settings.threads = threads;
    return replayRecording(file, settings);
  }
  /// A program that does what a line of shell says.
  [[nodiscard]] fs::path script(const std::string& name, const std::string& line) const {
    fs::create_directories(folder_ / "engines");
    const fs::path file = folder_ / "engines" / name;
    std::ofstream(file) << "#!/bin/sh\n" << line << "\n";
    chmod(file.c_str(), 0755);
    return file;
  }
  [[nodiscard]] ReplayReport replayedBy(const fs::path& engine) const {
    ReplaySettings settings;
    settings.engine.file = engine;
    if (!fs::exists(folder_ / "r.h5")) static_cast<void>(recorded());
    return replayRecording(folder_ / "r.h5", settings);
  }

  test::Folder folder_;
};

TEST_F(Kept, AnEngineApartSaysWhatOneInsideSays) {
  using About = Lie::About;
  int number = 0;
  const auto check = [&](const std::optional<Lie>& lie) {
    const fs::path file = recorded(std::to_string(number++) + ".h5", lie);
    const ReplayReport inside = replayRecording(file, {});
    for (const unsigned threads : {1U, 3U}) {
      const ReplayReport outside = apart(file, threads);
      EXPECT_EQ(outside.verdict, inside.verdict) << outside.error;
      EXPECT_EQ(outside.finding, inside.finding);
      EXPECT_EQ(outside.error, inside.error);
      EXPECT_EQ(outside.divergence, inside.divergence);
      EXPECT_EQ(outside.misses, inside.misses);
    }
  };
  check(std::nullopt);
  for (const About about : {About::contactSet, About::digest, About::event}) check(Lie{about, 120});
  check(Lie{About::lastByte, 99});
}

TEST_F(Kept, TheEngineOfThisVersionIsConfined) {
  const EngineProcess engine({program}, simulationVersion);
  EXPECT_EQ(engine.identity().simulationVersion, simulationVersion);
  EXPECT_EQ(engine.identity().stepResultVersion, stepResultVersion);
#ifdef CALOT_SANITIZED
  EXPECT_EQ(engine.identity().confinement, Confinement::none);
#else
  EXPECT_EQ(engine.identity().confinement, Confinement::own);
#endif
}

TEST_F(Kept, SeekingWithAnEngineApartGivesTheSameStates) {
  Recording recording(recorded());
  Seeker inside(recording);
  Seeker outside(recording, EngineChoice(recording, {.apart = true}));
  for (const std::uint64_t step : {150U, 20U, 99U, 100U, 209U, 209U, 0U}) {
    inside.seek(step);
    outside.seek(step);
    EXPECT_EQ(outside.steps(), step + 1);
    EXPECT_EQ(outside.keyframe().state, inside.keyframe().state) << step;
    EXPECT_EQ(outside.keyframe().haptics, inside.keyframe().haptics) << step;
    EXPECT_EQ(outside.view().surface.at(0).position, inside.view().surface.at(0).position) << step;
  }
}

/// An engine that does not even begin is none: nothing was decided.
TEST_F(Kept, WhatIsNoEngineIsNotBelieved) {
  for (const char* line : {"exit 7", "exec cat", "exec yes", "printf 'hello world, this is a text'; exec sleep 1"}) {
    const ReplayReport report = replayedBy(script("none", line));
    EXPECT_EQ(report.verdict, ReplayVerdict::undecided) << line;
    EXPECT_NE(report.error.find("none"), std::string::npos) << report.error;
  }
  expectNames(replayedBy(script("none", "exit 7")).error, {"7"});
  EXPECT_EQ(replayedBy(folder_ / "r.h5").verdict, ReplayVerdict::undecided) << "no program at all";
}

/// One that ends over a recording is a fault of that recording alone.
TEST_F(Kept, AnEngineThatEndsIsAFaultOfTheRecording) {
  wire::IsHello hello;
  hello.simulation = simulationVersion;
  hello.result = stepResultVersion;
  const std::vector<std::byte> answer = encode(hello);
  std::ofstream(folder_ / "hello", std::ios::binary)
      .write(reinterpret_cast<const char*>(answer.data()), static_cast<std::streamsize>(answer.size()));
  const std::string greet = "cat '" + (folder_ / "hello").string() + "'; ";
  for (const auto& [line, reason] : {std::pair("exit 9", "9"), std::pair("kill -SEGV $$", "signal 11")}) {
    const ReplayReport report = replayedBy(script("weak", greet + line));
    EXPECT_EQ(report.verdict, ReplayVerdict::damaged);
    expectNames(report.error, {reason});
  }
  // What it says instead of an answer is not believed either.
  EXPECT_EQ(replayedBy(script("echo", greet + greet + "exec cat")).verdict, ReplayVerdict::damaged);
}

TEST_F(Kept, TheRecordingsVersionNamesTheEngine) {
  const fs::path file = recorded();
  {
    Recording recording(file);
    EXPECT_TRUE(commandOfEngine(recording.header().simulationVersion).empty());
  }
  static_cast<void>(script("calot-engine-3", "exit 0"));
  static_cast<void>(script("calot-engine-007", "exit 0"));
  static_cast<void>(script("calot-engine-x", "exit 0"));
  static_cast<void>(script("engine-3.wasm", ""));
  static_cast<void>(script("engine-2.wasm", ""));
  const std::vector<KeptEngine> engines = listEngines();
  ASSERT_EQ(engines.size(), 3U);
  EXPECT_EQ(engines[0].version, 2U);
  EXPECT_TRUE(engines[0].isModule);
  EXPECT_TRUE(engines[0].command.empty()) << "nothing here runs it";
  EXPECT_EQ(engines[1].version, 3U);
  EXPECT_FALSE(engines[1].isModule) << "a program goes before a module";
  EXPECT_EQ(commandOfEngine(3), std::vector<std::string>{(folder_ / "engines/calot-engine-3").string()});
  EXPECT_TRUE(commandOfEngine(2).empty());
  EXPECT_THROW(static_cast<void>(commandOf(folder_ / "engines/engine-2.wasm")), Error);
  EXPECT_THROW(static_cast<void>(commandOf(folder_ / "nothing")), Error);
}

TEST_F(Kept, AnEngineOfAnotherVersionIsRefused) {
  expectFault(ErrorKind::undecided, "", {std::to_string(simulationVersion)},
              [&] { const EngineProcess engine({program}, simulationVersion + 1); });
}

TEST_F(Kept, ATranscriptTellsAnEngineFromAnother) {
  Recording recording(recorded());
  const Transcript transcript = makeTranscript({program}, recording, 8);
  EXPECT_EQ(compareWith(transcript, {program}), "");
  EXPECT_EQ(parseHead(transcript.back().answer).kind, wire::Fault::kind);
  const std::vector<std::byte> bytes = bytesOf(transcript);
  const fs::path file = folder_ / "t.transcript";
  const auto write = [&](std::size_t size) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(size));
  };
  write(bytes.size());
  Transcript read = readTranscript(file);
  EXPECT_EQ(bytesOf(read), bytes);
  read.at(5).answer.at(40) ^= std::byte{1};
  EXPECT_NE(compareWith(read, {program}).find("answer 5"), std::string::npos);
  for (const std::size_t size : {bytes.size() - 1, bytes.size() / 2, std::size_t{5}}) {
    write(size);
    EXPECT_THROW(static_cast<void>(readTranscript(file)), Error) << size;
  }
}

}  // namespace
}  // namespace calot::recorder
