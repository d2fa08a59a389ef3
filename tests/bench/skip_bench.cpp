// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene does not need is not worked out: whole steps with nobody near, with one hand on one organ, and with both
// hands at work; the peer is the same motion with sleeping off, so that everything is solved in every step.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"
#include "tests/bench/touch_motion.h"

namespace calot::bench::skip_bench {

namespace {

constexpr std::size_t pressedSteps = 400;
constexpr std::size_t settling = 1000;  ///< steps before the first that is measured: what is at rest falls asleep

enum class Hands { none, one, both };

/// Hands that take no part stay at home.
Motion motionOf(const SceneDescription& scene, Hands hands) {
  Motion motion = pressAndSlide(scene, pressedSteps);
  const std::vector<TickSamples> home = motion.step.front();
  for (std::vector<TickSamples>& step : motion.step) {
    for (std::size_t i = 0; i < step.size(); ++i) {
      if (hands != Hands::both) step[i].hand[0] = home[0].hand[0];
      if (hands == Hands::none) step[i].hand[1] = home[0].hand[1];
    }
  }
  motion.step.insert(motion.step.begin(), settling, std::vector<TickSamples>(home.size(), home.front()));
  return motion;
}

struct Cost {
  double step = 0.0;    ///< mean CPU time with its ticks (s)
  double asleep = 0.0;  ///< mean share of the organs, vessels and fat that was not solved
};

/// Counts what is asleep, once it is told to.
struct Sleepers final : recorder::Observer {
  bool counting = false;
  double bodies = 0.0;
  double asleep = 0.0;

  void onStep(const recorder::StepRecord& record) override {
    if (!counting) return;
    tell(record.result.organ);
    tell(record.result.vessel);
    tell(record.result.fat);
  }
  void onEnd(recorder::Outcome /*outcome*/) override {}

 private:
  template <class Results>
  void tell(const Results& results) {
    for (const auto& result : results) {
      bodies += 1.0;
      asleep += result.asleep ? 1.0 : 0.0;
    }
  }
};

Cost run(const Model& model, const Motion& motion) {
  SerialExecutor executor;
  recorder::Session session(model, 1, executor);
  Sleepers sleepers;
  session.join(sleepers);
  std::vector<recorder::TickOutcome> ticks(model.scene().ticksPerStep);
  const std::size_t first = settling + motion.approach;
  Cost cost;
  for (std::size_t n = 0; n < motion.step.size(); ++n) {
    const std::vector<TickSamples>& samples = motion.step[n];
    sleepers.counting = n >= first;
    const double begin = threadSeconds();
    for (std::size_t i = 0; i < samples.size(); ++i) ticks[i] = session.tick(samples[i]);
    session.step(samples, ticks, 0.0F);
    if (n >= first) cost.step += (threadSeconds() - begin) / static_cast<double>(motion.step.size() - first);
  }
  cost.asleep = sleepers.asleep / sleepers.bodies;
  return cost;
}

void skip(benchmark::State& bench, const std::string& scene, Hands hands, const std::string& figure) {
  SceneDescription description =
      recorder::loadScene(std::string(CALOT_ASSETS) + "/scenes/" + scene + ".json").description;
  const Motion motion = motionOf(description, hands);
  const std::unique_ptr<const Model> model = built(description);
  description.solver.sleeping = false;
  const std::unique_ptr<const Model> awake = built(description);
  Cost cost;
  Cost peer;
  for (auto _ : bench) {
    cost = run(*model, motion);
    peer = run(*awake, motion);
    bench.SetIterationTime(cost.step);
  }
  bench.counters["asleep_share"] = cost.asleep;
  bench.counters["awake_ms"] = 1e3 * peer.step;
  bench.counters["of_awake"] = cost.step / peer.step;
  figures().add(figure + ".step_ms", 1e3 * cost.step);
  figures().add(figure + ".of_awake", cost.step / peer.step);
}

}  // namespace
}  // namespace calot::bench::skip_bench

void calot::bench::registerSkipping() {
  using namespace skip_bench;

  for (const std::string scene : {"touch-liver", "cholecystectomy"}) {
    for (const auto& [name, hands] :
         {std::pair("rest", Hands::none), std::pair("one", Hands::one), std::pair("both", Hands::both)}) {
      const std::string at = scene + "." + name;
      repeated(benchmark::RegisterBenchmark(("skip/" + scene + "/" + name).c_str(), skip, scene, hands, "skip." + at),
               3);
    }
  }
}
