// SPDX-License-Identifier: GPL-3.0-or-later
// Whole steps in contact, haptic ticks included, against deformation alone over the same States.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/benchmarks.h"
#include "tests/bench/contact_run.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"

namespace calot::bench {

namespace {

constexpr std::size_t measured = 400;  // steps of a repetition

/// Two instruments that press and slide at the paper's case B.
void contactStep(benchmark::State& bench, bool prepared) {
  const std::unique_ptr<const Model> model = built(touchLiver());
  const Motion motion = pressAndSlide(model->scene(), measured);
  ContactRun run(*model);
  const double preparation = prepared ? run.prepare() : 0.0;
  std::vector<StepCost> costs;
  const auto steps = static_cast<double>(measured);
  const auto sum = [&](auto value) {
    double all = 0.0;
    for (const StepCost& cost : costs) all += static_cast<double>(value(cost));
    return all;
  };
  const auto p99 = [&](auto value) {
    std::vector<double> all;
    all.reserve(costs.size());
    for (const StepCost& cost : costs) all.push_back(value(cost));
    return quantile(all, 0.99);
  };
  for (auto _ : bench) {
    costs = run.run(motion);
    bench.SetIterationTime(sum([](const StepCost& c) { return c.whole; }) / steps);
  }
  const double whole = sum([](const StepCost& c) { return c.whole; });
  const double deformation = sum([](const StepCost& c) { return c.deformation; });
  double depth = 0.0;
  double pinched = 0.0;
  for (const StepCost& c : costs) {
    depth = std::max(depth, c.contact.maxDepth);
    pinched = std::max(pinched, c.contact.pinchedDepth);
  }
  auto& counters = bench.counters;
  counters["deformation_ms"] = 1e3 * deformation / steps;
  counters["contact_ms"] = 1e3 * (whole - deformation) / steps;
  counters["ratio"] = (whole - deformation) / deformation;
  counters["ticks_ms"] = 1e3 * sum([](const StepCost& c) { return c.ticks; }) / steps;
  counters["whole_p99_ms"] = 1e3 * p99([](const StepCost& c) { return c.whole; });
  counters["prepare_ms"] = 1e3 * preparation;
  counters["rows"] = sum([](const StepCost& c) { return c.contact.rows; }) / steps;
  counters["contacts"] = sum([](const StepCost& c) { return c.contact.blocks; }) / steps;
  counters["passes"] = sum([](const StepCost& c) { return c.contact.passes; }) / steps;
  counters["both_touch"] = sum([](const StepCost& c) { return c.bothTouch; }) / steps;
  counters["iterations"] = sum([](const StepCost& c) { return c.iterations; }) / steps;
  counters["peer_iterations"] = sum([](const StepCost& c) { return c.peerIterations; }) / steps;
  counters["depth_mm"] = 1e3 * depth;
  counters["pinched_mm"] = 1e3 * pinched;
  counters["residual_p99_um"] = 1e6 * p99([](const StepCost& c) { return c.contact.residual; });
  counters["error_p99_um"] = 1e6 * p99([](const StepCost& c) { return c.contact.error; });
  for (const OrganModel& organ : model->organs()) {
    counters["tetrahedra_" + organ.name] = static_cast<double>(organ.solid.tetrahedra().size());
  }
  if (!prepared) return;
  figures().add("step.B.hz", steps / whole);
  figures().add("deformation.B.steps_per_s", steps / deformation);
  figures().add("contact.B.vs_deformation", (whole - deformation) / deformation);
  figures().addLargest("contact.max_depth_mm", 1e3 * depth);
}

/// What contact costs by its places, over the steps in which a shaft is pressed into the liver; and the exponent.
void contactGrowth(benchmark::State& bench) {
  constexpr std::array<std::uint32_t, 5> from{1, 5, 10, 20, 30};
  const LaidShaft laid = shaftLaidAlongLiver();
  const std::unique_ptr<const Model> model = built(laid.scene);
  ContactRun run(*model);
  run.prepare();
  for (auto _ : bench) {
    std::vector<double> places;
    std::vector<double> seconds;
    std::array<double, from.size()> contact{};
    std::array<double, from.size()> peer{};
    std::array<double, from.size()> count{};
    double largest = 0.0;
    for (const StepCost& cost : run.run(laid.motion)) {
      if (cost.contact.blocks == 0) continue;
      const auto above = std::upper_bound(from.begin(), from.end(), cost.contact.blocks);
      const auto bin = static_cast<std::size_t>(above - from.begin()) - 1;
      contact[bin] += cost.whole - cost.deformation;
      peer[bin] += cost.deformation;
      count[bin] += 1.0;
      places.push_back(cost.contact.blocks);
      seconds.push_back(cost.whole - cost.deformation);
      largest = std::max(largest, cost.whole);
    }
    for (std::size_t b = 0; b < from.size(); ++b) {
      if (count[b] == 0.0) continue;
      bench.counters["ms_from_" + std::to_string(from[b])] = 1e3 * contact[b] / count[b];
      bench.counters["ratio_from_" + std::to_string(from[b])] = contact[b] / peer[b];
    }
    bench.counters["most"] = quantile(places, 1.0);
    bench.counters["exponent"] = growthExponent(places, seconds);
    figures().add("growth.contacts.exponent", growthExponent(places, seconds));
    bench.SetIterationTime(largest);
  }
}

}  // namespace

void registerContactStep() {
  for (const bool prepared : {true, false}) {
    const std::string name = std::string("contact/step/caseB") + (prepared ? "" : "/first_touches");
    repeated(benchmark::RegisterBenchmark(name.c_str(), contactStep, prepared), 5);
  }
  repeated(benchmark::RegisterBenchmark("contact/step/growth", contactGrowth), 5);
}

}  // namespace calot::bench
