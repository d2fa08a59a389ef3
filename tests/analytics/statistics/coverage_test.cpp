// SPDX-License-Identifier: GPL-3.0-or-later
// How often the intervals that reports print hold the truth: simulated, and held against the table in
// docs/explanation/coverage.md. With CALOT_HEAVY set every cell with 4,000 samples (and the table is printed), else the
// column of ten with 400.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/regression.h"
#include "analytics/statistics/reliability.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/standard_setting.h"
#include "analytics/statistics/two_groups.h"
#include "tests/analytics/statistics/support/simulated_designs.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;
using Draw = std::function<double(RandomStream&)>;

struct Ends {
  double lower = 0.0, upper = 0.0;
};

/// One row of the table: an interval of a known truth.
struct Case {
  std::string interval, population;
  double truth = 0.0;
  Draw x, y;
  std::function<std::optional<Ends>(const Values&, const Values&, std::uint64_t seed)> ends;
};

Draw normal(double mean, double deviation = 1.0) {
  return [=](RandomStream& r) { return mean + deviation * r.normal(); };
}
Draw exponential(double shift) {
  return [=](RandomStream& r) { return shift - std::log(r.uniform()); };
}
/// Normal, rounded to halves.
Draw rounded(double shift) {
  return [=](RandomStream& r) { return shift + std::round(2.0 * r.normal()) / 2.0; };
}

template <class T>
std::optional<Ends> endsOf(const Expected<T>& answer) {
  if (!answer) return std::nullopt;
  return Ends{answer->lower, answer->upper};
}

/// Outcomes that lean on a baseline by .6: what is drawn for a group are the errors, its baselines come by the seed.
void addBaselines(std::vector<Case>& list) {
  const auto difference = [](const Values& x, const Values& y, std::uint64_t seed) -> std::optional<Ends> {
    RandomStream random(~seed);  // another one than the errors come from
    std::array<Values, 2> baseline{Values(x.size()), Values(y.size())}, outcome{x, y};
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t i = 0; i < baseline[g].size(); ++i) {
        baseline[g][i] = random.normal();
        outcome[g][i] += 0.6 * baseline[g][i];
      }
    }
    const auto a = covarianceAnalysis({baseline[0], outcome[0]}, {baseline[1], outcome[1]});
    if (!a) return std::nullopt;
    return Ends{a->interval.lower, a->interval.upper};
  };
  const char* name = "difference at one baseline, HC3";
  list.push_back({name, "normal, 1", 1.0, normal(1.0, 0.8), normal(0.0, 0.8), difference});
  list.push_back({name, "exponential, 1", 1.0, exponential(1.0), exponential(0.0), difference});
}

/// What is drawn are attempts (or people) of true worth, deviation 1; leniency of raters and errors come by the seed.
RatingTable rated(const Values& worth, std::size_t columns, double leniency, std::uint64_t seed) {
  RandomStream random(~seed);
  Values lenient(columns);
  for (double& v : lenient) v = leniency * random.normal();
  RatingTable table{worth.size(), columns, {}};
  for (const double w : worth) {
    for (const double l : lenient) table.values.push_back(w + l + random.normal());
  }
  return table;
}

void addRatings(std::vector<Case>& list) {
  const auto icc = [](IccForm form) {
    return [form](const Values& x, const Values&, std::uint64_t seed) -> std::optional<Ends> {
      const auto i = intraclassCorrelation(rated(x, 3, 0.5, seed), form);
      return i ? endsOf(i->interval) : std::nullopt;
    };
  };
  // Variances: attempts 1, leniency 1/4, errors 1.
  const char* raters = "normal, 3 raters";
  list.push_back({"ICC(2,1)", raters, 1.0 / 2.25, normal(0.0), normal(0.0), icc(IccForm::twoSingle)});
  list.push_back({"ICC(2,k)", raters, 1.0 / (1.0 + 1.25 / 3.0), normal(0.0), normal(0.0), icc(IccForm::twoAverage)});
  const auto alpha = [](const Values& x, const Values&, std::uint64_t seed) -> std::optional<Ends> {
    const auto a = cronbachAlpha(rated(x, 5, 0.0, seed));
    return a ? endsOf(a->interval) : std::nullopt;
  };
  list.push_back({"Cronbach's alpha", "normal, 5 items", 5.0 / 6.0, normal(0.0), normal(0.0), alpha});
  list.push_back({"Cronbach's alpha", "exponential, 5 items", 5.0 / 6.0, exponential(0.0), normal(0.0), alpha});
}

/// Agreement of methods, repeatability, pass marks by rating, correlation.
void addDesigns(std::vector<Case>& list) {
  const double limit = 1.96 * std::sqrt(2.0);
  const auto upper = [](const Values& x, const Values& y, std::uint64_t) {
    return endsOf(simulated::upperLimit(x, y));
  };
  list.push_back({"limits of agreement", "normal", limit, normal(0.0), normal(0.0), upper});
  list.push_back({"limits of agreement", "exponential", limit, exponential(0.0), exponential(0.0), upper});
  list.push_back(
      {"slope, Deming", "normal, errors 1/2", 1.0, normal(0.0), normal(0.0),
       [](const Values& x, const Values&, std::uint64_t seed) { return endsOf(simulated::demingSlope(x, seed)); }});
  for (const bool normalErrors : {true, false}) {
    list.push_back({"SEM, SDC", normalErrors ? "normal, 3 attempts" : "exponential, 3 attempts", limit, normal(0.0),
                    normal(0.0), [normalErrors](const Values& x, const Values&, std::uint64_t seed) {
                      return endsOf(simulated::detectableChange(x, normalErrors, seed));
                    }});
  }
  list.push_back(
      {"borderline cut", "normal", 4.0, normal(0.0), normal(0.0),
       [](const Values& x, const Values&, std::uint64_t seed) { return endsOf(simulated::borderlineCut(x, seed)); }});
  for (const double r : {0.3, 0.8}) {
    list.push_back(
        {"rho, Spearman", r < 0.5 ? "normal, r = 0.3" : "normal, r = 0.8", 6.0 / std::acos(-1.0) * std::asin(r / 2.0),
         normal(0.0), normal(0.0),
         [r](const Values& x, const Values& y, std::uint64_t) { return endsOf(simulated::rankCorrelation(x, y, r)); }});
  }
}

std::vector<Case> cases() {
  std::vector<Case> list;
  const auto area = [](const Values& x, const Values& y, std::uint64_t) -> std::optional<Ends> {
    const auto e = estimateSuperiority(x, y, Hypothesis::firstLarger);
    return e ? std::optional<Ends>{Ends{e->a.lower, e->a.upper}} : std::nullopt;
  };
  for (const double a : {0.5, 0.75, 0.95}) {
    char population[40];
    std::snprintf(population, sizeof population, "normal, A = %.2f", a);
    list.push_back({"A, score", population, a, normal(std::sqrt(2.0) * normalQuantile(a)), normal(0.0), area});
  }
  const auto shift = [](const Values& x, const Values& y, std::uint64_t) {
    return endsOf(hodgesLehmannInterval(x, y));
  };
  list.push_back({"shift, Hodges-Lehmann", "normal, shift 1", 1.0, normal(1.0), normal(0.0), shift});
  list.push_back({"shift, Hodges-Lehmann", "normal in halves (ties), shift 1", 1.0, rounded(1.0), rounded(0.0), shift});
  const auto effect = [](const Values& x, const Values& y, std::uint64_t) {
    const auto g = hedgesG(x, y);
    return g ? endsOf(g->interval) : std::nullopt;
  };
  list.push_back({"g, non-central t", "normal, 0", 0.0, normal(0.0), normal(0.0), effect});
  list.push_back({"g, non-central t", "normal, 0.8", 0.8, normal(0.8), normal(0.0), effect});
  list.push_back({"g, non-central t", "normal, 2", 2.0, normal(2.0), normal(0.0), effect});
  list.push_back({"g, non-central t", "exponential, 0.8", 0.8, exponential(0.8), exponential(0.0), effect});
  list.push_back({"cut of contrasting groups", "normal, 70 (5) and 50 (10)", *crossing({70, 5}, {50, 10}),
                  normal(70, 5), normal(50, 10),
                  [](const Values& x, const Values& y, std::uint64_t seed) -> std::optional<Ends> {
                    ContrastingGroupsOptions options;
                    options.resamples = 1999;
                    options.seed = seed;
                    const auto g = contrastingGroups(x, y, Better::higher, options);
                    return g ? endsOf(g->interval) : std::nullopt;
                  }});
  addBaselines(list);
  addRatings(list);
  addDesigns(list);
  return list;
}

struct Covered {
  std::size_t held = 0, answered = 0, drawn = 0;
  [[nodiscard]] double percent() const { return 100.0 * static_cast<double>(held) / static_cast<double>(answered); }
};

Covered simulate(const Case& c, std::size_t n, std::size_t samples, std::uint64_t seed) {
  RandomStream random(seed);
  Covered result;
  // Sums of rounded numbers may miss a truth that they meet exactly by the last bit.
  constexpr double rounding = 1e-9;
  for (std::size_t sample = 0; sample < samples; ++sample) {
    Values x(n), y(n);
    for (double& v : x) v = c.x(random);
    for (double& v : y) v = c.y(random);
    ++result.drawn;
    if (const auto ends = c.ends(x, y, seed + sample)) {
      ++result.answered;
      if (ends->lower <= c.truth + rounding && c.truth <= ends->upper + rounding) ++result.held;
    }
  }
  return result;
}

const std::vector<std::size_t> sizes{5, 10, 20, 40};

/// A cell as the table prints it: bold below 93; how many per cent have an interval at all, where fewer than 99.5 do.
std::string cellOf(const Covered& c) {
  const double answered = 100.0 * static_cast<double>(c.answered) / static_cast<double>(c.drawn);
  if (answered < 50.0) return "-";
  char text[64];
  std::snprintf(text, sizeof text, std::round(10.0 * c.percent()) < 930.0 ? "**%.1f**" : "%.1f", c.percent());
  std::string cell = text;
  if (answered < 99.5) {
    std::snprintf(text, sizeof text, " (of %.0f %%)", answered);
    cell += text;
  }
  return cell;
}

/// First numbers of the four cells of the row in the documentation; none where there is "-".
std::map<std::string, std::vector<std::optional<double>>> documented() {
  std::ifstream file(CALOT_SOURCE_DIR "/docs/explanation/coverage.md");
  std::map<std::string, std::vector<std::optional<double>>> rows;
  std::string line;
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, '|');) cells.push_back(cell);
    if (cells.size() != 7) continue;
    if (cells[1].size() < 2 || cells[2].size() < 2) continue;
    // Between the bars' blanks.
    const std::string name = cells[1].substr(1) + "|" + cells[2].substr(0, cells[2].size() - 1);
    std::vector<std::optional<double>>& row = rows[name];
    for (std::size_t i = 3; i < 7; ++i) {
      const std::size_t digit = cells[i].find_first_of("0123456789");
      row.push_back(digit == std::string::npos ? std::nullopt
                                               : std::optional<double>(std::strtod(cells[i].c_str() + digit, nullptr)));
    }
  }
  return rows;
}

TEST(Coverage, isWhatTheDocumentationSays) {
  const bool heavy = std::getenv("CALOT_HEAVY") != nullptr;
  const std::size_t samples = heavy ? 4000 : 400;
  const std::uint64_t seed = 20140517;
  RecordProperty("seed", std::to_string(seed));
  const auto table = documented();
  for (const Case& c : cases()) {
    const std::string name = c.interval + " | " + c.population;
    std::string line{"| "};
    line.append(name).append(" |");
    const auto row = table.find(name);
    EXPECT_NE(row, table.end()) << "not in docs/explanation/coverage.md: " << line;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (!heavy && sizes[i] != 10) continue;
      const Covered covered = simulate(c, sizes[i], samples, heavy ? seed : seed + 1);
      line.append(" ").append(cellOf(covered)).append(" |");
      if (row == table.end()) continue;
      const std::optional<double> printed = row->second[i];
      ASSERT_EQ(printed.has_value(), cellOf(covered) != "-") << line;
      if (!printed) continue;
      // Both are simulated: four standard errors of either, and the rounding of the table.
      const auto error = [&](double n) {
        return std::sqrt(std::max(*printed, 1.0) * std::max(100.0 - *printed, 1.0) / n);
      };
      const double apart = std::hypot(error(static_cast<double>(covered.answered)), error(4000.0));
      EXPECT_NEAR(covered.percent(), *printed, 4.0 * apart + 0.05) << line << " n = " << sizes[i];
    }
    if (heavy) std::printf("%s\n", line.c_str());
  }
}

TEST(Coverage, ofTheExactIntervalIsNeverBelowItsLevel) {
  // 5 against 5: attained 1 - 2 * 4 / 252 (U <= 2 in 4 of 252 assignments).
  const auto shiftOf = [](Draw x, Draw y, double truth) {
    Case c{"",
           "",
           truth,
           std::move(x),
           std::move(y),
           [](const Values& a, const Values& b, std::uint64_t) {
             return endsOf(hodgesLehmannInterval(a, b)); }};
    return simulate(c, 5, 4000, 55).percent();
  };
  const double attained = 100.0 * (1.0 - 8.0 / 252.0), chance = 400.0 * std::sqrt(0.0317 * 0.9683 / 4000.0);
  EXPECT_NEAR(shiftOf(normal(3.0), normal(0.0), 3.0), attained, chance);
  EXPECT_NEAR(shiftOf(exponential(-1.0), exponential(0.0), -1.0), attained, chance);
  EXPECT_GE(shiftOf(rounded(1.0), rounded(0.0), 1.0), attained - chance);
}

}  // namespace
}  // namespace calot::analytics
