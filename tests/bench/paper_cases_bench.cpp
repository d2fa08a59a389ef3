// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes of the paper's Table 1 (cases A to E), and beyond: the same 20 s of dissection, recorded once at case B
// and run open-loop at each, with and without fat, whole steps beside deformation alone over the same States.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/contact_run.h"
#include "tests/bench/figures.h"
#include "tests/bench/numbers.h"
#include "tests/bench/performed.h"
#include "tests/bench/repeated.h"

namespace calot::bench {

namespace {

constexpr double seconds = 20.0;  // of attempt time

/// Tetrahedra of liver and gallbladder, and the loop rate that the paper's table gives (Hz).
struct PaperCase {
  const char* name;
  std::uint32_t liver;
  std::uint32_t gallbladder;
  double paperHz;
};
constexpr PaperCase cases[] = {{"A", 518, 108, 29.3},
                               {"B", 1489, 121, 25.7},
                               {"C", 2030, 265, 23.2},
                               {"D", 5024, 470, 12.4},
                               {"E", 10615, 817, 7.3}};

SceneDescription sceneOf(const std::string& name, const PaperCase& which) {
  SceneDescription scene = recorder::loadScene(std::string(CALOT_ASSETS) + "/scenes/" + name + ".json").description;
  for (OrganDescription& organ : scene.organs) {
    if (organ.name == "liver") organ.tetrahedra = which.liver;
    if (organ.name == "gallbladder") organ.tetrahedra = which.gallbladder;
  }
  return scene;
}

void paperCase(benchmark::State& bench, const PaperCase& which, const std::string& scene) {
  static const Motion dissection = performed("dissect-bed", seconds);
  const std::unique_ptr<const Model> model = built(sceneOf(scene, which));
  ContactRun run(*model);
  run.prepare();
  std::vector<StepCost> costs;
  std::vector<double> least;  // of each step, in both runs: the same work, so what is more is the machine's
  double steps = 0.0;
  double sum = 0.0;
  double slowest = 0.0;
  double deformation = 0.0;
  for (auto _ : bench) {
    for (int again = 0; again < 2; ++again) {
      costs = run.run(dissection);
      least.resize(costs.size(), 1e300);
      for (std::size_t n = 0; n < costs.size(); ++n) {
        steps += 1.0;
        sum += costs[n].whole;
        slowest = std::max(slowest, costs[n].whole);
        least[n] = std::min(least[n], costs[n].whole);
        deformation += costs[n].deformation;
      }
    }
    bench.SetIterationTime(sum / steps);
  }
  double rows = 0.0;
  for (const StepCost& cost : costs) rows += cost.contact.rows;
  auto& counters = bench.counters;
  for (const OrganModel& organ : model->organs()) {
    counters["tetrahedra_" + organ.name] = static_cast<double>(organ.solid.tetrahedra().size());
  }
  counters["average_hz"] = steps / sum;
  counters["maximum_hz"] = 1.0 / quantile(least, 0.0);
  counters["minimum_hz"] = 1.0 / quantile(least, 1.0);
  counters["minimum_hz_once"] = 1.0 / slowest;
  counters["p99_ms"] = 1e3 * quantile(least, 0.99);
  counters["deformation_hz"] = steps / deformation;
  counters["over_deformation"] = sum / deformation;
  counters["over_paper"] = steps / sum / which.paperHz;
  counters["rows"] = rows / static_cast<double>(costs.size());
  const std::string name = std::string("paper.") + which.name + (scene == "dissect-bed" ? "" : ".fat");
  figures().add(name + ".hz", steps / sum);
  figures().add(name + ".minimum_hz", 1.0 / quantile(least, 1.0));
  if (name == "paper.E") figures().add("step.E.hz", steps / sum);
  figures().add(name + ".deformation_hz", steps / deformation);
  if (name == "paper.E") figures().add("deformation.E.steps_per_s", steps / deformation);
}

}  // namespace

void registerPaperCases() {
  for (const PaperCase& which : cases) {
    for (const bool fat : {false, true}) {
      const std::string name = std::string("paper/case") + which.name + (fat ? "/fat" : "");
      repeated(benchmark::RegisterBenchmark(name.c_str(), paperCase, which, fat ? "cholecystectomy" : "dissect-bed"),
               3);
    }
  }
}

}  // namespace calot::bench
