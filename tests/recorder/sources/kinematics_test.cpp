// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/sources/kinematics_source.h"
#include "recorder/sources/pointing.h"
#include "recorder/sources/scene_surfaces.h"
#include "sim/math/random.h"
#include "tests/recorder/sources/support/test_scene.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytesOfText(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

struct Row {
  std::array<Vec3, 2> position{Vec3(0.04, 0.04, 0.0), Vec3(0.08, 0.04, -0.05)};
  std::array<Quat, 2> orientation{Quat::Identity(), Quat::Identity()};
  std::array<double, 2> gripper{0.3, -0.5};
};

// The words of a row; the masters' are zeros with a unit matrix.
std::vector<std::string> wordsOf(const Row& row) {
  std::vector<std::string> words;
  for (std::size_t group = 0; group < 4; ++group) {
    const bool slave = group >= 2;
    const std::size_t h = group % 2;
    const auto put = [&](double v) {
      std::ostringstream text;
      text.precision(17);
      text << v;
      words.push_back(text.str());
    };
    for (int i = 0; i < 3; ++i) put(slave ? row.position[h][i] : 0.0);
    const Mat3 r = slave ? row.orientation[h].toRotationMatrix() : Mat3(Mat3::Identity());
    for (int i = 0; i < 9; ++i) put(r(i / 3, i % 3));
    for (int i = 0; i < 6; ++i) put(0.0);
    put(slave ? row.gripper[h] : 0.0);
  }
  return words;
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& w : words) line.append("   ").append(w);
  return line.append("\n");
}

std::string textOf(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) text += joined(wordsOf(row));
  return text;
}

// A smooth two-handed motion of some centimetres.
std::vector<Row> wave(std::size_t count) {
  std::vector<Row> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / 30.0;
    rows[i].position[0] += 0.01 * Vec3(std::sin(t), std::cos(1.3 * t), std::sin(0.7 * t));
    rows[i].position[1] += 0.01 * Vec3(std::cos(0.9 * t), std::sin(t), std::cos(1.1 * t));
    rows[i].orientation[0] = Quat(Eigen::AngleAxisd(0.5 * t, Vec3(1, 2, 3).normalized()));
    rows[i].gripper[1] = std::sin(t);
  }
  return rows;
}

std::optional<Error> faultOf(const std::string& text) {
  return caught([&] { parseKinematics(bytesOfText(text), "k.txt"); });
}

KinematicsSource sourceOf(const std::vector<Row>& rows, const SceneDescription& scene) {
  return {parseKinematics(bytesOfText(textOf(rows)), "k.txt"), scene};
}

TEST(KinematicsFile, readsTheSlaveGroups) {
  const std::vector<Row> rows = wave(40);
  const KinematicsMotion motion = parseKinematics(bytesOfText(textOf(rows)), "k.txt");
  ASSERT_EQ(motion.rows.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t h = 0; h < 2; ++h) {
      EXPECT_EQ(motion.rows[i][h].position, rows[i].position[h]);
      EXPECT_EQ(motion.rows[i][h].gripper, rows[i].gripper[h]);
      EXPECT_NEAR(std::abs(motion.rows[i][h].orientation.dot(rows[i].orientation[h])), 1.0, 1e-14);
    }
  }
}

TEST(KinematicsFile, hashIsSha256OfTheBytes) {
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(sha256Hex(bytesOfText("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const std::string text = textOf(wave(3));
  EXPECT_EQ(parseKinematics(bytesOfText(text), "k.txt").sha256, sha256Hex(bytesOfText(text)));
}

TEST(KinematicsFile, roundedMatricesAreMadeRotations) {
  std::vector<Row> rows(2);
  rows[0].orientation[0] = Quat(Eigen::AngleAxisd(1.1, Vec3(3, -1, 2).normalized()));
  std::vector<std::string> words = wordsOf(rows[0]);
  for (std::size_t i = 41; i < 50; ++i)
    words[i] = std::to_string(std::round(1e4 * std::stod(words[i])) / 1e4);  // 4 digits
  const KinematicsMotion motion = parseKinematics(bytesOfText(joined(words) + textOf({rows[1]})), "k.txt");
  EXPECT_NEAR(motion.rows[0][0].orientation.norm(), 1.0, 1e-15);
  EXPECT_LT(motion.rows[0][0].orientation.angularDistance(rows[0].orientation[0]), 2e-4);
}

TEST(KinematicsFile, everyFaultIsNamedWithItsLine) {
  const std::string good = textOf(wave(3));
  const auto with = [&](std::size_t column, const std::string& word) {
    std::vector<std::string> words = wordsOf(Row());
    words[column] = word;
    return good + joined(words);
  };
  expectFault(ErrorKind::damaged, "k.txt", {}, faultOf(""));
  expectFault(ErrorKind::damaged, "k.txt", {"0", "2"}, faultOf("\n\n"));
  expectFault(ErrorKind::damaged, "k.txt", {"1", "2"}, faultOf(textOf(wave(1))));
  expectFault(ErrorKind::damaged, "k.txt: line 4", {"3", "76"}, faultOf(good + "1 2 3\n"));
  expectFault(ErrorKind::damaged, "k.txt: line 4", {"77", "76"}, faultOf(with(75, "1 2")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: column 39", {"\"nan\""}, faultOf(with(38, "nan")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: column 4", {"\"inf\""}, faultOf(with(3, "inf")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: column 57", {"\"1e999\""}, faultOf(with(56, "1e999")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: column 57", {"\"0x10\""}, faultOf(with(56, "0x10")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: column 57", {"\"0,5\""}, faultOf(with(56, "0,5")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: columns 39 to 41", {"5"}, faultOf(with(39, "43.6")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: columns 42 to 50", {"0.19", "0.001"}, faultOf(with(41, "0.9")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: columns 61 to 69", {"0.0012", "0.001"}, faultOf(with(60, "1.0006")));
  expectFault(ErrorKind::damaged, "k.txt: line 4: columns 42 to 50", {"2", "0.001"}, faultOf(with(41, "-1")));
  expectFault(ErrorKind::damaged, "k.txt: line 4", {}, faultOf(good + "\n" + good));
  EXPECT_FALSE(faultOf(good + "\n\n"));
  expectFault(ErrorKind::damaged, "k.txt: line 1", {}, faultOf(std::string("\x89HDF\r\n\x1a\n", 8)));
  std::string windows;
  for (const char c : good) {
    if (c == '\n') windows.push_back('\r');
    windows.push_back(c);
  }
  EXPECT_FALSE(faultOf(windows));
  expectFault(ErrorKind::damaged, "k.txt", {}, [] { readKinematics("/nowhere/k.txt"); });
}

TEST(KinematicsSource, rowsFallOnTheirTicks) {
  const SceneDescription scene = test::roundScene();
  const std::vector<Row> rows = wave(61);  // two seconds
  KinematicsSource source = sourceOf(rows, scene);
  const KinematicsMapping& m = source.mapping();
  const Vec3 view = m.axes * Vec3::UnitZ();
  EXPECT_EQ(source.ticks(), 3001U);
  TickSamples samples;
  for (std::uint64_t tick = 0; tick < source.ticks(); ++tick) {
    ASSERT_TRUE(source.next(tick, samples));
    if (tick < 1000 || (tick - 1000) % 100 != 0) continue;
    const std::size_t row = (tick - 1000) * 30 / 1000;
    for (std::size_t h = 0; h < 2; ++h) {
      const Vec3 expected = m.taskCentre + m.slide[h] * view + m.scale * (m.axes * (rows[row].position[h] - m.middle));
      EXPECT_LE((samples.hand[h].position - expected).cwiseAbs().maxCoeff(), 0.51 / 1048576.0);
    }
    EXPECT_NEAR(samples.hand[1].jaw, std::max(0.0, rows[row].gripper[1]), 1e-5);
  }
  EXPECT_FALSE(source.next(source.ticks(), samples));
  EXPECT_FALSE(source.next(source.ticks() + 1, samples));
}

TEST(KinematicsSource, motionIsSmoothAndStartsAtHome) {
  const SceneDescription scene = test::roundScene();
  KinematicsSource source = sourceOf(wave(91), scene);
  TickSamples samples;
  std::array<Vec3, 2> last, lastVelocity;
  for (std::uint64_t tick = 0; source.next(tick, samples); ++tick) {
    for (std::size_t h = 0; h < 2; ++h) {
      const InstrumentSample& hand = samples.hand[h];
      EXPECT_TRUE(hand.valid);
      EXPECT_GE(hand.jaw, 0.0);
      EXPECT_NEAR(hand.orientation.norm(), 1.0, 2e-5);
      const Vec3 shaft = (hand.position - scene.hands[h].port).normalized();
      EXPECT_LT((hand.orientation.normalized() * Vec3::UnitZ() - shaft).norm(), 1e-4);
      if (tick == 0) {
        EXPECT_LE((hand.position - scene.hands[h].home).norm(), 1e-6);
      }
      if (tick > 0) {
        const Vec3 velocity = (hand.position - last[h]) / 0.001;
        EXPECT_LT(velocity.norm(), 0.5);
        // A jump in velocity would show as an acceleration of hundreds; the grid alone makes up to 2 m/s^2 an axis.
        if (tick > 1 && tick != 1000) {
          EXPECT_LT((velocity - lastVelocity[h]).norm() / 0.001, 15.0) << tick;
        }
        lastVelocity[h] = velocity;
      }
      last[h] = hand.position;
    }
  }
}

TEST(KinematicsSource, isTheSameEveryTimeAndOnTheGrid) {
  const SceneDescription scene = test::roundScene();
  const std::vector<Row> rows = wave(31);
  KinematicsSource a = sourceOf(rows, scene), b = sourceOf(rows, scene);
  TickSamples x, y;
  for (std::uint64_t tick = 0; a.next(tick, x); ++tick) {
    ASSERT_TRUE(b.next(tick, y));
    for (std::size_t h = 0; h < 2; ++h) {
      EXPECT_EQ(x.hand[h].position, y.hand[h].position);
      EXPECT_EQ(x.hand[h].orientation.coeffs(), y.hand[h].orientation.coeffs());
      EXPECT_EQ(x.hand[h].jaw, y.hand[h].jaw);
    }
    const TickSamples again = roundedToGrid(x);
    EXPECT_EQ(again.hand[0].position, x.hand[0].position);
  }
}

TEST(KinematicsSource, provenanceNamesTheFileAndItsHash) {
  const fs::path file = fs::path(testing::TempDir()) / "motion one.txt";
  std::ofstream(file, std::ios::binary) << textOf(wave(5));
  const KinematicsSource source(file, test::roundScene());
  EXPECT_EQ(source.provenance().kind, OperatorKind::kinematics);
  EXPECT_EQ(source.provenance().sourceFile, "motion one.txt");
  EXPECT_EQ(source.provenance().sourceSha256, sha256Hex(bytesOfText(textOf(wave(5)))));
  EXPECT_TRUE(source.provenance().profile.empty());
  fs::remove(file);
}

TEST(KinematicsSource, mappingDoesNotDependOnTheFilesOriginAndFitsTheTask) {
  const SceneDescription scene = test::roundScene();
  std::vector<Row> rows = wave(200);
  const KinematicsSource here = sourceOf(rows, scene);
  for (Row& row : rows) {
    for (Vec3& p : row.position) p += Vec3(0.5, -0.25, 0.125);
  }
  const KinematicsSource there = sourceOf(rows, scene);
  EXPECT_NEAR(here.mapping().scale, there.mapping().scale, 1e-12);
  EXPECT_NEAR((here.mapping().taskCentre - there.mapping().taskCentre).norm(), 0.0, 1e-15);
  EXPECT_EQ(here.mapping().slide, there.mapping().slide);

  for (const double factor : {0.01, 0.5, 3.0}) {
    std::vector<Row> scaled = wave(200);
    for (Row& row : scaled) {
      for (Vec3& p : row.position) p *= factor;
    }
    const double scale = sourceOf(scaled, scene).mapping().scale;
    EXPECT_NEAR(scale, std::min(2.0, here.mapping().scale / factor), 1e-9) << factor;
  }
}

TEST(KinematicsSource, aHandThatStandsStillIsAllowed) {
  const SceneDescription scene = test::roundScene();
  KinematicsSource source = sourceOf(std::vector<Row>(10), scene);
  TickSamples samples;
  for (std::uint64_t tick = 0; source.next(tick, samples); ++tick) {
    EXPECT_TRUE(samples.hand[0].position.allFinite());
    EXPECT_TRUE(samples.hand[0].orientation.coeffs().allFinite());
  }
}

TEST(KinematicsSource, aSceneThatShowsNoOrganIsRefused) {
  SceneDescription scene = test::roundScene();
  scene.camera.position = Vec3(0.9, 0.9, -0.1);
  expectFault(ErrorKind::invalid, "", {"picture", "organ"}, [&] { sourceOf(wave(5), scene); });
}

TEST(KinematicsSource, overwrittenBytesNeverCrash) {
  const std::string good = textOf(wave(3));
  Random random(4711);
  int refused = 0;
  for (int n = 0; n < 500; ++n) {
    std::string text = good;
    for (int k = 0; k < 3; ++k) {
      text[static_cast<std::size_t>(random.uniform() * static_cast<double>(text.size()))] =
          static_cast<char>(random.next() & 0xffU);
    }
    if (faultOf(text)) ++refused;
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace calot::recorder
