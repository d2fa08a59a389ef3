// SPDX-License-Identifier: GPL-3.0-or-later
// Tables and sentences on a terminal: what a narrow one leaves out, and that numbers stay whole; and the one rule by
// which values of checkpoints are written.
#include "analytics/report/terminal_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/value_tree.h"

namespace calot::analytics {
namespace {

const std::string noteBegins = "Columns left out";

std::string printed(const ReportTable& table, std::size_t columns) {
  std::ostringstream out;
  setTerminalColumns(out, columns);
  table.print(out);
  return out.str();
}

std::size_t longestLine(const std::string& text) {
  std::size_t longest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, columnsOf(line));
  return longest;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// As a sheet has it; each number stands in one cell.
ReportTable sheet() {
  ReportTable table = tableOf("Figures", {"=checkpoint", "=unit", "=better", "value", "pass mark", "95 %", "="});
  table.leastNeeded = {"", "better", "95 %"};
  table.rows.push_back({"structure-force-impulse right-hepatic-artery", "N s", "lower", "1234.1", "1234.2",
                        "[1234.3, 1234.4]", "a reason of many words, none of which is needed to read the figure"});
  table.rows.push_back({"clip-errors", "", "lower", "2", "0.5000", "-", ""});
  return table;
}

TEST(TerminalTable, leavesOutColumnsByItsRuleAndSaysWhich) {
  std::size_t before = 0;
  for (std::size_t columns = 132; columns >= 40; --columns) {
    const std::string text = printed(sheet(), columns);
    EXPECT_LE(longestLine(text), columns) << text;
    std::vector<std::string> missing;
    for (const char* number : {"1234.1", "1234.2", "[1234.3, 1234.4]"}) {
      if (!has(text, number)) missing.push_back(number);
    }
    EXPECT_TRUE(has(text, "1234.1")) << "the value stays: " << text;
    EXPECT_TRUE(has(text, "structure-force-impulse") && has(text, "right-hepatic-artery")) << text;
    const std::string head = text.substr(0, text.find('\n'));
    std::size_t left = 0;
    for (const auto& column : sheet().columns) left += column.first.empty() || has(head, column.first) ? 0 : 1;
    left += has(text, "many words") || has(text, "reason") ? 0 : 1;
    EXPECT_EQ(has(text, noteBegins), left > 0) << text;
    EXPECT_EQ(missing.empty(), has(head, "95 %")) << text;
    EXPECT_GE(left, before) << "a narrower terminal has no column more";
    before = left;
  }
  EXPECT_GE(before, 3U);
}

TEST(TerminalTable, leavesOutInTheTablesOrderThenFromTheRight) {
  ReportTable table = tableOf("", {"=name", "a", "b", "c", "d"});
  table.leastNeeded = {"b"};
  table.rows.push_back({"row", "11111111", "22222222", "33333333", "44444444"});
  const auto left = [&](std::size_t columns) {
    const std::string text = printed(table, columns);
    std::string missing;
    for (const char* digit : {"1", "2", "3", "4"}) missing += has(text, std::string(8, *digit)) ? "" : digit;
    return missing;
  };
  EXPECT_EQ(left(50), "");
  EXPECT_EQ(left(40), "2");
  EXPECT_EQ(left(30), "24");
  EXPECT_EQ(left(20), "234") << "the first two stay";
}

TEST(TerminalTable, aFileKeepsEveryColumn) {
  for (const std::size_t most : {40U, 80U, 120U}) {
    std::ostringstream out;
    sheet().print(out, most);
    EXPECT_TRUE(has(out.str(), "1234.1") && has(out.str(), "1234.2") && has(out.str(), "[1234.3, 1234.4]"));
    EXPECT_FALSE(has(out.str(), noteBegins));
  }
}

TEST(TerminalText, wrapsAtBlanksButNotBetweenANumberAndItsUnit) {
  const std::string text = "The wall is 12.5 mm thick, 95 % of it [0.50, 1.00] in 3 s.";
  for (std::size_t columns = 12; columns < 70; ++columns) {
    const std::string wrapped = wrappedText(text, columns, 2);
    EXPECT_LE(longestLine(wrapped), std::max<std::size_t>(columns, 14)) << wrapped;
    for (const char* whole : {"12.5 mm", "95 %", "[0.50, 1.00]", "3 s."}) EXPECT_TRUE(has(wrapped, whole)) << wrapped;
    std::string joined;
    std::istringstream words(wrapped);
    for (std::string word; words >> word;) joined += (joined.empty() ? "" : " ") + word;
    EXPECT_EQ(joined, text);
  }
}

TEST(TerminalText, sentencesAndTitlesFitTheirTerminal) {
  ReportDocument document{"A title of several words that does not fit a narrow terminal", true, {}};
  document.add("A paragraph that is longer than a narrow terminal is wide, too, and goes on and on.");
  document.addList({"an item that is longer than a narrow terminal is wide, too, and goes on"});
  document.parts.emplace_back(sheet());
  for (const std::size_t columns : {60U, 80U, 132U}) {
    std::ostringstream out;
    setTerminalColumns(out, columns);
    printDocument(document, out);
    EXPECT_LE(longestLine(out.str()), columns) << out.str();
  }
}

TEST(FigureNumber, countsAreWholeAndAllElseHasItsDigits) {
  std::size_t counts = 0;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const CheckpointDefinition& d = entry.definition;
    const bool count = d.domain == Domain::whole;
    counts += count ? 1 : 0;
    EXPECT_EQ(figureNumber(&d, 2.0), count ? "2" : "2.000") << d.name;
    EXPECT_EQ(figureNumber(&d, 12345.0), "12345") << d.name;
    EXPECT_EQ(figureNumber(&d, 7.0 / 3.0), "2.333") << d.name << ": a mean";
    EXPECT_EQ(figureNumber(&d, -1.0, 2), count ? "-1" : "-1.0") << d.name << ": a difference";
    EXPECT_EQ(figureNumber(&d, -1e-12), "0") << d.name;
  }
  EXPECT_GT(counts, 0U);
  EXPECT_EQ(figureNumber(nullptr, 2.0), "2.000") << "what is not known is no count";
}

TEST(FigureNumber, tablesOfResultsWriteByIt) {
  const ValueTree rows{{{"checkpoint", "clip-errors"}, {"v", 2.0}, {"i", {{"lower", 1.0}, {"upper", 2.5}}}},
                       {{"figure", "movements left"}, {"v", 3.0}, {"i", nullptr}},
                       {{"checkpoint", "clip-errors"}, {"source_sha256", "of a script"}, {"v", 2.0}, {"i", nullptr}},
                       {{"figure", "elapsed-time"}, {"v", 2.0}, {"i", nullptr}}};
  const ReportTable table = tableOf("", rows, {{"v", "/v", figure4}, {"i", "/i", figureRange3}});
  EXPECT_EQ(table.rows,
            (std::vector<std::vector<std::string>>{{"2", "[1, 2.50]"}, {"3", "-"}, {"2.000", "-"}, {"2.000", "-"}}));
}

}  // namespace
}  // namespace calot::analytics
