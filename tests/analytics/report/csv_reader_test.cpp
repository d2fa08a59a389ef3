// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/csv.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "recorder/base/errors.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

using Cells = std::vector<std::string>;

void expectRefused(ErrorKind kind, const std::string& text, const std::string& place, const Cells& values) {
  expectFault(kind, "t.csv" + place, values, [&] { (void)parseCsvTable(text, "t.csv").column("a"); });
}

TEST(CsvTable, readsWhatRfc4180Allows) {
  const CsvTable table = parseCsvTable(
      "\xEF\xBB\xBF"
      "a,\"b \"\"c\"\"\", d \r\n1,\"two\nlines, one cell\",\r\n\r\n \"x\" ,,3",
      "t.csv");
  EXPECT_EQ(table.columns, (Cells{"a", "b \"c\"", "d"}));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].line, 2U);
  EXPECT_EQ(table.rows[0].cells, (Cells{"1", "two\nlines, one cell", ""}));
  EXPECT_EQ(table.rows[1].line, 5U) << "the cell above has two lines, and one is empty";
  EXPECT_EQ(table.rows[1].cells, (Cells{"x", "", "3"}));
  EXPECT_EQ(table.column("d"), 2U);
  EXPECT_FALSE(table.has("e"));
}

TEST(CsvTable, readsWhatSpreadsheetsWrite) {
  const auto same = [](const std::string& text) {
    SCOPED_TRACE(text);
    const CsvTable table = parseCsvTable(text, "t.csv");
    EXPECT_EQ(table.columns, (Cells{"a", "b, c"}));
    ASSERT_EQ(table.rows.size(), 2U);
    EXPECT_EQ(table.rows[0].cells, (Cells{"\xC3\xA9", "2.5"}));
    EXPECT_EQ(table.rows[1].cells, (Cells{"", "3"}));
  };
  same("a,\"b, c\",,\n\xC3\xA9,2.5,,\n,3,,\n,,,\n,,,\n");
  same("sep=;\r\na;b, c\r\n\xC3\xA9;2.5\r\n;3\r\n;\r\n");
  same("\"sep=|\"\na|b, c\n\xC3\xA9|2.5\n|3\n");
  same("a\tb, c\n\xC3\xA9\t2.5\n\t3\n");
  same("a;\"b, c\"\n\xE9;2.5\n;3\n");  // Latin-1
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("a\tb, c\r\n\xE9\t2.5\r\n\t3\r\n")) wide += {c, '\0'};
  same(wide);
  EXPECT_EQ(parseCsvTable("sep=;\na;b\n1;2\n", "t.csv").rows[0].line, 3U);
}

TEST(CsvTable, takesADecimalCommaWhereCellsAreSeparatedOtherwise) {
  EXPECT_EQ(parseCsvTable("a;b\n1,5;2\n", "t.csv").withPoint("1,5"), "1.5");
  EXPECT_EQ(parseCsvTable("a\tb\n1,5\t2\n", "t.csv").withPoint("1,5"), "1.5");
  EXPECT_EQ(parseCsvTable("a;b\n1;2\n", "t.csv").withPoint("1.234,5"), "1.234,5");
  EXPECT_EQ(parseCsvTable("a,b\n1,2\n", "t.csv").withPoint("1,5"), "1,5");
}

TEST(CsvTable, namesWhereItIsWrong) {
  using enum ErrorKind;
  expectRefused(damaged, "", ": line 1", {"empty"});
  expectRefused(damaged, "\n\n", ": line 1", {"empty"});
  expectRefused(damaged, "a,b\n", ": line 1", {"header", "rows"});
  expectRefused(damaged, "a|b\n1|2\n", ": line 1", {"column", "separator"});
  expectRefused(damaged, "a,b\n1,2\n1,2,3\n", ": line 3", {"3", "2"});
  expectRefused(damaged, "a,b\n1\n", ": line 2", {"1", "2"});
  expectRefused(damaged, "a,b\n1,\"2\n", ": line 2", {"quote"});
  expectRefused(damaged, "a,b\n\"1\"x,2\n", ": line 2: column 1", {"quote"});
  expectRefused(damaged, std::string("a,b\n1,\0\n", 8), "", {"text"});
  expectRefused(invalid, "b,c\n1,2\n", ": line 1", {"\"a\"", "b, c"});
  expectRefused(invalid, "a,a\n1,2\n", ": line 1", {"\"a\""});
}

TEST(CsvTable, givesBackWhatWasWritten) {
  const char* given = std::getenv("CALOT_SEED");
  const unsigned seed = given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : 20261122U;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::string alphabet = "a,\"\n 1.-";
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t columns = 2 + random() % 3, rows = 1 + random() % 5;
    std::vector<Cells> written;
    std::string text;
    for (std::size_t r = 0; r <= rows; ++r) {
      Cells cells;
      for (std::size_t c = 0; c < columns; ++c) {
        std::string cell;
        for (std::size_t n = random() % 6; n > 0; --n) cell += alphabet[random() % alphabet.size()];
        text += c == 0 ? "\"" : ",\"";
        for (const char letter : cell) text += letter == '"' ? std::string("\"\"") : std::string(1, letter);
        text += '"';
        cells.push_back(cell);
      }
      text += trial % 2 == 0 ? "\n" : "\r\n";
      written.push_back(cells);
    }
    const CsvTable table = parseCsvTable(text, "t.csv");
    EXPECT_EQ(table.columns, written[0]);
    ASSERT_EQ(table.rows.size(), rows);
    for (std::size_t r = 0; r < rows; ++r) EXPECT_EQ(table.rows[r].cells, written[r + 1]);
  }
}

TEST(CsvTable, neverCrashesOnAnyBytes) {
  std::mt19937 random(7);
  const std::string alphabet = ",,\"\"\n\r x\xC3";
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text;
    for (std::size_t n = random() % 24; n > 0; --n) text += alphabet[random() % alphabet.size()];
    try {
      for (const CsvRow& row : parseCsvTable(text, "t.csv").rows) EXPECT_GE(row.cells.size(), 2U);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::damaged);
    }
  }
}

}  // namespace
}  // namespace calot::analytics
