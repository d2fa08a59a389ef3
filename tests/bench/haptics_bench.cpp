// SPDX-License-Identifier: GPL-3.0-or-later
// The haptic tick: cost by contacts, and its tail.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/benchmarks.h"
#include "tests/bench/contact_sets.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

constexpr std::size_t tailTicks = 200000;
constexpr double circle = 0.002;  // the hand goes round (m),
constexpr double turns = 4.0;     // so many times a second: 50 mm/s
constexpr double pi = 3.14159265358979323846;

/// A hand that moves about its place and takes a new contact set with every step, as a running simulation gives it.
class Ticking {
 public:
  explicit Ticking(const PublishedSet& published) : published_(published), set_(published.set) {}

  /// Moves the hand; its tick is next.
  void move() {
    if (tick_ % published_.model.ticksPerStep == 0) ++set_.step;
    const double angle = 2.0 * pi * turns * 0.001 * static_cast<double>(tick_);
    const Mat3 frame = published_.real.orientation.toRotationMatrix();
    haptics.tip = published_.real.position +
                  circle * (std::cos(angle) * frame.col(0) + std::sin(angle) * (0.5 * frame.col(1) + frame.col(2)));
    haptics.orientation = published_.real.orientation;
    ++tick_;
  }
  HapticForce tick() { return hapticTick(published_.model, haptics, set_); }

  HapticState haptics;

 private:
  const PublishedSet& published_;
  ContactSet set_;
  std::uint64_t tick_ = 0;
};

/// Seconds of each of so many ticks, the clock's own time taken off.
std::vector<double> timed(const PublishedSet& published, std::size_t ticks, double& pressed) {
  const double overhead = clockOverhead();
  Ticking ticking(published);
  std::vector<double> seconds(ticks);
  double active = 0.0;
  for (double& s : seconds) {
    ticking.move();
    const double start = threadSeconds();
    benchmark::DoNotOptimize(ticking.tick());
    s = threadSeconds() - start - overhead;
    std::size_t row = 0;
    for (const BlockKind kind : published.set.kind) {
      if (ticking.haptics.lambda[row] > 0.0) active += 1.0;
      row += blockRows(kind);
    }
  }
  pressed = active / static_cast<double>(ticks);
  return seconds;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// Mean and tail of a set's ticks; the peer is a tick with a single contact.
void hapticTail(benchmark::State& bench, const PublishedSet& published, const PublishedSet& one, bool headline) {
  std::vector<double> seconds;
  double pressed = 0.0;
  for (auto _ : bench) {
    seconds = timed(published, tailTicks, pressed);
    bench.SetIterationTime(mean(seconds));
  }
  double ignored = 0.0;
  const double single = mean(timed(one, tailTicks / 10, ignored));
  bench.counters["contacts"] = static_cast<double>(published.set.kind.size());
  bench.counters["rows"] = static_cast<double>(published.set.free.size());
  bench.counters["pressed"] = pressed;
  bench.counters["mean_us"] = 1e6 * mean(seconds);
  bench.counters["p50_us"] = 1e6 * quantile(seconds, 0.5);
  bench.counters["p99_us"] = 1e6 * quantile(seconds, 0.99);
  bench.counters["p999_us"] = 1e6 * quantile(seconds, 0.999);
  bench.counters["max_us"] = 1e6 * quantile(seconds, 1.0);
  bench.counters["clock_us"] = 1e6 * clockOverhead();
  bench.counters["vs_one_contact"] = mean(seconds) / single;
  if (!headline) return;
  figures().add("haptics.tick_mean_ms", 1e3 * mean(seconds));
  figures().add("haptics.tick_p999_ms", 1e3 * quantile(seconds, 0.999));
}

/// Thirty contacts of one step, a third of them pressed.
void hapticThirty(benchmark::State& bench) {
  static const std::optional<PublishedSet> thirty = setOfLaidShaft(30);
  static const std::optional<PublishedSet> one = setOfLaidShaft(1);
  if (thirty && one) {
    hapticTail(bench, *thirty, *one, true);
  } else {
    bench.SkipWithError("no step of the laid shaft has 30 contacts");
  }
}

/// Thirty contacts in a row, each of which starts 5 mm deep: more are pressed than steps leave.
void hapticDeep(benchmark::State& bench) { hapticTail(bench, rowOfContacts(30, true), rowOfContacts(1), false); }

/// Growth over contacts in rows made for it; the last line has the fitted exponent from ten contacts on.
void hapticGrowth(benchmark::State& bench) {
  constexpr std::array<std::size_t, 5> counts{1, 3, 10, 30, 100};
  constexpr std::size_t ticks = 5000;
  std::vector<double> x;
  std::vector<double> y;
  for (auto _ : bench) {
    x.clear();
    y.clear();
    for (const std::size_t count : counts) {
      const PublishedSet row = rowOfContacts(count);
      double pressed = 0.0;
      const std::vector<double> seconds = timed(row, ticks, pressed);
      x.push_back(static_cast<double>(count));
      y.push_back(quantile(seconds, 0.5));
      bench.counters["us_" + std::to_string(count)] = 1e6 * y.back();
      bench.counters["pressed_" + std::to_string(count)] = pressed;
    }
    bench.SetIterationTime(y.back());
  }
  bench.counters["exponent"] = growthExponent(std::vector(x.begin() + 2, x.end()), std::vector(y.begin() + 2, y.end()));
}

}  // namespace

void registerHaptics() {
  repeated(benchmark::RegisterBenchmark("haptics/tick/thirty_contacts", hapticThirty), 5);
  repeated(benchmark::RegisterBenchmark("haptics/tick/thirty_deep", hapticDeep), 5);
  repeated(benchmark::RegisterBenchmark("haptics/tick/growth", hapticGrowth), 5);
}

}  // namespace calot::bench
