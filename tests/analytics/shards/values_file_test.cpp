// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <random>

#include "analytics/checkpoints/registry.h"
#include "analytics/shards/checked_lines.h"
#include "analytics/shards/values_set.h"
#include "analytics/shards/values_writer.h"

namespace calot::analytics {
namespace {

namespace fs = std::filesystem;

/// Everything that a row can hold, with values and texts that are hard to keep.
ValuesRow oddRow(std::uint64_t position) {
  ValuesRow row;
  row.position = position;
  row.attempt = "0a1b2c3d-0000-4000-8000-000000000000";
  row.file = "folder/one\nof \xff\xfe.h5";
  JudgedRecording& judged = row.judged.emplace();
  recorder::ReplayReport& report = judged.report;
  report.path = row.file;
  report.attempt = row.attempt;
  report.verdict = recorder::ReplayVerdict::undecided;
  report.complete = true;
  report.steps = (std::uint64_t{1} << 53U) - 1;
  report.simulationVersion = 4'000'000'000U;
  report.seconds = 0.1 + 0.2;
  report.wallSeconds = 1e-300;
  report.message = "diverged at \"step\" 3\\4";
  report.remedies = {Remedy::replayAnyway};
  report.misses = {9, 8, 7, 6, 5};
  report.divergence = recorder::Divergence{7, 70, "hand.left", "realPosition", "1 and 2"};
  report.reproducible = false;
  AttemptRecord& a = judged.record.emplace();
  a.uuid = row.attempt;
  a.parent = "parent";
  a.participant = "P\xc3\xa4";
  a.scene = "touch-liver";
  a.sceneMajor = 2;
  a.sceneMinor = 4'294'967'295U;
  a.operatorKind = recorder::OperatorKind::human;
  a.mode = recorder::Mode::assessment;
  a.outcome = recorder::Outcome::technicalFailure;
  a.seed = 18'446'744'073'709'551'615U;
  a.simulationVersion = report.simulationVersion;
  a.synthetic = true;
  a.complete = true;
  a.steps = report.steps;
  a.stepSeconds = 0.01;
  a.chainHead[0] = std::byte{0xab};
  a.chainHead[31] = std::byte{1};
  a.verification = {Verdict::notCheckableHere, "other version", "calot 0.1.0"};
  report.outcome = a.outcome;
  report.chainHead = a.chainHead;
  const CheckpointDefinition& d = checkpointRegistry().front().definition;
  for (const double value : {-0.0, 0.1, 5e-324, -std::numeric_limits<double>::max(), 1.0 / 3.0})
    judged.values.push_back(makeValue(d, "left", Origin::samples, value, "0.340 s without measurement"));
  judged.values.push_back(makeMissing(d, "", Origin::observables, Availability::notAvailable, "time limit"));
  CheckpointValue& other = judged.values.emplace_back(makeValue(d, "", Origin::resimulated, 2.0));
  other.version += 3;
  other.unit = "furlong";
  other.filter = "another";
  CheckpointValue& foreign = judged.values.emplace_back(other);
  foreign.name = "of-no-registry";
  return row;
}

class ValuesFiles : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path path(const std::string& name) const { return folder_ / name; }

  static ValuesHeader header(std::uint32_t number, std::uint32_t of, std::uint64_t recordings) {
    return headerOf(SharedWork::regrade, {number, of}, recordings, {{"a", 1, "x"}, {"a", 2, "y"}, {"a", 3, "z"}});
  }

  fs::path write(const std::string& name, const ValuesHeader& h, std::uint64_t first = 0) const {
    ValuesWriter writer(path(name), h, true);
    for (std::uint64_t i = writer.done().size(); i < h.recordings; ++i) writer.append(oddRow(first + i));
    writer.finish();
    return path(name);
  }

  /// Writes the file once more with other rows, each with a right checksum.
  void change(const fs::path& file,
              const std::function<void(std::size_t line, nlohmann::ordered_json& row)>& what) const {
    std::ifstream in(file);
    std::string text, out;
    for (std::size_t n = 0; std::getline(in, text); ++n) {
      nlohmann::ordered_json row = nlohmann::ordered_json::parse(*rowIn(text));
      what(n, row);
      if (!row.is_discarded()) out += checkedLine(row);
    }
    std::ofstream(file) << out;
  }

  static std::string refusal(const std::vector<fs::path>& files, ErrorKind kind) {
    const ValuesSet set(files, SharedWork::regrade, [](const ValuesRow&) {});
    EXPECT_EQ(set.refused().size(), 1U);
    if (set.refused().empty()) return {};
    EXPECT_EQ(set.refused().front().kind(), kind) << set.refused().front().what();
    return set.refused().front().what();
  }

  fs::path folder_ = fs::temp_directory_path() / ("calot-values-" + std::to_string(std::random_device{}()));
};

TEST_F(ValuesFiles, RowsComeBackAsTheyWere) {
  const fs::path file = write("v", header(1, 1, 3));
  std::uint64_t next = 0;
  const ValuesSet set({file}, SharedWork::regrade, [](const ValuesRow&) {});
  ASSERT_TRUE(set.refused().empty()) << set.refused().front().what();
  set.forEach([&](const ValuesRow& row) {
    const ValuesRow expected = oddRow(next++);
    const ValuesHeader h = header(1, 1, 3);
    EXPECT_EQ(jsonOf(row, h), jsonOf(expected, h));
    EXPECT_EQ(row.file, expected.file);
    EXPECT_EQ(row.judged->values, expected.judged->values);
    EXPECT_TRUE(std::signbit(*row.judged->values.front().value));
    EXPECT_EQ(row.judged->record->seed, expected.judged->record->seed);
    EXPECT_EQ(row.judged->record->chainHead, expected.judged->record->chainHead);
    EXPECT_EQ(row.judged->report.divergence, expected.judged->report.divergence);
    EXPECT_EQ(row.judged->report.misses, expected.judged->report.misses);
    EXPECT_EQ(row.judged->report.remedies, expected.judged->report.remedies);
  });
  EXPECT_EQ(next, 3U);
}

TEST_F(ValuesFiles, OtherDefinitionsAreRefusedByName) {
  const auto changed = [&](const std::function<void(nlohmann::ordered_json & head)>& what) {
    const fs::path file = write("v", header(1, 1, 1));
    change(file, [&](std::size_t line, nlohmann::ordered_json& row) {
      if (line == 0) what(row);
    });
    return file;
  };
  using Json = nlohmann::ordered_json;
  const auto version = changed([](Json& h) { h["checkpoints"][1]["version"] = 77; });
  EXPECT_NE(refusal({version}, ErrorKind::refused).find("path-length is of version 77 there"), std::string::npos);
  const auto filter = changed([](Json& h) { h["checkpoints"][1]["filter"] = "none at all"; });
  EXPECT_NE(refusal({filter}, ErrorKind::refused).find("another unit or filter"), std::string::npos);
  const auto fewer = changed([](Json& h) { h["checkpoints"].erase(0); });
  EXPECT_NE(refusal({fewer}, ErrorKind::refused).find("elapsed-time is not among them"), std::string::npos);
  const auto more = changed([](Json& h) { h["checkpoints"].push_back({{"name", "style"}, {"version", 1}}); });
  EXPECT_NE(refusal({more}, ErrorKind::refused).find("does not know"), std::string::npos);
  const auto simulation = changed([](Json& h) { h["simulation_version"] = 3; });
  EXPECT_NE(refusal({simulation}, ErrorKind::undecided).find("values of simulation version 3"), std::string::npos);
  const auto later = changed([](Json& h) { h["format_version"] = 3; });
  EXPECT_NE(refusal({later}, ErrorKind::undecided).find("values of format 3"), std::string::npos);
  const auto results = changed([](Json& h) { h["step_result_version"] = 1; });
  EXPECT_NE(refusal({results}, ErrorKind::refused).find("step results"), std::string::npos);
}

TEST_F(ValuesFiles, WhatContradictsItselfIsRefused) {
  using Json = nlohmann::ordered_json;
  const auto rows = [&](const std::function<void(std::size_t, Json&)>& what) {
    const fs::path file = write("v", header(1, 1, 2));
    change(file, what);
    return refusal({file}, ErrorKind::damaged);
  };
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 2) r["position"] = 0;
            }).find("line 3: its position is given twice"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 2) r["position"] = 3;
            }).find("behind the plan's end"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 3) r["end"] = 1;
            }).find("2 of 2 recordings are there"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 0) r["recordings"] = 3;
            }).find("2 of 3 recordings"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["record"]["uuid"] = "x";
            }).find("line 2: /record: is of another attempt"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["values"][0].erase("value");
            }).find("/values/0"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["values"][0]["value"] = "1";
            }).find("a number is wanted"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["record"]["steps"] = 1.5;
            }).find("whole number"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["record"]["seed"] = "-1";
            }).find("below 2^64"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["record"]["chain_head"] = "abc";
            }).find("64 hexadecimal"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n != 1) return;
              r["record"]["public_key"] = std::string(64, '0');
              r["record"]["signature"] = std::string(128, '0');
            }).find("not the key's signature"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["extra"] = 1;
            }).find("unknown key"),
            std::string::npos);
  EXPECT_NE(rows([](std::size_t n, Json& r) {
              if (n == 1) r["report"]["verdict"] = "damaged";
            }).find("exactly where"),
            std::string::npos);
}

TEST_F(ValuesFiles, FilesOfOneTakingAreOfOnePlan) {
  const fs::path one = write("1", header(1, 2, 2)), two = write("2", header(2, 2, 1), 2),
                 twice = write("3", header(1, 2, 2));
  const ValuesSet set({one, two}, SharedWork::regrade, [](const ValuesRow&) {});
  EXPECT_TRUE(set.refused().empty());
  EXPECT_EQ(set.rows(), 3U);
  EXPECT_TRUE(set.missing().empty());
  EXPECT_NE(refusal({one, two, twice}, ErrorKind::refused).find("is shard 1 of 2, as is"), std::string::npos);
  const fs::path other = write("4", header(2, 3, 1));
  EXPECT_NE(refusal({one, other}, ErrorKind::refused).find("of another plan (one of 3 shards"), std::string::npos);
  const ValuesSet part({two}, SharedWork::regrade, [](const ValuesRow&) {});
  EXPECT_EQ(part.missing(), std::vector<std::uint32_t>{1});
}

TEST_F(ValuesFiles, FileThatChangesWhileItIsReadIsNoticed) {
  const fs::path file = write("v", header(1, 1, 3));
  const ValuesSet set({file}, SharedWork::regrade, [](const ValuesRow&) {});
  change(file, [](std::size_t n, nlohmann::ordered_json& r) {
    if (n == 1) r["file"] = "longer than it was before, by a lot";
  });
  EXPECT_THROW(set.forEach([](const ValuesRow&) {}), Error);
}

/// Whatever is done to a file, reading it ends with rows or with an error of one line.
TEST_F(ValuesFiles, DamageIsNoticedAndNothingElseHappens) {
  const fs::path file = write("v", header(1, 1, 2));
  std::ifstream in(file, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::mt19937_64 random(11);
  for (int round = 0; round < 400; ++round) {
    std::string text = whole;
    if (round % 4 == 0) {
      text.resize(random() % text.size());
    } else {
      for (std::uint64_t i = 0; i <= random() % 3; ++i)
        text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    if (text == whole) continue;
    std::ofstream(file, std::ios::binary) << text;
    const ValuesSet set({file}, SharedWork::regrade, [](const ValuesRow&) {});
    ASSERT_EQ(set.refused().size(), 1U) << round;
    EXPECT_EQ(std::string(set.refused().front().what()).find('\n'), std::string::npos);
    EXPECT_EQ(set.rows(), 0U);
  }
}

/// The same with right checksums: what a program that means harm could write.
TEST_F(ValuesFiles, StrangeRowsWithRightChecksumsAreRefused) {
  std::mt19937_64 random(12);
  using Json = nlohmann::ordered_json;
  const std::vector<Json> odd{
      nullptr, -1, 1e308, "", "x", true, Json::array(), Json::object(), std::string(70'000, 'y'), Json::array({1, 2})};
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    const fs::path file = write("v", header(1, 1, 1));
    const std::uint64_t line = random() % 3;
    change(file, [&](std::size_t n, Json& row) {
      if (n != line) return;
      std::vector<Json*> all;
      const std::function<void(Json&)> collect = [&](Json& at) {
        for (Json& child : at) {
          all.push_back(&child);
          if (child.is_structured()) collect(child);
        }
      };
      collect(row);
      *all[random() % all.size()] = odd[random() % odd.size()];
    });
    const ValuesSet set({file}, SharedWork::regrade, [](const ValuesRow&) {});
    refused += set.refused().empty() ? 0 : 1;
    for (const Error& e : set.refused()) EXPECT_LT(std::string(e.what()).size(), 1000U);
  }
  EXPECT_GT(refused, 200);  // some changes are of texts, or change nothing
}

}  // namespace
}  // namespace calot::analytics
