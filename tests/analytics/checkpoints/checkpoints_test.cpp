// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <sstream>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "tests/analytics/checkpoints/support/steps.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using recorder::Outcome;
using recorder::TickOutcome;
using support::feed;
using support::header;
using support::scene;
using support::valueOf;

const double pi = std::acos(-1.0);

const auto still = [](std::uint64_t, TickSamples&, TickOutcome&) {};

TEST(Registry, definitionsAreCompleteAndNamesUnique) {
  std::set<std::string> names;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const CheckpointDefinition& d = entry.definition;
    EXPECT_TRUE(names.insert(d.name).second) << d.name;
    for (const std::string* text :
         {&d.name, &d.title, &d.unit, &d.displayUnit, &d.window, &d.instruments, &d.filter, &d.definition}) {
      EXPECT_FALSE(text->empty()) << d.name;
      EXPECT_EQ(text->find('\n'), std::string::npos) << d.name;
    }
    EXPECT_FALSE(d.origins.empty()) << d.name;
    EXPECT_GE(d.version, 1U) << d.name;
    EXPECT_EQ(findCheckpoint(d.name), &entry.definition);
  }
  EXPECT_EQ(findCheckpoint("no-such"), nullptr);
}

/// By family, then by rank, none twice: reports have one order, whatever the order of files.
TEST(Registry, everyCheckpointHasAPlaceOfItsOwn) {
  const std::vector<CheckpointEntry>& registry = checkpointRegistry();
  ASSERT_GE(registry.size(), 60U);
  for (std::size_t i = 1; i < registry.size(); ++i) {
    const CheckpointPlace &before = registry[i - 1].place, &place = registry[i].place;
    EXPECT_LT(std::pair(before.family, before.rank), std::pair(place.family, place.rank))
        << registry[i - 1].definition.name << ", " << registry[i].definition.name;
  }
  for (const CheckpointEntry& entry : registry) {
    EXPECT_GT(entry.place.rank, 0) << entry.definition.name;
    EXPECT_EQ(entry.place.family == CheckpointFamily::phases, isOfPhases(entry.definition)) << entry.definition.name;
    EXPECT_TRUE(entry.place.summaryTitle.empty() || !isOfPhases(entry.definition)) << entry.definition.name;
  }
}

TEST(Registry, everyValueHasItsDefinitionsTermsAndAnAllowedOrigin) {
  for (const Origin origin : {Origin::resimulated, Origin::observables}) {
    CheckpointCollector collector(header(), scene(), origin);
    feed(collector, 50, still);
    collector.onEnd(Outcome::completed);
    for (const CheckpointValue& v : collector.values()) {
      const CheckpointDefinition* d = findCheckpoint(v.name);
      ASSERT_NE(d, nullptr) << v.name;
      EXPECT_EQ(v.version, d->version);
      EXPECT_EQ(v.unit, d->unit);
      EXPECT_EQ(v.filter, d->filter);
      EXPECT_NE(std::find(d->origins.begin(), d->origins.end(), v.origin), d->origins.end()) << v.name;
      EXPECT_EQ(v.value.has_value(), v.availability == Availability::value);
      EXPECT_EQ(v.reason.empty(), v.value.has_value());
    }
  }
}

/// A page of the documentation.
std::string pageText(const std::filesystem::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Words with one blank between them, as a page's lines may break anywhere.
std::string oneLine(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// The documentation's section of a checkpoint holds the words of the code, and sections of a page stand in the
/// registry's order. What half of the checkpoints share, their filter, is on one page, which they link to.
TEST(Registry, docsAgree) {
  const std::filesystem::path folder = std::filesystem::path(CALOT_SOURCE_DIR) / "docs/reference/metrics";
  const std::string samples = oneLine(pageText(folder / "samples.md"));
  const auto rank = [](const std::string& name) {
    const auto& registry = checkpointRegistry();
    return std::find_if(registry.begin(), registry.end(),
                        [&](const CheckpointEntry& e) { return e.definition.name == name; }) -
           registry.begin();
  };
  std::string text;
  std::vector<std::string> documented;
  for (const auto& each : std::filesystem::directory_iterator(folder)) {
    const std::string page = pageText(each.path());
    std::vector<std::string> here;
    for (std::size_t at = page.find("\n## `"); at != std::string::npos; at = page.find("\n## `", at + 1)) {
      here.push_back(page.substr(at + 5, page.find('`', at + 5) - at - 5));
    }
    EXPECT_TRUE(std::is_sorted(here.begin(), here.end(), [&](const std::string& a, const std::string& b) {
      return rank(a) < rank(b);
    })) << each.path();
    documented.insert(documented.end(), here.begin(), here.end());
    text += page + "\n## end of page\n";
  }
  std::vector<std::string> known;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const CheckpointDefinition& d = entry.definition;
    known.push_back(d.name);
    const std::size_t from = text.find(fmt::format("\n## `{}`", d.name));
    if (from == std::string::npos) continue;  // the lists below differ then
    const std::string section = text.substr(from, text.find("\n## ", from + 1) - from);
    const auto holds = [&](const std::string& row, std::string words) {
      // A bar inside a cell of a Markdown table is escaped.
      for (std::size_t at = 0; (at = words.find('|', at)) != std::string::npos; at += 2) words.replace(at, 1, "\\|");
      const std::string line = fmt::format("| {} | {} |", row, words);
      EXPECT_NE(section.find(line), std::string::npos) << d.name << ": " << line;
    };
    holds("title", d.title);
    holds("formula", d.definition);
    holds("unit", d.unit == d.displayUnit ? d.unit : d.unit + ", shown in " + d.displayUnit);
    holds("better", nameOf(d.direction));
    holds("given for", "each " + nameOf(d.aggregation));
    holds("instruments", d.instruments);
    holds("window", d.window);
    if (section.find("\n| filter | [motion filter](samples.md#in-one-sentence) |") == std::string::npos) {
      holds("filter", d.filter);
    } else {
      EXPECT_NE(samples.find(d.filter + "."), std::string::npos) << d.name << ": " << d.filter;
    }
    if (d.minCoverage > 0.0) holds("coverage", coverageText(d));
    std::string origins;
    for (const Origin origin : d.origins) origins += (origins.empty() ? "" : ", ") + nameOf(origin);
    holds("origin", origins);
    holds("known", d.finality == Finality::running ? "after every step" : "at the end");
    holds("version", std::to_string(d.version));
    EXPECT_NE(section.find("| source | "), std::string::npos) << d.name;
    EXPECT_NE(section.find("| pitfall | "), std::string::npos) << d.name;
    if (!d.paperReading.empty()) holds("paper", d.paperReading);
    EXPECT_EQ(d.notOutcome.empty(), section.find("| outcome | ") == std::string::npos) << d.name;
    if (!d.notOutcome.empty()) holds("outcome", "no: " + d.notOutcome);
  }
  std::sort(documented.begin(), documented.end());
  std::sort(known.begin(), known.end());
  EXPECT_EQ(documented, known);
}

TEST(ElapsedTime, onlyOfCompletedAttempts) {
  const auto run = [](Outcome outcome) {
    CheckpointCollector collector(header(), scene());
    feed(collector, 3886, still);
    collector.onEnd(outcome);
    return valueOf(collector, "elapsed-time", "");
  };
  EXPECT_DOUBLE_EQ(*run(Outcome::completed).value, 38.86);
  EXPECT_EQ(run(Outcome::abandoned).availability, Availability::notApplicable);
  expectNames(run(Outcome::abandoned).reason, {"abandoned", "38.860 s"});
  EXPECT_EQ(run(Outcome::timeLimit).availability, Availability::notAvailable);
  EXPECT_FALSE(run(Outcome::stopped).value);
  EXPECT_FALSE(run(Outcome::technicalFailure).value);
  EXPECT_FALSE(run(Outcome::running).value);
  CheckpointCollector collector(header(), scene());
  feed(collector, 3886, still);
  collector.onEnd(Outcome::abandoned);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "attempt-duration", "").value, 38.86);
}

TEST(PathLength, ofASlowCircleIsItsCircumference) {
  // Radius 20 mm, one turn in 10 s: far below the cut-off, so the filter leaves it alone; the polygon through 100
  // points a second is shorter than the circle by (pi f / rate)^2 / 6.
  CheckpointCollector collector(header(), scene());
  feed(collector, 1000, [](std::uint64_t tick, TickSamples& s, TickOutcome&) {
    const double angle = 2.0 * pi * static_cast<double>(tick) / 10000.0;
    s.hand[0].position = Vec3(0.02 * std::cos(angle), 0.02 * std::sin(angle), 0.1);
  });
  collector.onEnd(Outcome::completed);
  const CheckpointValue left = valueOf(collector, "path-length", "left");
  EXPECT_EQ(left.origin, Origin::samples);
  EXPECT_NEAR(*left.value, 2.0 * pi * 0.02 * 0.999,
              1e-5);  // points 0 to 999 of 1000; the ends' mirror images bend the other way
  EXPECT_EQ(left.note, "");
  EXPECT_NEAR(*valueOf(collector, "path-length", "right").value, 0.0, 1e-15) << "a hand at rest";
}

TEST(PathLength, withstandsTheTrackersNoise) {
  // 0.2 mm of noise on a hand that moves at 20 mm/s: unfiltered the path grows by more than a tenth, filtered by less
  // than three hundredths.
  const unsigned seed = 42;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.0002);
  MotionTrack track(0.001);
  InstrumentSample s;
  for (int tick = 0; tick < 60000; ++tick) {
    const double t = tick * 0.001;
    s.position = Vec3(0.02 * std::sin(t), 0.02 * std::cos(t), 0.0) + Vec3(noise(random), noise(random), noise(random));
    track.add(s);
  }
  const Motion motion = track.motion();
  ASSERT_EQ(motion.segments.size(), 1U);
  double raw = 0.0, filtered = 0.0;
  for (std::size_t i = 1; i < motion.segments[0].raw.size(); ++i) {
    raw += (motion.segments[0].raw[i] - motion.segments[0].raw[i - 1]).norm();
    filtered += (motion.segments[0].filtered[i] - motion.segments[0].filtered[i - 1]).norm();
  }
  EXPECT_GT(raw, 1.2 * 1.1);
  EXPECT_NEAR(filtered, 1.2, 0.03 * 1.2);
}

TEST(PathLength, isAbsentWithoutAnInstrument) {
  CheckpointCollector collector(header(), scene());
  feed(collector, 100,
       [](std::uint64_t, TickSamples& s, TickOutcome&) { s.hand[1].instrument = InstrumentKind::none; });
  collector.onEnd(Outcome::completed);
  EXPECT_EQ(valueOf(collector, "path-length", "right").availability, Availability::absentHand);
  EXPECT_EQ(valueOf(collector, "force-maximum", "right").availability, Availability::absentHand);
  EXPECT_TRUE(valueOf(collector, "path-length", "left").value);
}

TEST(PathLength, isNotAvailableForAnAttemptTooShort) {
  CheckpointCollector collector(header(), scene());
  feed(collector, 9, still);
  collector.onEnd(Outcome::completed);
  EXPECT_EQ(valueOf(collector, "path-length", "left").availability, Availability::notAvailable);
  CheckpointCollector empty(header(), scene());
  empty.onEnd(Outcome::running);
  for (const CheckpointValue& v : empty.values()) {
    if (v.value) {
      EXPECT_EQ(*v.value, 0.0) << v.name;
    }
  }
}

TEST(Motion, shortGapsAreBridgedAndLongOnesSplit) {
  // 1 m/s along x; not measured from tick 2000 to 2050 (bridged) and from 5000 to 6200 (split). Held poses are no
  // points.
  MotionTrack track(0.001);
  for (int tick = 0; tick < 8000; ++tick) {
    InstrumentSample s;
    s.valid = !((tick >= 2000 && tick < 2050) || (tick >= 5000 && tick < 6200));
    s.position = Vec3(s.valid ? 0.001 * tick : 99.0, 0.0, 0.0);
    track.add(s);
  }
  const Motion motion = track.motion();
  ASSERT_EQ(motion.segments.size(), 2U);
  EXPECT_EQ(motion.segments[0].first, 0);
  EXPECT_EQ(motion.segments[0].raw.size(), 500U);
  EXPECT_EQ(motion.segments[1].first, 620);
  EXPECT_EQ(motion.segments[1].raw.size(), 180U);
  for (const MotionSegment& segment : motion.segments) {
    for (std::size_t i = 0; i < segment.raw.size(); ++i) {
      EXPECT_NEAR(segment.raw[i].x(), 0.01 * static_cast<double>(segment.first + static_cast<std::int64_t>(i)), 1e-12);
      EXPECT_NEAR(segment.filtered[i].x(), segment.raw[i].x(), 1e-6) << "a straight line passes unchanged";
    }
  }
  EXPECT_NEAR(lengthOf(motion.coverage.mounted), 8.0, 1e-9);
  EXPECT_NEAR(lengthOf(motion.coverage.lost), 0.05 + 1.2, 1e-9) << "of both, samples covering their own interval";
  EXPECT_NEAR(*motion.coverage.share(), 6.75 / 8.0, 1e-9);
}

TEST(Motion, anExchangeOfInstrumentsAddsNoPath) {
  // The new instrument's tip is 30 mm further out: a jump that no hand made.
  MotionTrack track(0.001);
  for (int tick = 0; tick < 2000; ++tick) {
    InstrumentSample s;
    s.instrument = tick < 1000 ? InstrumentKind::grasper : InstrumentKind::hook;
    s.position = Vec3(tick < 1000 ? 0.0 : 0.03, 0.0, 0.0);
    track.add(s);
  }
  const Motion motion = track.motion();
  ASSERT_EQ(motion.segments.size(), 2U);
  for (const MotionSegment& segment : motion.segments) {
    for (const Vec3& p : segment.filtered) EXPECT_NEAR(p.x(), segment.raw.front().x(), 1e-15);
  }
}

TEST(ContactTime, unionAndSumDifferWhereBothInstrumentsTouch) {
  CheckpointCollector collector(header(), scene());
  // Left touches the liver in steps 10 to 29, right in 20 to 49; right touches the gallbladder in step 5 alone.
  feed(collector, 100, still, [](std::uint64_t step, StepResult& r) {
    if (step >= 10 && step < 30) r.hand[0].touching |= 1U;
    if (step >= 20 && step < 50) r.hand[1].touching |= 1U;
    if (step == 5) r.hand[1].touching |= 2U;
  });
  collector.onEnd(Outcome::completed);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "contact-time-union", "liver").value, 0.4);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "contact-time-sum", "liver").value, 0.5);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "contact-time-union", "gallbladder").value, 0.01);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "contact-time-sum", "gallbladder").value, 0.01);
}

TEST(Force, maximumPercentileAndMeanPerHand) {
  CheckpointCollector collector(header(), scene());
  // Left: 1000 ticks, of which 101 push with k N, k = 1 to 101; right: nothing.
  feed(collector, 100, [](std::uint64_t tick, TickSamples&, TickOutcome& o) {
    if (tick < 101) o.hand[0].force = Vec3(0.6, 0.8, 0.0) * static_cast<double>(tick + 1);
    if (tick == 500) o.hand[0].force = Vec3(0.0, 0.009, 0.0);  // below what counts
  });
  collector.onEnd(Outcome::completed);
  EXPECT_NEAR(*valueOf(collector, "force-maximum", "left").value, 101.0, 1e-12);
  EXPECT_NEAR(*valueOf(collector, "force-p99", "left").value, 100.0, 1e-12);
  EXPECT_NEAR(*valueOf(collector, "force-mean", "left").value, 51.0, 1e-12);
  EXPECT_EQ(*valueOf(collector, "force-maximum", "right").value, 0.0);
  EXPECT_EQ(valueOf(collector, "force-mean", "right").availability, Availability::notApplicable);
  expectNames(valueOf(collector, "force-p99", "right").reason, {"0.01 N"});
}

/// A lively attempt from a seed.
void lively(CheckpointCollector& collector, unsigned seed, bool askOnTheWay) {
  std::mt19937 random(seed);
  std::normal_distribution<double> jitter(0.0, 0.001);
  Vec3 p[2] = {Vec3::Zero(), Vec3::Zero()};
  for (int part = 0; part < 30; ++part) {
    feed(
        collector, 20,
        [&](std::uint64_t, TickSamples& s, TickOutcome& o) {
          for (std::size_t h = 0; h < 2; ++h) {
            p[h] += Vec3(jitter(random), jitter(random), jitter(random)) * 0.1;
            s.hand[h].position = p[h];
            s.hand[h].valid = random() % 50 != 0;
            o.hand[h].force = p[h] * 100.0;
          }
        },
        [&](std::uint64_t, StepResult& r) { r.hand[0].touching = static_cast<std::uint32_t>(random() % 4); });
    if (askOnTheWay) (void)collector.values();
  }
  collector.onEnd(Outcome::completed);
}

TEST(Collector, replayGivesTheBitsOfTheLiveRun) {
  // Live, values are asked for on the way (a score on the screen); in replay only at the end.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    CheckpointCollector live(header(), scene()), replay(header(), scene());
    lively(live, seed, true);
    lively(replay, seed, false);
    const auto a = live.values(), b = replay.values();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].value.has_value(), b[i].value.has_value()) << a[i].name;
      if (a[i].value) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(*a[i].value), std::bit_cast<std::uint64_t>(*b[i].value)) << a[i].name;
      }
      EXPECT_EQ(a[i], b[i]);
    }
  }
}

TEST(Collector, bitsAreThoseOfEveryCompilerAndMachine) {
  // Inputs from integers alone, so that no library's rounding enters.
  CheckpointCollector collector(header(), scene());
  std::uint64_t state = 88172645463325252ULL;
  const auto next = [&] {
    state ^= state << 13U;
    state ^= state >> 7U;
    state ^= state << 17U;
    return static_cast<double>(static_cast<std::int64_t>(state >> 40U) - (1 << 23)) / static_cast<double>(1 << 30);
  };
  Vec3 p[2] = {Vec3::Zero(), Vec3::Zero()};
  feed(
      collector, 500,
      [&](std::uint64_t, TickSamples& s, TickOutcome& o) {
        for (std::size_t h = 0; h < 2; ++h) {
          for (int axis = 0; axis < 3; ++axis) p[h][axis] += next();
          s.hand[h].position = p[h];
          o.hand[h].force = p[h] * 8.0;
        }
      },
      [&](std::uint64_t, StepResult& r) { r.hand[1].touching = static_cast<std::uint32_t>(state >> 60U) & 3U; });
  collector.onEnd(Outcome::completed);
  std::uint64_t mixed = 1469598103934665603ULL;
  for (const char* name : {"elapsed-time", "attempt-duration", "path-length", "contact-time-union", "contact-time-sum",
                           "force-maximum", "force-p99", "force-mean"}) {
    for (const CheckpointValue& v : collector.values()) {
      if (v.name != name || !v.value) continue;
      mixed ^= std::bit_cast<std::uint64_t>(*v.value);
      mixed *= 1099511628211ULL;
    }
  }
  EXPECT_EQ(mixed, 0xecda41fecbd10516ULL) << std::hex << "0x" << mixed;
}

}  // namespace
}  // namespace calot::analytics
