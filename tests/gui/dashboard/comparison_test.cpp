// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/comparison.h"

#include <gtest/gtest.h>

#include "analytics/checkpoints/checkpoint.h"
#include "gui/dashboard/cohort_document.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using analytics::AttemptRow;
using analytics::AttemptValue;
using analytics::Verdict;

AttemptRow attempt(const std::string& uuid, const std::string& group, const std::string& key = std::string("k1")) {
  AttemptRow row;
  row.uuid = uuid;
  row.group = group;
  row.comparabilityKey = key;
  row.verification.verdict = Verdict::verified;
  return row;
}

AttemptValue seconds(const std::string& uuid, double value, std::uint32_t version = 1) {
  AttemptValue v;
  v.attempt = uuid;
  v.value.name = std::string("a-checkpoint-of-the-test");  // no definition: shown as stored
  v.value.unit = std::string(1, 's');
  v.value.version = version;
  v.value.value = value;
  return v;
}

const ComparisonRequest request{{"a-checkpoint-of-the-test", ""}, GroupBy::group, "k1", true};

TEST(Comparison, QuartilesOfKnownNumbers) {
  std::vector<AttemptRow> attempts;
  std::vector<AttemptValue> values;
  for (int i = 0; i < 9; ++i) {
    const std::string uuid = std::to_string(i);
    attempts.push_back(attempt(uuid, "expert"));
    values.push_back(seconds(uuid, (i * 4 % 9) + 1.0));  // 1 to 9 in some order
  }
  const Comparison result = compare(attempts, values, request);
  ASSERT_EQ(result.group.size(), 1U);
  // The axis is linear: from both extremes the box follows (quartiles 3 and 7), drawn before the points.
  const auto plot = drawComparison(result, "t", {});
  ASSERT_TRUE(plot);
  ASSERT_EQ(plot->marks.size(), 9U);
  const double one = plot->marks.front().y, perUnit = (plot->marks.back().y - one) / 8.0;
  EXPECT_LT(perUnit, 0.0) << "ascending";
  const analytics::DrawnBox* box = nullptr;
  for (const analytics::Shape& shape : plot->shapes) {
    if (shape.ink == analytics::Ink::firstBox) box = &std::get<analytics::DrawnBox>(shape.form);
  }
  ASSERT_NE(box, nullptr);
  EXPECT_NEAR(box->y, one + 6.0 * perUnit, 1e-9);
  EXPECT_NEAR(box->height, -4.0 * perUnit, 1e-9);
  EXPECT_EQ(result.unit, "s");
  EXPECT_FALSE(result.synthetic);
}

TEST(Comparison, EveryAttemptIsShownOrCountedOnce) {
  std::vector<AttemptRow> attempts{attempt("a", "expert"), attempt("b", "novice"), attempt("c", "novice", "k2"),
                                   attempt("d", ""),       attempt("e", "expert"), attempt("f", "expert"),
                                   attempt("g", "expert"), attempt("h", "expert"), attempt("i", "expert")};
  attempts[4].leftOut = {{3, "excluded", "excluded by hand"}};
  attempts[5].leftOut = attempts[6].leftOut = {{4, "unsound", "diverged"}};
  attempts[7].synthetic = true;
  attempts[7].leftOut = {{8, "synthetic", "synthetic"}, {12, "group", "no group"}};
  std::vector<AttemptValue> values;
  for (const AttemptRow& a : attempts)
    if (a.uuid != "i") values.push_back(seconds(a.uuid, 1.0, a.uuid == "b" ? 1 : 2));
  Comparison result = compare(attempts, values, request);
  EXPECT_EQ(result.shown, 3);
  const auto counts = [&result] {
    std::vector<int> all;
    for (const auto& row : result.leftOut) all.push_back(row.second);
    return all;
  };
  EXPECT_EQ(counts(), (std::vector<int>{1, 1, 2, 1, 1})) << "key, excluded, diverged, version, no value";
  EXPECT_TRUE(result.synthetic);
  ASSERT_EQ(result.group.size(), 2U);
  EXPECT_EQ(result.group[0].name, "(none)");
  EXPECT_EQ(result.group[1].name, "expert");
  expectNames(captionOf(result), {"3", "1", "2 diverged"});

  ComparisonRequest people = request;
  people.includeSynthetic = false;
  result = compare(attempts, values, people);
  EXPECT_EQ(result.shown, 2);
  EXPECT_EQ(counts(), (std::vector<int>{1, 1, 2, 1, 1, 1}));
  EXPECT_FALSE(result.synthetic);
}

TEST(Comparison, ShowsValuesInTheUnitThatTheDefinitionDisplays) {
  const analytics::CheckpointDefinition& definition = *analytics::findCheckpoint("path-length");
  const AttemptValue value{"a", analytics::makeValue(definition, "left", analytics::Origin::samples, 0.25)};
  ComparisonRequest path = request;
  path.figure = {"path-length", "left"};
  const Comparison result = compare({attempt("a", "g")}, {value}, path);
  ASSERT_EQ(result.group.size(), 1U);
  EXPECT_DOUBLE_EQ(result.group[0].point[0].value, 0.25 * definition.displayFactor);
  EXPECT_EQ(result.unit, definition.displayUnit);
}

TEST(Comparison, MostUsedKeyComesFirst) {
  EXPECT_EQ(
      comparabilityKeysOf({attempt("a", "", "z"), attempt("b", "", "y"), attempt("c", "", "z"), attempt("d", "", "x")}),
      (std::vector<std::string>{"z", "x", "y"}));
}

TEST(FigureValues, AreByFigureAndNeedAValue) {
  AttemptValue missing = seconds("a", 0.0);
  missing.value.value.reset();
  const FigureValues none([&](const FigureValues::Take& take) { take(missing); });
  EXPECT_TRUE(none.figures().empty());
  AttemptValue other = seconds("a", 3.0);
  other.value.subject = "left";
  const FigureValues values([&](const FigureValues::Take& take) {
    take(missing);
    take(other);
    take(seconds("b", 2.0));
  });
  ASSERT_EQ(values.figures().size(), 2U);
  EXPECT_EQ(values.figures()[0], request.figure);
  ASSERT_EQ(values.of(0).size(), 2U) << "who has no value is there, too";
  EXPECT_FALSE(values.of(0)[0].value.value);
  EXPECT_EQ(values.of(1).size(), 1U);
  EXPECT_EQ(values.of(1)[0].value.value, 3.0);
}

}  // namespace
}  // namespace calot::gui
