// SPDX-License-Identifier: GPL-3.0-or-later
// A study of a table: the model. tests/command_line/study_test.py holds its figures against its own calculation.
#include "analytics/report/table_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <span>
#include <sstream>

#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "analytics/statistics/published_coverage.h"
#include "recorder/base/errors.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// R's `sleep` as a table of two unpaired groups. R 4.2.2 with exactRankTests and effectsize: W 25.5, exact p
/// .0658165364, g -.7969352392 [-1.665171791, .0914077328], A .255.
constexpr const char* sleep =
    "id,drug,extra\n1,one,0.7\n2,one,-1.6\n3,one,-0.2\n4,one,-1.2\n5,one,-0.1\n6,one,3.4\n7,one,3.7\n8,one,0.8\n"
    "9,one,0\n10,one,2\n11,two,1.9\n12,two,0.8\n13,two,1.1\n14,two,0.1\n15,two,-0.1\n16,two,4.4\n17,two,5.5\n"
    "18,two,1.6\n19,two,4.6\n20,two,3.4\n";

TableStudyOptions optionsFor(const std::string& outcome) {
  TableStudyOptions options;
  options.participantColumn = "id";
  options.groupColumn = "drug";
  options.outcomes = {outcome};
  return options;
}

Study studyOf(const std::string& text, const TableStudyOptions& options) {
  return makeTableStudy(parseCsvTable(text, "t.csv"), options);
}

TEST(TableStudy, isTheStatisticsOfTheTable) {
  TableStudyOptions options = optionsFor("extra:higher");
  options.better = "two";
  const Study study = studyOf(sleep, options);
  EXPECT_EQ(study.heading, "exploratory");
  EXPECT_FALSE(study.synthetic);
  ASSERT_EQ(study.rows.size(), 1U);
  const StudyRow& row = study.rows[0];
  EXPECT_DOUBLE_EQ(row.test->u, 25.5);
  EXPECT_NEAR(row.test->p, 0.0658165364, 1e-10);
  EXPECT_NEAR(*row.holm, 0.0658165364, 1e-10);
  EXPECT_NEAR(row.hedges->g, -0.7969352392, 1e-9);
  EXPECT_NEAR(row.hedges->interval->lower, -1.665171791, 1e-8);
  EXPECT_NEAR(row.hedges->interval->upper, 0.0914077328, 1e-8);
  EXPECT_EQ(row.hypothesis, Hypothesis::firstSmaller);
  EXPECT_NEAR(row.effect->a, 0.255, 1e-12);
  EXPECT_NEAR(row.area->value.a, 0.745, 1e-12) << "of the hypothesis";
  EXPECT_EQ(row.asHypothesised, true);
}

TEST(TableStudy, directionIsDeclaredAndNeverTakenFromTheData) {
  for (const char* better : {"one", "two"}) {
    for (const char* which : {"lower", "higher"}) {
      TableStudyOptions options = optionsFor(std::string("extra:") + which);
      options.better = better;
      const Study study = studyOf(sleep, options);
      const StudyRow& row = study.rows[0];
      const bool right = (std::string(better) == "two") == (std::string(which) == "higher");
      EXPECT_NEAR(row.area->value.a, right ? 0.745 : 0.255, 1e-12) << better << ' ' << which;
      EXPECT_EQ(row.asHypothesised, right);
      // Either way the interval is the same one, seen from its side.
      const Interval against = studyOf(sleep, optionsFor("extra")).rows[0].area->a;
      EXPECT_NEAR(row.area->a.lower, right ? 1.0 - against.upper : against.lower, 1e-9);
      EXPECT_NEAR(row.area->a.upper, right ? 1.0 - against.lower : against.upper, 1e-9);
    }
  }
  for (const char* outcome : {"extra", "extra:higher"}) {
    const Study study = studyOf(sleep, optionsFor(outcome));
    EXPECT_FALSE(study.rows[0].hypothesis) << "no group is expected to do better";
    EXPECT_FALSE(study.rows[0].asHypothesised);
  }
  TableStudyOptions wrong = optionsFor("extra");
  wrong.better = "three";
  expectFault(ErrorKind::invalid, "", {"\"three\""}, [&] { (void)studyOf(sleep, wrong); });
  expectFault(ErrorKind::invalid, "", {"\"extra:up\""}, [&] { (void)studyOf(sleep, optionsFor("extra:up")); });
  EXPECT_NO_THROW((void)studyOf("id,drug,a:up\n1,x,1\n2,y,2\n", optionsFor("a:up"))) << "a column's own name";
}

TEST(TableStudy, warnsWhereACoverageIsLow) {
  std::string text = "id,drug,v\n";
  for (int i = 0; i < 80; ++i) text += std::to_string(i) + (i < 40 ? ",a," : ",b,") + std::to_string(i * i % 97) + "\n";
  const Study large = studyOf(text, optionsFor("v"));
  ASSERT_EQ(large.rows[0].coverageWarnings.size(), 1U);
  expectNames(large.rows[0].coverageWarnings[0], {"g: ", "40", "95 %", "92.4 %", "0.8"});
  EXPECT_TRUE(studyOf(sleep, optionsFor("extra")).rows[0].coverageWarnings.empty()) << "ten a group";
  const Study few = studyOf("id,drug,v\n1,a,1\n2,a,2\n3,b,3\n4,b,4\n", optionsFor("v"));
  ASSERT_FALSE(few.rows[0].coverageWarnings.empty());
  expectNames(few.rows[0].coverageWarnings[0], {"5"});
  EXPECT_EQ(intervalWarnings(few, true)[0].find("Warning (1 of 1 rows)"), 0U);
  EXPECT_TRUE(intervalWarnings(few, false).empty());
  // What is to be said of several intervals is said once.
  ASSERT_GT(few.rows[0].coverageWarnings.size(), 1U);
  EXPECT_EQ(intervalWarnings(few, true).size(), 1U);
  expectNames(intervalWarnings(few, true)[0], {", g: coverage"});
}

/// A clock that is the same but for its last bits has no group in which it is the faster one.
TEST(TableStudy, roundingIsNoDifference) {
  std::string text = "id,drug,clock,other\n";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("{},{},{},{}\n", i, i < 6 ? "one" : "two", 1000.0 * (1.0 + (i < 6 ? 1e-13 : 2e-13) * i),
                        1000.0 * (1.0 + (i < 6 ? 1e-10 : 2e-10) * i));
  TableStudyOptions options = optionsFor("clock");
  options.outcomes.push_back("other");
  const Study study = studyOf(text, options);
  expectNames(study.rows[0].test.reason(), {"equal"});
  EXPECT_EQ(study.rows[0].group[0].standardDeviation, 0.0);
  EXPECT_FALSE(study.rows[0].hedges);
  EXPECT_TRUE(study.rows[1].test) << "ten digits are a difference";
}

/// Two lengths of attempts, each but for its last bits: as many of both in each group leave no shift and no rank.
TEST(TableStudy, valuesThatDifferByRoundingAreTiedAmongOthersThatDiffer) {
  std::string text = "id,drug,clock\n";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("{},{},{}\n", i, i < 6 ? "one" : "two", (i % 2 == 0 ? 11.7 : 11.0 + 2.0 / 3.0) + 2e-15 * i);
  const Study study = studyOf(text, optionsFor("clock"));
  EXPECT_EQ(*study.rows[0].shift, 0.0);
  EXPECT_EQ(study.rows[0].test->u, 18.0);
  EXPECT_EQ(study.rows[0].test->p, 1.0);
}

TEST(PublishedCoverage, isThatOfThePage) {
  std::ifstream file(std::string(CALOT_SOURCE_DIR) + "/docs/explanation/coverage.md");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  for (const PublishedCoverage& row : publishedCoverage()) {
    const std::string head = fmt::format("| {} | {} |", row.name, row.population);
    std::size_t at = page.find(head);
    ASSERT_NE(at, std::string::npos) << head;
    at += head.size();
    for (const double percent : row.percent) {
      // "**92.3** (of 93 %)": how many samples have an interval at all stands behind.
      const std::string cell =
          percent < coverageWanted ? fmt::format(" **{:.1f}** ", percent) : fmt::format(" {:.1f} ", percent);
      EXPECT_EQ(page.substr(at, cell.size()), cell) << head;
      at = page.find('|', at) + 1;
    }
  }
}

TEST(PublishedCoverage, takesTheWorseOfTheSizesAround) {
  CoverageDoubt doubt;
  EXPECT_FALSE(doubtful(CoveredInterval::hedges, 5, 100, doubt));
  EXPECT_FALSE(doubtful(CoveredInterval::hedges, 20, 20, doubt));
  for (const std::size_t n : {21U, 39U, 40U, 1000U}) {
    EXPECT_TRUE(doubtful(CoveredInterval::hedges, n, 1000, doubt)) << n;
    EXPECT_DOUBLE_EQ(doubt.percent, 92.4);
    EXPECT_EQ(doubt.size, 40U);
  }
  EXPECT_FALSE(doubtful(CoveredInterval::shift, 40, 40, doubt));
  EXPECT_EQ(coverageWarning(CoveredInterval::baseline, "difference", 5, 40), "");
  expectNames(coverageWarning(CoveredInterval::cut, "pass mark", 12, 40),
              {"pass mark: ", "10", "95 %", "90.7 %", "70 (5)", "50 (10)"});
  expectNames(coverageWarning(CoveredInterval::iccSingle, "ICC(2,1)", 4, 4, "attempts"), {"ICC(2,1): ", "5 attempts"});
  EXPECT_TRUE(doubtful(CoveredInterval::areaScore, 4, 40, doubt));
  EXPECT_FALSE(doubt.known);
}

TEST(TableStudy, makesOneValueOfSeveralRowsByTheRuleAlone) {
  const std::string text = "id,drug,v\n1,a,1\n1,a,3\n2,a,5\n2,a,\n3,b,7\n4,b,8\n4,b,10\n4,b,12\n";
  expectFault(ErrorKind::refused, "t.csv: line 3", {"\"1\"", "2", "3"}, [&] { (void)studyOf(text, optionsFor("v")); });
  TableStudyOptions options = optionsFor("v");
  options.attemptRule = AttemptRule::first;
  const Study first = studyOf(text, options);
  EXPECT_EQ(first.rows[0].values[0], (std::vector<double>{1, 5}));
  EXPECT_EQ(first.rows[0].values[1], (std::vector<double>{7, 8}));
  EXPECT_EQ(first.analysed, 4U);
  EXPECT_EQ(first.flow.at(0).attempts, 4U);
  options.attemptRule = AttemptRule::mean;
  const Study mean = studyOf(text, options);
  EXPECT_EQ(mean.rows[0].values[0], (std::vector<double>{2, 5}));
  EXPECT_EQ(mean.rows[0].values[1], (std::vector<double>{7, 10}));
  EXPECT_EQ(mean.rows[0].group[0].partial, 1U) << "of 2 a cell is empty";
  EXPECT_TRUE(mean.flow.empty());
}

TEST(TableStudy, fitsATerminalAndEscapesAPage) {
  const std::string name = "<img src=x onerror=alert(1)> a name that goes on and on and on for a very long time";
  std::string text = "id,drug,\"" + name + "\",\xC3\xA9,zero\n";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("p{},{},{},{},0\n", i, i % 2 == 0 ? "<b>first</b> & a long name of a group" : "second \"'",
                        1e-7 * i, -1e9 * i);
  TableStudyOptions options = optionsFor(name);
  options.outcomes.push_back("\xC3\xA9");
  options.outcomes.push_back("zero");
  const Study study = studyOf(text, options);
  std::ostringstream out;
  printStudy(study, out);
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; }), 120) << line;
  }
  expectHolds(out.str(), {"zero: ", study.rows.back().test.reason()});
  const std::string page = pageHtml(studyDocument(study));
  EXPECT_EQ(page.find("<img"), std::string::npos);
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  expectHolds(page, {"&lt;b&gt;first&lt;/b&gt; &amp;"});
  EXPECT_NE(page.find("exploratory"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

/// What R's `sleep` would have been declared as.
Protocol protocolOf(const std::string& change = "", const std::string& by = "") {
  std::string text = R"({"format": "calot-protocol", "formatVersion": 1, "name": "sleep", "version": 1,
    "title": "The second drug gives more sleep", "populations": [
      {"group": "two", "definition": "who got the second drug"}, {"group": "one", "definition": "who got the first"}],
    "better": "two", "unit": "participant", "attemptRule": "single", "exclusions": {"outcomes": [], "reasons": []},
    "missing": "complete-cases", "level": 0.05, "hypotheses": [
      {"outcome": "extra", "larger": "two", "primary": true},
      {"checkpoint": "path-length", "subject": "left", "larger": "one", "primary": true}]})";
  if (const std::size_t at = text.find(change); !change.empty() && at != std::string::npos)
    text.replace(at, change.size(), by);
  return parseProtocol(std::as_bytes(std::span(text)), "p.json");
}

TEST(TableStudy, aProtocolMakesTheChoices) {
  TableStudyOptions options = optionsFor("extra");
  options.outcomes.clear();
  options.protocol = protocolOf();
  const Study study = studyOf(sleep, options);
  EXPECT_EQ(study.heading, "exploratory");
  ASSERT_TRUE(study.protocol);
  expectNames(study.protocol->whyExploratory, {});
  EXPECT_EQ(study.groups, (std::array<std::string, 2>{"two", "one"})) << "in the protocol's order";
  ASSERT_EQ(study.rows.size(), 1U) << "the hypothesis that has a column";
  const StudyRow& row = study.rows[0];
  EXPECT_EQ(row.role, Role::primary);
  EXPECT_EQ(row.hypothesis, Hypothesis::firstLarger);
  EXPECT_NEAR(row.area->value.a, 0.745, 1e-12);
  // Two primary hypotheses were declared; the one without a column counts as p = 1.
  EXPECT_NEAR(*row.holm, 2 * 0.0658165364, 1e-9);
  EXPECT_EQ(row.supported, false);
  EXPECT_TRUE(std::any_of(study.remarks.begin(), study.remarks.end(),
                          [](const std::string& r) { return holdsToken(r, "path-length left"); }));
  EXPECT_TRUE(study.protocol->deviations.empty());
}

TEST(TableStudy, aProtocolsFiguresAreColumnsByTheirName) {
  std::string text = "id,drug,path-length left,extra\n";
  for (int i = 0; i < 12; ++i) text += fmt::format("{},{},{},{}\n", i, i % 2 == 0 ? "one" : "two", 100 - i, i * i % 7);
  TableStudyOptions options = optionsFor("extra");
  options.protocol = protocolOf();
  options.outcomes = {"path-length left:lower", "extra"};
  const Study study = studyOf(text, options);
  ASSERT_EQ(study.rows.size(), 2U);
  EXPECT_EQ(study.rows[0].role, Role::primary);
  EXPECT_EQ(study.rows[0].hypothesis, Hypothesis::firstSmaller) << "\"larger\": \"one\", which is second";
  EXPECT_EQ(study.rows[1].role, Role::primary);
  options.outcomes = {"path-length left"};
  options.protocol = protocolOf("\"complete-cases\"", "\"worst-rank\"");
  const Study other = studyOf(text, options);
  ASSERT_EQ(other.protocol->deviations.size(), 1U);
  expectNames(other.protocol->deviations[0], {});
}

TEST(TableStudy, whatAProtocolOfATableIsRefusedFor) {
  TableStudyOptions options = optionsFor("extra");
  options.outcomes.clear();
  options.protocol = protocolOf("\"outcome\": \"extra\"", "\"outcome\": \"other\"");
  expectFault(ErrorKind::invalid, "", {"protocol"}, [&] { (void)studyOf(sleep, options); }, {Remedy::nameOutcome});
  expectFault(ErrorKind::damaged, "", {"three", "two"},
              [] { (void)protocolOf("\"group\": \"one\"", "\"group\": \"three\""); });
  expectFault(ErrorKind::damaged, "", {"\"checkpoint\"", "\"external\""},
              [] { (void)protocolOf("\"outcome\": \"extra\", ", ""); });
  expectFault(ErrorKind::damaged, "", {"\"checkpoint\"", "\"external\""}, [] {
    (void)protocolOf("\"outcome\": \"extra\"", "\"outcome\": \"extra\", \"checkpoint\": \"elapsed-time\"");
  });
  expectFault(ErrorKind::damaged, "", {"subject", "table"},
              [] { (void)protocolOf("\"outcome\": \"extra\"", "\"outcome\": \"extra\", \"subject\": \"left\""); });
}

}  // namespace
}  // namespace calot::analytics
