// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/names.h"

#include <gtest/gtest.h>

#include "recorder/base/errors.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using Names = std::vector<std::string>;

/// The names of a column once they are spelt.
Names spelt(const Names& written, SimilarNames similar, const Names& known = {}) {
  CsvTable table{"t.csv", ',', {"who", "x"}, {}};
  for (const std::string& name : written) table.rows.push_back({table.rows.size() + 2, {name, name}});
  spellNames(table, {{"none"}, {""}, {"who", known}}, similar);
  Names names;
  for (const CsvRow& row : table.rows) {
    names.push_back(row.cells[0]);
    EXPECT_EQ(row.cells[1], written[names.size() - 1]) << "another column";
  }
  return names;
}

TEST(Names, InTwoFormsOfUnicodeAreOne) {
  EXPECT_EQ(spelt({"Jos\xC3\xA9", "Jose\xCC\x81"}, SimilarNames::ask), (Names{"Jos\xC3\xA9", "Jos\xC3\xA9"}));
  EXPECT_EQ(spelt({"Jos\xC3\xA9"}, SimilarNames::ask, {"Jose\xCC\x81"}), Names{"Jose\xCC\x81"}) << "as it is stored";
  EXPECT_EQ(composedName("a\xFF"), "a\xFF") << "no UTF-8";
}

TEST(Names, ThatAreSimilarAreAskedAbout) {
  for (const auto& [one, other] : {std::pair("001", "1"),
                                   {"P1", "p1"},
                                   {"Novice", "novice"},
                                   {"P01", "P1"},
                                   {"\xC3\x84rzte", "\xC3\xA4rzte"},
                                   {"P\xEF\xBC\x91", "P1"}}) {
    expectFault(ErrorKind::refused, "t.csv: line 3", {"\"who\"", other, one, "line 2"}, [&, a = one, b = other] {
      spelt({a, b}, SimilarNames::ask);
    });
    expectFault(ErrorKind::refused, "t.csv: line 2", {other, one, "stored"},
                [&, a = one, b = other] { spelt({b}, SimilarNames::ask, {a}); });
    EXPECT_EQ(spelt({one, other, one}, SimilarNames::one), (Names{one, one, one}));
    EXPECT_EQ(spelt({other}, SimilarNames::one, {one}), Names{one});
    EXPECT_EQ(spelt({one, other, one}, SimilarNames::two), (Names{one, other, one}));
  }
}

TEST(Names, ThatDifferAreTwo) {
  const Names names{"P1", "P10", "P2", "1.5", "1.05", "100", "10", "", "", "0"};
  EXPECT_EQ(spelt(names, SimilarNames::ask), names);
  EXPECT_EQ(spelt({"P1", "p1"}, SimilarNames::ask, {"P1", "p1"}), (Names{"P1", "p1"})) << "both are stored";
}

}  // namespace
}  // namespace calot::recorder
