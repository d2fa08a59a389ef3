// SPDX-License-Identifier: GPL-3.0-or-later
// Scripts of the site: their input as files, their process, and their values in a cohort.
#include "analytics/external/metric_script.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>

#include "analytics/external/metric_input.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

using support::attemptOf;
using support::Folder;
using support::uuidOf;
using Access = CohortDatabase::Access;

std::string textOfFile(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string writtenScript(const Folder& folder, const std::string& text) {
  std::ofstream(folder.file("m.py")) << text;
  return folder.file("m.py");
}

ExternalMetricRef metricNamed(const std::string& name, std::uint32_t version, const std::string& sha256) {
  ExternalMetric m;
  m.definition.name = m.definition.title = name;
  m.definition.unit = m.definition.displayUnit = "N";
  m.definition.version = version;
  m.definition.direction = Direction::lower;
  m.definition.window = "whole attempt";
  m.definition.filter = "none";
  m.sha256 = sha256;
  return ExternalMetricRef(m);
}

CheckpointValue externalValue(const ExternalMetricRef& metric, double number) {
  CheckpointValue v = makeValue(metric->definition, "", Origin::external, number);
  v.metric = metric;
  return v;
}

TEST(NpyColumn, HeadAndNumbersAreThoseOfTheFormat) {
  const Folder folder;
  NpyColumn column(folder.file("a.npy"), false, 3);
  for (int i = 0; i < 6; ++i) column.put(0.5 * i);
  column.close();
  const std::string bytes = textOfFile(folder.file("a.npy"));
  ASSERT_EQ(bytes.size(), 128U + 6U * 8U);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ(bytes.substr(10, 58), "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), ");
  EXPECT_EQ(bytes[127], '\n');
  double last = 0.0;
  std::memcpy(&last, bytes.data() + 128 + 40, sizeof last);
  EXPECT_EQ(last, 2.5);
}

TEST(ScriptProcess, AProcessThatDoesNotEndIsEnded) {
  const Folder folder;
  const auto begun = std::chrono::steady_clock::now();
  const ScriptEnd end = runScript({"/bin/sleep", "600"}, std::filesystem::temp_directory_path(), {1, 2048}, 0);
  EXPECT_EQ(end.how, ScriptEnd::How::late);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(30));
}

TEST(ScriptProcess, WhatItPrintsAndHowItEndsIsKnown) {
  const ScriptEnd end = runScript({"/bin/sh", "-c", "echo out; echo err >&2; echo answer >&3; exit 5"},
                                  std::filesystem::temp_directory_path(), {20, 2048}, 0);
  EXPECT_EQ(end.how, ScriptEnd::How::exited);
  EXPECT_EQ(end.number, 5);
  EXPECT_EQ(end.answer, "answer\n");
  EXPECT_EQ(end.printed, "out\nerr\n");
  EXPECT_THROW(runScript({"/no/program"}, "/", {}, 0), Error);
}

TEST(MetricScript, TheSameInputGivesTheSameValue) {
  const Folder folder;
  const MetricScript script(
      writtenScript(folder,
                    "NAME='p95'; VERSION=2; UNIT='m'; BETTER='higher'\nimport numpy as np\n"
                    "def compute(a): return np.percentile(a.samples['left_position'][:, 0], 95) + "
                    "np.nanmax(a.samples['left_jaw']) + a.samples['left_pedal'].sum()\n"),
      {});
  EXPECT_EQ(script.metric()->definition.name, "p95");
  EXPECT_EQ(script.metric()->definition.direction, Direction::higher);
  recorder::TrackedMotion motion;
  motion.hand[0].present = true;
  for (int i = 0; i <= 100; ++i) {
    motion.time.push_back(0.01 * i);
    motion.hand[0].position.emplace_back(0.001 * i, 0.0, 0.0);
    motion.hand[0].jaw.push_back(i == 7 ? 0.5 : std::numeric_limits<double>::quiet_NaN());
    motion.hand[0].pedal.push_back(i == 3);
  }
  const recorder::TemporaryFolder input = writeMetricInput(motion, recorder::Outcome::completed, "right", "reach");
  const CheckpointValue value = script.compute(input.path());
  ASSERT_TRUE(value.value);
  EXPECT_NEAR(*value.value, 1.595, 1e-12);
  EXPECT_EQ(value.origin, Origin::external);
  EXPECT_EQ(value, script.compute(input.path()));
}

TEST(MetricScript, WhatItDeclaresIsChecked) {
  const Folder folder;
  const auto refused = [&](const std::string& text, const std::vector<std::string>& values) {
    expectFault(ErrorKind::damaged, "", values, [&] { const MetricScript script(writtenScript(folder, text), {}); });
  };
  refused("def compute(a): return 1\n", {"NAME"});
  refused("NAME='path-length'; VERSION=1; UNIT='m'; BETTER='lower'\ndef compute(a): return 1\n", {"path-length"});
  refused("x = 1\nnothing\n", {"line 2", "NameError"});
}

TEST(ExternalValues, NewestVersionCountsAndAVersionIsOneSource) {
  const Folder folder;
  CohortDatabase cohort(folder.file("c.db"), Access::create);
  cohort.storeAttempt(attemptOf(1, "skilled"), support::valuesOf(30.0, 1.0));
  const std::size_t own = cohort.values(uuidOf(1)).size();
  const ExternalMetricRef first = metricNamed("mine", 1, std::string(64, 'a'));
  const ExternalMetricRef second = metricNamed("mine", 2, std::string(64, 'b'));
  EXPECT_EQ(cohort.storeExternal(uuidOf(1), {externalValue(first, 3.0)}), Imported::added);
  EXPECT_EQ(cohort.storeExternal(uuidOf(1), {externalValue(first, 3.0)}), Imported::unchanged);
  EXPECT_THROW(cohort.storeExternal(uuidOf(1), {externalValue(first, 4.0)}), Error);
  EXPECT_THROW(cohort.checkMetric(*metricNamed("mine", 1, std::string(64, 'c'))), Error);
  cohort.storeExternal(uuidOf(1), {externalValue(second, 5.0)});
  EXPECT_THROW(cohort.checkMetric(*first), Error) << "an older version";
  const std::vector<CheckpointValue> values = cohort.values(uuidOf(1));
  ASSERT_EQ(values.size(), own + 1);
  EXPECT_EQ(values.back(), externalValue(second, 5.0));
  EXPECT_EQ(cohort.allValues().back().value, values.back());
  EXPECT_EQ(cohort.externalMetrics().size(), 2U);
  // Storing the program's own values leaves them; a longer recording doesn't.
  cohort.storeAttempt(attemptOf(1, "skilled"), support::valuesOf(31.0, 1.0));
  EXPECT_EQ(cohort.values(uuidOf(1)).size(), own + 1);
}

TEST(ExternalValues, AreOfTheContentThatTheyWereComputedFrom) {
  const Folder folder;
  CohortDatabase cohort(folder.file("c.db"), Access::create);
  AttemptRecord cut = attemptOf(1, "skilled");
  cut.complete = false;
  cut.steps = 500;
  cut.chainHead[5] = std::byte{7};
  cohort.storeAttempt(cut, support::valuesOf(30.0, 1.0));
  const ExternalMetricRef metric = metricNamed("mine", 1, std::string(64, 'a'));
  cohort.storeExternal(uuidOf(1), {externalValue(metric, 3.0)});
  cohort.storeAttempt(attemptOf(1, "skilled"), support::valuesOf(31.0, 1.0));
  for (const CheckpointValue& v : cohort.values(uuidOf(1))) EXPECT_NE(v.origin, Origin::external);
}

}  // namespace
}  // namespace calot::analytics
