// SPDX-License-Identifier: GPL-3.0-or-later
// How often a study reports a difference in motion where there is none, over rate and noise of the groups' trackers:
// simulated hands without any skill, sampled, computed and compared by the functions that a study uses. 400 studies a
// cell; with CALOT_HEAVY 10,000, and the table of docs/reference/metrics/noise.md is printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "analytics/report/study.h"
#include "analytics/report/study_rows.h"
#include "tests/analytics/cohort/support/cohort_support.h"

namespace calot::analytics::tracker_levels_test {
namespace {

constexpr unsigned seed = 43;
constexpr std::array<const char*, 7> figures{"path-length", "depth-path", "speed-mean",    "speed-p95",
                                             "movements",   "idle-time",  "working-volume"};
constexpr std::size_t perGroup = 10;

struct Tracker {
  double rate = 100.0, noise = 0.0;  ///< Hz, m
  bool operator<(const Tracker& other) const { return std::pair(rate, noise) < std::pair(other.rate, other.noise); }
};

struct Cell {
  Tracker experts, novices;
  [[nodiscard]] std::string name() const {
    const auto text = [](const Tracker& t) { return fmt::format("{:g} Hz, {:g} mm", t.rate, 1000.0 * t.noise); };
    return text(experts) + " | " + text(novices);
  }
};

const std::vector<Cell> cells{{{100, 0}, {100, 0}},       {{100, 2e-4}, {100, 2e-4}}, {{60, 1e-4}, {60, 1e-4}},
                              {{30, 2e-4}, {30, 2e-4}},   {{100, 2e-4}, {30, 2e-4}},  {{100, 1e-4}, {60, 1e-4}},
                              {{100, 5e-5}, {100, 3e-4}}, {{100, 2e-4}, {85, 2e-4}},  {{100, 1e-4}, {100, 1.4e-4}}};

/// 20 s of a person's reaches and rests, at a pace and with rests of their own.
recorder::TrackedMotion motionOfPerson(unsigned person, const Tracker& tracker) {
  std::mt19937 random(seed + 7919 * person);
  const auto uniform = [](std::mt19937& from, double low, double high) {
    return low + (high - low) * static_cast<double>(from()) / 4294967296.0;
  };
  const double pace = uniform(random, 0.7, 1.4), restful = uniform(random, 0.3, 0.7);
  struct Stroke {
    double start, duration;
    Vec3 way;
  };
  std::vector<Stroke> strokes;
  Vec3 place = Vec3::Zero();
  for (double at = 0.3; at < 20.0;) {
    Vec3 to;
    for (int axis = 0; axis < 3; ++axis) to[axis] = uniform(random, -0.03, 0.03);
    const double duration = pace * uniform(random, 0.4, 1.0);
    strokes.push_back({at, duration, to - place});
    place = to;
    at += duration + (uniform(random, 0.0, 1.0) < restful ? uniform(random, 0.3, 1.8) : 0.1);
  }
  std::mt19937 noise(seed + 104729 * person + static_cast<unsigned>(tracker.rate + 1e6 * tracker.noise));
  std::normal_distribution<double> normal;
  recorder::TrackedMotion motion;
  motion.rate = tracker.rate;
  recorder::TrackedHand& hand = motion.hand[0];
  hand.present = true;
  for (int i = 0; i / tracker.rate <= 20.0; ++i) {
    const double t = i / tracker.rate;
    Vec3 p = Vec3::Zero();
    for (const Stroke& s : strokes) {
      const double u = std::clamp((t - s.start) / s.duration, 0.0, 1.0);
      p += u * u * u * (10.0 - 15.0 * u + 6.0 * u * u) * s.way;
    }
    for (int axis = 0; axis < 3; ++axis) p[axis] += tracker.noise * normal(noise);
    motion.time.push_back(t);
    hand.position.push_back(p);
    hand.orientation.push_back(Quat::Identity());
  }
  return motion;
}

std::vector<CheckpointValue> figuresOf(unsigned person, const Tracker& tracker) {
  std::vector<CheckpointValue> values = valuesFromSamples(motionOfPerson(person, tracker), {});
  std::erase_if(values, [](const CheckpointValue& v) {
    return v.subject != "left" || std::find(figures.begin(), figures.end(), v.name) == figures.end();
  });
  return values;
}

struct Counted {
  std::size_t tested = 0, found = 0, silent = 0;  ///< rows with a test; with p <= .05; of these, without a warning
};

/// Studies of people drawn anew each time, of whom both groups are.
std::map<std::string, Counted> simulate(const std::array<std::vector<std::vector<CheckpointValue>>, 2>& people,
                                        std::size_t studies) {
  std::mt19937 random(seed);
  std::vector<std::size_t> order(people[0].size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::map<std::string, Counted> counted;
  for (std::size_t study = 0; study < studies; ++study) {
    for (std::size_t i = 0; i < 2 * perGroup; ++i) std::swap(order[i], order[i + random() % (order.size() - i)]);
    std::vector<AttemptRow> attempts;
    std::vector<AttemptValue> values;
    for (unsigned i = 0; i < 2 * perGroup; ++i) {
      AttemptRow& a = attempts.emplace_back();
      static_cast<AttemptRecord&>(a) = support::humanAttempt(i, fmt::format("P{}", i));
      a.group = i < perGroup ? "expert" : "novice";
      for (const CheckpointValue& v : people[i < perGroup ? 0 : 1][order[i]]) values.push_back({a.uuid, v, {}});
    }
    const Study result = makeStudy(attempts, values, {}, "levels.db");
    for (const StudyRow& row : result.rows) {
      Counted& c = counted[row.checkpoint];
      if (!row.test) continue;
      ++c.tested;
      if (row.test->p > 0.05) continue;
      ++c.found;
      const CoverageRow* sampling = coverageOf(result, row);
      if (sampling == nullptr || !samplingDiffers(result, *sampling)) ++c.silent;
    }
  }
  return counted;
}

/// "| cell | tested | p <= .05 of those, least to most of the figures | without a warning, of all studies |"
std::string lineOf(const Cell& cell, const std::map<std::string, Counted>& counted, std::size_t studies) {
  double tested = 0.0, low = 100.0, high = 0.0, silent = 0.0;
  for (const char* figure : figures) {
    const Counted& c = counted.at(figure);
    tested += 100.0 * static_cast<double>(c.tested) / static_cast<double>(studies * figures.size());
    silent = std::max(silent, 100.0 * static_cast<double>(c.silent) / static_cast<double>(studies));
    if (2 * c.tested < studies) continue;
    const double found = 100.0 * static_cast<double>(c.found) / static_cast<double>(c.tested);
    low = std::min(low, found);
    high = std::max(high, found);
  }
  return fmt::format("| {} | {:.0f} | {} | {:.1f} |", cell.name(), tested,
                     low > high ? std::string("-") : fmt::format("{:.1f} to {:.1f}", low, high), silent);
}

TEST(TrackerLevels, noDifferenceOfTrackersIsReportedAsOneOfPeople) {
  const bool heavy = std::getenv("CALOT_HEAVY") != nullptr;
  const std::size_t studies = heavy ? 10000 : 400;
  const unsigned pool = heavy ? 400 : 80;
  std::map<Tracker, std::vector<std::vector<CheckpointValue>>> people;
  const auto peopleWith = [&](const Tracker& tracker) -> const auto& {
    auto& list = people[tracker];
    for (auto person = static_cast<unsigned>(list.size()); person < pool; ++person)
      list.push_back(figuresOf(person, tracker));
    return list;
  };
  for (const Cell& cell : cells) {
    const bool alike = !(cell.experts < cell.novices) && !(cell.novices < cell.experts);
    if (!heavy && alike && cell.experts.rate != 100.0) continue;
    const auto counted = simulate({peopleWith(cell.experts), peopleWith(cell.novices)}, studies);
    const std::string line = lineOf(cell, counted, studies);
    if (heavy) std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    // A level of .05, and four standard errors.
    const double most = 0.05 + 4.0 * std::sqrt(0.05 * 0.95 / static_cast<double>(studies)) + 0.002;
    for (const auto& [figure, c] : counted) {
      EXPECT_LE(static_cast<double>(c.silent), most * static_cast<double>(studies)) << line << " " << figure;
      if (alike) {
        EXPECT_LE(static_cast<double>(c.found), most * static_cast<double>(studies)) << line << " " << figure;
      }
    }
  }
}

}  // namespace
}  // namespace calot::analytics::tracker_levels_test
