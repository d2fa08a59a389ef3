// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of the whole operation at 1280 x 720, one after the other as a trainer shows them: view, draw list, drawing,
// read-back. Interactive quality against film quality in the same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "gui/render/renderer.h"
#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "sim/scene/scene_viewer.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/performed.h"
#include "tests/bench/repeated.h"

namespace calot::bench {

namespace {

constexpr int width = 1280, height = 720;
constexpr double workedSeconds = 12.0;  // of attempt time: hands are in the picture, fat is being carved
constexpr std::size_t stepsApart = 4;   // 25 pictures a second
constexpr std::size_t pictures = 40;    // the last ones
constexpr std::size_t filmPictures = 4;

/// States of the operation as pictures follow each other.
std::vector<State> statesOf(const Model& model, const Motion& motion) {
  SerialExecutor executor;
  recorder::Session session(model, 1, executor);
  std::vector<recorder::TickOutcome> ticks(model.scene().ticksPerStep);
  std::vector<State> states;
  const std::size_t first = motion.step.size() > stepsApart * pictures ? motion.step.size() - stepsApart * pictures : 0;
  for (std::size_t n = 0; n < motion.step.size(); ++n) {
    const std::vector<TickSamples>& samples = motion.step[n];
    for (std::size_t i = 0; i < samples.size(); ++i) ticks[i] = session.tick(samples[i]);
    session.step(samples, ticks, 0.0F);
    if (n >= first && (n - first) % stepsApart == 0) states.push_back(session.state());
  }
  return states;
}

struct Cost {
  double wall = 0.0, processor = 0.0;  // s a picture
};

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Cost draw(gui::Renderer& renderer, SceneViewer& viewer, const std::vector<State>& states, std::size_t count,
          gui::Quality quality) {
  const auto picture = [&](const State& state) {
    benchmark::DoNotOptimize(renderer.render(viewer.view(state), width, height, quality).rgba.data());
  };
  picture(states.front());  // compiles what it needs
  const auto begin = std::chrono::steady_clock::now();
  const double before = processorSeconds();
  for (std::size_t i = 0; i < count; ++i) picture(states[i]);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const auto n = static_cast<double>(count);
  return {wall.count() / n, (processorSeconds() - before) / n};
}

void renderCholecystectomy(benchmark::State& bench) {
  static const std::unique_ptr<const Model> model =
      built(recorder::loadScene(std::string(CALOT_ASSETS) + "/scenes/cholecystectomy.json").description);
  static const std::vector<State> states = statesOf(*model, performed("cholecystectomy", workedSeconds));
  gui::Renderer renderer;
  SceneViewer viewer(*model);
  Cost interactive;
  for (auto _ : bench) {
    interactive = draw(renderer, viewer, states, states.size(), gui::Quality::interactive);
    bench.SetIterationTime(interactive.wall);
  }
  const Cost film = draw(renderer, viewer, states, std::min(filmPictures, states.size()), gui::Quality::film);
  auto& counters = bench.counters;
  counters["fps"] = 1.0 / interactive.wall;
  counters["processor_ms"] = 1e3 * interactive.processor;
  counters["film_processor_ms"] = 1e3 * film.processor;
  counters["film_vs_interactive"] = film.processor / interactive.processor;
  figures().add("render.cholecystectomy.fps", 1.0 / interactive.wall);
  figures().add("render.cholecystectomy.processor_ms", 1e3 * interactive.processor);
  figures().add("render.cholecystectomy.film_vs_interactive", film.processor / interactive.processor);
}

}  // namespace

void registerRender() { repeated(benchmark::RegisterBenchmark("render/cholecystectomy", renderCholecystectomy), 3); }

}  // namespace calot::bench
