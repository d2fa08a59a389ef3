// SPDX-License-Identifier: GPL-3.0-or-later
// How often studies without an effect find one where people differ in slope, spread or in finishing, and how often a
// planted effect is found: whole studies, held against the table of levels in docs/explanation/coverage.md. With
// CALOT_HEAVY set 10,000 studies a cell (and the table is printed), else 200, and effects are left out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "analytics/statistics/resampling.h"
#include "analytics/statistics/two_groups.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/analytics/design/support/asked.h"

namespace calot::analytics::null_levels_test {
namespace {

using support::asked;
using support::Asked;

constexpr double level = 0.05;

/// p of one simulated study. @param effect 0: none
using OneStudy = std::function<double(RandomStream& random, double effect)>;

struct Cell {
  std::string test, population;
  OneStudy p;
  double planted = 0.0;
};

struct People {
  int n = 10, attempts = 6;
};

/// Attempts with a slope of each person's own; x improves faster by `effect`. Spread of values at the start, and
/// errors: 1.
OneStudy repeated(People x, People y, double slopes, bool named) {
  return [=](RandomStream& random, double effect) {
    Asked a = asked(Design::repeated, {"a"});
    a.options.occasionColumns = {"try"};
    std::string text = "id,group,try,a\n";
    for (int g = 0; g < 2; ++g) {
      const People& people = g == 0 ? x : y;
      for (int i = 0; i < people.n; ++i) {
        const double start = random.normal(), slope = -0.5 + slopes * random.normal() - (g == 0 ? effect : 0.0);
        for (int k = 0; k < people.attempts; ++k)
          text += fmt::format("{}{},{},{}{},{}\n", "xy"[g], i, "xy"[g], named ? "at" : "", k + 1,
                              start + slope * k + random.normal());
      }
    }
    return support::reportOf(text, a).json["changes"].back()["p"].get<double>();
  };
}

/// Normal values of unequal spread and one median, or apart by `effect`.
OneStudy spread(int nx, double sx, int ny, double sy, bool brunnerMunzel) {
  return [=](RandomStream& random, double effect) {
    TableStudyOptions options = asked(Design::twoGroups, {"a"}).options;
    options.unequalSpread = brunnerMunzel;
    std::string text = "id,group,a\n";
    for (int i = 0; i < nx; ++i) text += fmt::format("x{},x,{}\n", i, sx * random.normal() + effect);
    for (int i = 0; i < ny; ++i) text += fmt::format("y{},y,{}\n", i, sy * random.normal());
    return makeTableStudy(parseCsvTable(text, "t.csv"), options).rows.at(0).test->p;
  };
}

/// Times of a cohort, of which attempts without an end rank last: `share` of each group, and of y `effect` more.
OneStudy unfinished(int each, double share) {
  return [=](RandomStream& random, double effect) {
    StudyOptions options;
    Protocol& protocol = options.protocol.emplace().protocol;
    protocol.populations = {Population{"expert", "", {}}, Population{"novice", "", {}}};
    protocol.better = "expert";
    protocol.missing = MissingRule::worstRank;
    DirectedHypothesis& hypothesis = protocol.hypotheses.emplace_back();
    hypothesis.checkpoint = "elapsed-time";
    hypothesis.larger = "novice";
    hypothesis.primary = true;
    std::vector<AttemptRow> attempts;
    std::vector<AttemptValue> values;
    for (int i = 0; i < 2 * each; ++i) {
      const bool novice = i % 2 == 1, finishes = random.uniform() >= share + (novice ? effect : 0.0);
      AttemptRow& a = attempts.emplace_back();
      static_cast<AttemptRecord&>(a) = support::humanAttempt(static_cast<unsigned>(i), fmt::format("P{}", i));
      a.group = novice ? "novice" : "expert";
      a.outcome = finishes ? recorder::Outcome::completed : recorder::Outcome::abandoned;
      values.push_back({a.uuid, support::elapsedTime(std::exp(0.3 * random.normal()) * 100.0, a.outcome)});
    }
    const Study study = makeStudy(attempts, values, options, "c.db");
    const StudyRow& row = study.rows.at(0);
    return row.test ? row.test->p : 1.0;
  };
}

/// Normal values of groups that differ by the margin, less `effect`.
OneStudy claimed(int each, bool equivalence) {
  return [=](RandomStream& random, double effect) {
    constexpr double margin = 1.5;
    std::vector<double> larger, other;
    for (int i = 0; i < each; ++i) {
      larger.push_back(random.normal() + margin - effect);
      other.push_back(random.normal());
    }
    return *marginTest(larger, other, margin, equivalence);
  };
}

std::vector<Cell> cells() {
  std::vector<Cell> list;
  for (const double sd : {0.0, 0.3, 0.6})
    list.push_back({"slopes", fmt::format("10 + 10, 6 attempts, slopes of sd {:g}", sd), repeated({}, {}, sd, false),
                    sd == 0.0 ? 0.5 : 3.0 * sd});
  list.push_back({"slopes", "10 with 6 attempts + 10 with 3, sd 0.3", repeated({}, {10, 3}, 0.3, false), 1.5});
  list.push_back({"slopes", "8 with 3 attempts + 16 with 6, sd 0.3", repeated({8, 3}, {16, 6}, 0.3, false), 1.5});
  for (const double sd : {0.0, 0.6})
    list.push_back({"last of 3 occasions less the first", fmt::format("10 + 10, slopes of sd {:g}", sd),
                    repeated({10, 3}, {10, 3}, sd, true), 2.0});
  for (const bool brunnerMunzel : {false, true}) {
    const char* test = brunnerMunzel ? "Brunner-Munzel" : "Mann-Whitney";
    list.push_back({test, "8 of sd 4 + 24 of sd 1", spread(8, 4.0, 24, 1.0, brunnerMunzel), 8.0});
    list.push_back({test, "8 of sd 1 + 24 of sd 4", spread(8, 1.0, 24, 4.0, brunnerMunzel), 5.0});
    list.push_back({test, "10 of sd 4 + 10 of sd 1", spread(10, 4.0, 10, 1.0, brunnerMunzel), 7.0});
    list.push_back({test, "8 + 24, both of sd 1", spread(8, 1.0, 24, 1.0, brunnerMunzel), 1.6});
  }
  for (const bool equivalence : {true, false}) {
    for (const int each : {6, 10, 20})
      list.push_back({equivalence ? "equivalence" : "non-inferiority",
                      fmt::format("{0} + {0}, at a margin of 1.5 sd", each), claimed(each, equivalence), 1.5});
  }
  list.push_back({"worst rank", "10 + 10, 30 % unfinished", unfinished(10, 0.3), 0.69});
  list.push_back({"worst rank", "20 + 20, 50 % unfinished", unfinished(20, 0.5), 0.49});
  return list;
}

/// First numbers of the two cells of the row in the documentation.
std::map<std::string, double> documented() {
  std::ifstream file(CALOT_SOURCE_DIR "/docs/explanation/coverage.md");
  std::map<std::string, double> rows;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> parts;
    std::istringstream text(line);
    for (std::string part; std::getline(text, part, '|');) parts.push_back(part);
    if (parts.size() == 5) rows[parts[1] + "|" + parts[2]] = std::strtod(parts[3].c_str() + 1, nullptr);
  }
  return rows;
}

TEST(NullLevels, areWhatTheDocumentationSays) {
  const bool heavy = std::getenv("CALOT_HEAVY") != nullptr;
  const int studies = heavy ? 10000 : 200;
  const std::map<std::string, double> table = documented();
  for (const Cell& cell : cells()) {
    const auto share = [&](double effect, int count) {
      RandomStream random(2026);
      int found = 0;
      for (int i = 0; i < count; ++i) found += cell.p(random, effect) <= level ? 1 : 0;
      return static_cast<double>(found) / count;
    };
    const double none = share(0.0, studies);
    if (heavy)
      std::cout << fmt::format("| {} | {} | {:.1f} | {:.0f} |", cell.test, cell.population, 100.0 * none,
                               100.0 * share(cell.planted, 1000))
                << std::endl;
    const auto at = table.find(fmt::format(" {} | {} ", cell.test, cell.population));
    ASSERT_NE(at, table.end()) << cell.test << ", " << cell.population;
    const double wanted = at->second / 100.0;
    EXPECT_NEAR(none, wanted, 0.001 + 4.0 * std::sqrt(std::max(wanted, 0.01) * (1.0 - wanted) / studies))
        << cell.test << ", " << cell.population;
  }
}

}  // namespace
}  // namespace calot::analytics::null_levels_test
