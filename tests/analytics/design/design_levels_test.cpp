// SPDX-License-Identifier: GPL-3.0-or-later
// What the designs say where there is nothing, and where something was put: whole studies of made up tables. The mixed
// model's are in tests/analytics/statistics. With CALOT_HEAVY set 50,000 studies each, else 2,000.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <random>
#include <string>

#include "tests/analytics/design/support/asked.h"

namespace calot::analytics {
namespace {

using support::asked;
using support::Asked;
using support::reportOf;

constexpr double level = 0.05;
constexpr int perGroup = 20;

struct Simulated {
  Asked asked;
  /// A table of two or three groups. @param effect 0: none
  std::function<std::string(std::mt19937&, double effect)> table;
  std::function<double(const nlohmann::ordered_json&)> p;  ///< of the report's results
  double planted;                                          ///< effect that is nearly always found
};

double normal(std::mt19937& random) { return std::normal_distribution<double>(0.0, 1.0)(random); }

/// Asymptotic tests of small samples are not exact: a hundredth either way, and four standard errors of the share.
void expectLevelAndPower(const char* name, const Simulated& s) {
  const int studies = std::getenv("CALOT_HEAVY") != nullptr ? 50000 : 2000;
  const auto share = [&](double effect, int count) {
    std::mt19937 random(2026);
    int found = 0;
    for (int i = 0; i < count; ++i) found += s.p(reportOf(s.table(random, effect), s.asked).json) <= level ? 1 : 0;
    return static_cast<double>(found) / count;
  };
  const double none = share(0.0, studies), some = share(s.planted, 50);
  std::cout << fmt::format("{}: {:.4f} of {} studies without an effect, {:.2f} of 50 with one\n", name, none, studies,
                           some);
  EXPECT_LE(std::abs(none - level), 0.01 + 4.0 * std::sqrt(level * (1.0 - level) / studies));
  EXPECT_GE(some, 0.9);
}

TEST(DesignLevels, severalGroups) {
  Simulated s{asked(Design::severalGroups, {"a"}), {}, {}, 1.5};
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,group,a\n";
    for (int i = 0; i < 3 * perGroup; ++i)
      text += fmt::format("P{},{},{}\n", i, "xyz"[i % 3], std::exp(normal(random) + (i % 3 == 1 ? effect : 0.0)));
    return text;
  };
  s.p = [](const auto& json) { return json["results"][0]["kruskal_wallis"]["p"].template get<double>(); };
  expectLevelAndPower("Kruskal-Wallis", s);
}

/// Sites differ by far more than groups, and have unequal shares of them.
TEST(DesignLevels, strata) {
  Simulated s{asked(Design::strata, {"a"}), {}, {}, 1.5};
  s.asked.choices.strata = "site";
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,group,site,a\n";
    for (int i = 0; i < 2 * perGroup; ++i) {
      const bool first = i % 2 == 0, north = i % 7 < (first ? 5 : 3);
      text += fmt::format("P{},{},{},{}\n", i, first ? 'x' : 'y', north ? "north" : "south",
                          normal(random) + (north ? 3.0 : 0.0) + (first ? effect : 0.0));
    }
    return text;
  };
  s.p = [](const auto& json) { return json["results"][0]["p"].template get<double>(); };
  expectLevelAndPower("van Elteren", s);
}

/// Exponential times, of which those beyond a limit are not finished.
TEST(DesignLevels, timesWithALimit) {
  Simulated s{asked(Design::timeToCriterion, {"time:lower"}), {}, {}, 1.3};
  s.asked.choices.finishedColumn = "done";
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,group,time,done\n";
    for (int i = 0; i < 2 * perGroup; ++i) {
      const double time = std::exponential_distribution<double>(std::exp(i % 2 == 0 ? effect : 0.0))(random);
      text += fmt::format("P{},{},{},{}\n", i, "xy"[i % 2], std::min(time, 1.5), time < 1.5 ? 1 : 0);
    }
    return text;
  };
  s.p = [](const auto& json) { return json["results"][0]["log_rank"]["p"].template get<double>(); };
  expectLevelAndPower("log-rank", s);
}

TEST(DesignLevels, correlationWithARating) {
  Simulated s{asked(Design::correlation, {"a"}), {}, {}, 2.0};
  s.asked.options.groupColumn.clear();
  s.asked.choices.against = "rating";
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,a,rating\n";
    for (int i = 0; i < perGroup; ++i) {
      const double rating = normal(random), a = effect * rating + normal(random);
      text += fmt::format("P{},{},{}\n", i, std::exp(a), std::round(2.0 * rating));
    }
    return text;
  };
  s.p = [](const auto& json) { return json["results"][0]["p"].template get<double>(); };
  expectLevelAndPower("Spearman", s);
}

/// A design that answers by an interval: as a p of 0 where that is off the value without an effect, else of 1.
double ofInterval(const nlohmann::ordered_json& interval, double none) {
  return interval["lower"].get<double>() > none || interval["upper"].get<double>() < none ? 0.0 : 1.0;
}

/// Two devices that measure the same people with errors of one size: bias.
TEST(DesignLevels, biasOfTwoDevices) {
  Simulated s{asked(Design::agreement, {"a", "b"}), {}, {}, 1.5};
  s.asked.options.groupColumn.clear();
  s.asked.choices.against = std::string(1, 'b');
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,a,b\n";
    for (int i = 0; i < perGroup; ++i) {
      const double person = 10.0 + 3.0 * normal(random);
      const double a = person + normal(random) + effect, b = person + normal(random);
      text += fmt::format("P{},{},{}\n", i, a, b);
    }
    return text;
  };
  s.p = [](const auto& json) { return ofInterval(json["results"][0]["bias_interval"], 0.0); };
  expectLevelAndPower("bias", s);
}

/// The same: slope of Deming's line, which a device with another scale changes.
TEST(DesignLevels, scaleOfTwoDevices) {
  Simulated s{asked(Design::agreement, {"a", "b"}), {}, {}, 0.5};
  s.asked.options.groupColumn.clear();
  s.asked.choices.against = std::string(1, 'b');
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,a,b\n";
    for (int i = 0; i < perGroup; ++i) {
      const double person = 10.0 + 3.0 * normal(random);
      const double a = (1.0 + effect) * person + 0.5 * normal(random), b = person + 0.5 * normal(random);
      text += fmt::format("P{},{},{}\n", i, a, b);
    }
    return text;
  };
  s.p = [](const auto& json) { return ofInterval(json["results"][0]["deming"]["slope_interval"], 1.0); };
  expectLevelAndPower("Deming's slope", s);
}

/// Raters of different leniency who see nothing, or what people are worth: interval of G.
TEST(DesignLevels, reliabilityOverRaters) {
  Simulated s{asked(Design::reliability, {"score"}), {}, {}, 1.5};
  s.asked.options.groupColumn.clear();
  s.asked.options.occasionColumns = {"rater"};
  s.table = [](std::mt19937& random, double effect) {
    std::string text = "id,rater,score\n";
    for (int i = 0; i < perGroup; ++i) {
      const double person = effect * normal(random);
      for (int r = 0; r < 3; ++r) text += fmt::format("P{},R{},{}\n", i, r, person + r + normal(random));
    }
    return text;
  };
  s.p = [](const auto& json) { return ofInterval(json["components"][0]["g_interval"], 0.0); };
  expectLevelAndPower("G", s);
}

}  // namespace
}  // namespace calot::analytics
