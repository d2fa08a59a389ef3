// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recover.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using test::Folder;
using test::makeHeader;
using test::randomStep;
using test::Step;

/// Bits, so that -0 and 0 differ.
template <class T>
bool same(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
bool same(const Vec3& a, const Vec3& b) { return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0; }
bool same(const Quat& a, const Quat& b) {
  return std::memcmp(a.coeffs().data(), b.coeffs().data(), 4 * sizeof(double)) == 0;
}

void expectSame(const Step& made, const RecordedStep& read) {
  ASSERT_EQ(made.samples.size(), read.samples.size());
  for (std::size_t t = 0; t < made.samples.size(); ++t) {
    for (std::size_t h = 0; h < handCount; ++h) {
      const InstrumentSample &a = made.samples[t].hand[h], &b = read.samples[t].hand[h];
      EXPECT_TRUE(same(a.position, b.position) && same(a.orientation, b.orientation) && same(a.jaw, b.jaw));
      EXPECT_TRUE(a.instrument == b.instrument && a.buttons == b.buttons && a.valid == b.valid);
      const HandTick &c = made.ticks[t].hand[h], &d = read.ticks[t].hand[h];
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(d.force[i], std::floor(c.force[i] * 16384.0 + 0.5) / 16384.0);
        EXPECT_EQ(d.torque[i], std::floor(c.torque[i] * 1048576.0 + 0.5) / 1048576.0);
      }
      EXPECT_EQ(c.contactSet, d.contactSet);
    }
    EXPECT_TRUE(same(made.samples[t].camera.position, read.samples[t].camera.position));
    EXPECT_TRUE(same(made.samples[t].camera.orientation, read.samples[t].camera.orientation));
    EXPECT_EQ(made.ticks[t].lateness, read.ticks[t].lateness);
  }
  EXPECT_TRUE(made.result.isSameAs(read.result));
  BriefDigest brief;
  shorten(made.digest, brief);
  EXPECT_EQ(brief, read.brief);
  EXPECT_EQ(forceDigest(made.ticks), read.forces);
  EXPECT_EQ(made.lateness, read.lateness);
}

void expectSame(const AttemptHeader& a, const AttemptHeader& b) {
  EXPECT_EQ(a.attempt, b.attempt);
  EXPECT_EQ(a.parent, b.parent);
  EXPECT_EQ(a.forkStep, b.forkStep);
  EXPECT_EQ(a.startUtc, b.startUtc);
  EXPECT_EQ(a.software, b.software);
  EXPECT_EQ(a.build, b.build);
  EXPECT_EQ(a.simulationVersion, b.simulationVersion);
  EXPECT_EQ(a.stepResultVersion, b.stepResultVersion);
  EXPECT_EQ(a.participant, b.participant);
  EXPECT_EQ(a.provenance.kind, b.provenance.kind);
  EXPECT_EQ(a.provenance.profile, b.provenance.profile);
  EXPECT_EQ(a.provenance.profileVersion, b.provenance.profileVersion);
  EXPECT_EQ(a.provenance.sourceFile, b.provenance.sourceFile);
  EXPECT_EQ(a.provenance.sourceSha256, b.provenance.sourceSha256);
  EXPECT_EQ(a.provenance.device, b.provenance.device);
  EXPECT_EQ(a.provenance.calibration, b.provenance.calibration);
  EXPECT_EQ(a.station, b.station);
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.purpose, b.purpose);
  EXPECT_EQ(a.handedness, b.handedness);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.tickSeconds, b.tickSeconds);
  EXPECT_EQ(a.ticksPerStep, b.ticksPerStep);
  EXPECT_EQ(a.sceneName, b.sceneName);
  EXPECT_EQ(a.sceneMajor, b.sceneMajor);
  EXPECT_EQ(a.sceneMinor, b.sceneMinor);
  EXPECT_EQ(a.organs, b.organs);
  EXPECT_EQ(a.vessels, b.vessels);
  EXPECT_EQ(a.fat, b.fat);
  ASSERT_EQ(a.assets.size(), b.assets.size());
  for (std::size_t i = 0; i < a.assets.size(); ++i) {
    EXPECT_EQ(a.assets[i].name, b.assets[i].name);
    EXPECT_EQ(a.assets[i].bytes, b.assets[i].bytes);
  }
  EXPECT_EQ(a.layout.components, b.layout.components);
  ASSERT_EQ(a.layout.fields.size(), b.layout.fields.size());
  for (std::size_t i = 0; i < a.layout.fields.size(); ++i) {
    EXPECT_EQ(a.layout.fields[i].component, b.layout.fields[i].component);
    EXPECT_EQ(a.layout.fields[i].name, b.layout.fields[i].name);
  }
}

struct Shape {
  std::uint32_t ticksPerStep;
  std::size_t organs;
  std::uint64_t steps;
  std::size_t vessels = 0, fat = 0;  // with a procedure, where there are any
};

class RoundTrip : public testing::TestWithParam<Shape> {};

TEST_P(RoundTrip, KeepsEveryBit) {
  const Shape shape = GetParam();
  const Folder folder;
  AttemptHeader header = makeHeader(shape.ticksPerStep, shape.organs);
  if (shape.vessels + shape.fat > 0) header = test::withStructures(header, shape.vessels, shape.fat);
  test::writeRecording(folder / "r.h5", header, shape.steps);
  EXPECT_FALSE(std::filesystem::exists(folder / "r.h5.part"));

  Recording r(folder / "r.h5");
  expectSame(header, r.header());
  EXPECT_TRUE(r.complete());
  EXPECT_EQ(r.outcome(), Outcome::completed);
  ASSERT_EQ(r.stepCount(), shape.steps);
  EXPECT_EQ(r.tickCount(), shape.steps * shape.ticksPerStep);
  std::uint64_t events = 0;
  for (std::uint64_t n = 0; n < shape.steps; ++n) {
    const Step made = randomStep(header, n, 1);
    events += made.result.events.size();
    expectSame(made, r.step(n));
    if (HasFailure()) FAIL() << "step " << n;
  }
  EXPECT_EQ(r.eventCount(), events);
  for (std::size_t k = 0; k < r.keyframeSteps().size(); ++k) {
    const Keyframe made = test::makeKeyframe(r.keyframeSteps()[k], 3001);
    const Keyframe read = r.keyframe(k);
    EXPECT_EQ(made.step, read.step);
    EXPECT_EQ(made.state, read.state);
    EXPECT_EQ(made.haptics, read.haptics);
  }
  EXPECT_TRUE(r.verifyChain().intact());
  if (shape.steps > 0) expectSame(randomStep(header, 0, 1), r.step(0));  // backwards
}

INSTANTIATE_TEST_SUITE_P(Shapes, RoundTrip,
                         testing::Values(Shape{10, 2, 533}, Shape{10, 2, 500}, Shape{10, 0, 60}, Shape{1, 1, 1100},
                                         Shape{7, 3, 200}, Shape{300, 1, 9}, Shape{10, 2, 1}, Shape{10, 2, 0},
                                         Shape{1000, 16, 3}, Shape{10, 2, 260, 3, 1}, Shape{7, 1, 90, 0, 2},
                                         Shape{10, 0, 60, 1, 0}, Shape{10, 6, 30, 7, 3}));

/// Recordings from before StepResult grew are read as they are; what they do not hold stays at nothing.
TEST(EarlierVersion, OfStepResultIsRead) {
  const Folder folder;
  AttemptHeader header = makeHeader();
  header.stepResultVersion = 1;
  test::writeRecording(folder / "r.h5", header, 60);
  Recording r(folder / "r.h5");
  EXPECT_TRUE(r.verifyChain().intact());
  const Step made = randomStep(header, 59, 1);
  EXPECT_EQ(r.step(59).result.contact.rows, made.result.contact.rows);
  EXPECT_EQ(r.step(59).result.hand[1].structureForce, made.result.hand[1].structureForce);
  EXPECT_EQ(r.step(59).result.contact.blocks, 0U);
  EXPECT_EQ(r.step(59).result.hand[1].graspForce, 0.0);
}

TEST(Chain, SameContentSameChain) {
  const Folder folder;
  test::writeRecording(folder / "a.h5", makeHeader(), 77);
  test::writeRecording(folder / "b.h5", makeHeader(), 77);
  test::writeRecording(folder / "c.h5", makeHeader(), 77, 2);
  const Recording a(folder / "a.h5"), b(folder / "b.h5"), c(folder / "c.h5");
  EXPECT_EQ(a.status().back().chain, b.status().back().chain);
  EXPECT_NE(a.status().back().chain, c.status().back().chain);
  EXPECT_EQ(a.status().front().chain, c.status().front().chain);
}

TEST(Writer, RefusesToOverwriteWithoutForce) {
  const Folder folder;
  std::ofstream(folder / "r.h5") << "mine";
  expectFault(ErrorKind::invalid, "", {"r.h5"}, [&] { const RecordingWriter writer(folder / "r.h5", makeHeader()); },
              {Remedy::replaceExisting});
  std::string text;
  std::ifstream(folder / "r.h5") >> text;
  EXPECT_EQ(text, "mine");
  EXPECT_FALSE(std::filesystem::exists(folder / "r.h5.part"));
  test::writeRecording(folder / "r.h5", makeHeader(), 3);  // with force
  EXPECT_EQ(Recording(folder / "r.h5").stepCount(), 3U);
}

TEST(Writer, NamesAFolderThatIsNotThere) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "no" / "r.h5";
  expectFault(ErrorKind::invalid, file.string(), {file.parent_path().string()},
              [&] { const RecordingWriter writer(file, makeHeader()); });
}

TEST(Writer, LeftWithoutAnEndStaysIncomplete) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  {
    RecordingWriter writer(folder / "r.h5", header);
    test::feed(
        writer, header, 30, [&](std::uint64_t n) { return randomStep(header, n, 1); }, 0);
  }
  Recording r(folder / "r.h5");
  EXPECT_FALSE(r.complete());
  EXPECT_EQ(r.outcome(), Outcome::running);
  EXPECT_EQ(r.stepCount(), 30U);
  EXPECT_TRUE(r.verifyChain().intact());
}

TEST(Recover, OfAWholeFileIsTheSameAttempt) {
  const Folder folder;
  const AttemptHeader header = makeHeader();
  test::writeRecording(folder / "r.h5", header, 333);
  const Recovered saved = recover(folder / "r.h5", folder / "o.h5", false);
  EXPECT_TRUE(saved.complete);
  EXPECT_EQ(saved.steps, 333U);
  EXPECT_TRUE(saved.lost.empty());
  Recording r(folder / "r.h5"), o(folder / "o.h5");
  ASSERT_EQ(r.status().size(), o.status().size());
  for (std::size_t i = 0; i < r.status().size(); ++i) EXPECT_EQ(r.status()[i].chain, o.status()[i].chain);
  for (std::uint64_t n = 0; n < 333; ++n) expectSame(randomStep(header, n, 1), o.step(n));
  EXPECT_THROW(recover(folder / "r.h5", folder / "o.h5", false), Error);
  EXPECT_THROW(recover(folder / "r.h5", folder / "r.h5", true), Error);
}

}  // namespace
}  // namespace calot::recorder
