// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/uncertainty/uncertainty.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <exception>
#include <mutex>
#include <string>
#include <utility>

#include "analytics/checkpoints/collector.h"
#include "analytics/uncertainty/scene_variants.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/reader.h"
#include "sim/scene/version.h"

namespace calot::analytics {
namespace {

struct Variant {
  std::string name;
  SceneDescription scene;
};

/// Below, the difference of two meshes says nothing of their limit.
constexpr double minMeshRatio = 1.05;

/// Places in variantsOf(); the longest first, so that no processor is left with it at the end.
constexpr std::size_t finerMesh = 0, smallerStep = 1, designBegin = 2;

std::vector<Variant> variantsOf(const SceneDescription& scene) {
  std::vector<Variant> variants;
  variants.push_back({"twice the tetrahedra", redivided(scene, scene.ticksPerStep, 2.0)});
  variants.push_back({"half the step", redivided(scene, scene.ticksPerStep / 2, 1.0)});
  for (std::size_t run = 0; run < designRuns; ++run)
    variants.push_back({fmt::format("perturbed constants, run {}", run + 1), perturbed(scene, run)});
  return variants;
}

std::uint64_t tetrahedraOf(const Model& model) {
  std::uint64_t count = 0;
  for (const OrganModel& organ : model.organs()) count += organ.solid.tetrahedra().size();
  return count;
}

}  // namespace

OpenLoopRun runIn(const Model& model, const recorder::AttemptHeader& header, const recorder::AttemptInputs& inputs) {
  recorder::AttemptHeader divided = header;
  divided.ticksPerStep = model.scene().ticksPerStep;
  divided.stepResultVersion = stepResultVersion;
  CheckpointCollector collector(divided, model.scene());
  SerialExecutor executor;
  const std::array<recorder::Observer*, 1> observers{&collector};
  recorder::runOpenLoop(model, inputs, observers, executor);
  return {collector.values(), tetrahedraOf(model)};
}

OpenLoopRun runIn(const SceneDescription& scene, const recorder::AttemptHeader& header,
                  const recorder::AttemptInputs& inputs, const std::string& what) {
  const Model::Built built = Model::build(scene);
  if (!built.model) throw Error(ErrorKind::refused, fmt::format("{}: {}", what, built.error));
  return runIn(*built.model, header, inputs);
}

std::vector<ValueInterval> estimateUncertainty(const SceneDescription& scene, const recorder::AttemptHeader& header,
                                               const recorder::AttemptInputs& inputs,
                                               const std::vector<CheckpointValue>& values, unsigned threads,
                                               const UncertaintyProgress& progress) {
  if (scene.ticksPerStep < 2)
    throw Error(ErrorKind::refused, fmt::format("{}: steps of one tick cannot be halved", scene.name));
  const std::vector<Variant> variants = variantsOf(scene);
  std::vector<OpenLoopRun> runs(variants.size());
  std::vector<std::exception_ptr> failed(variants.size());
  std::mutex mutex;
  std::uint64_t done = 0;
  recorder::WorkerPool pool(threads);
  pool.run(variants.size(), [&](std::size_t i) {
    try {
      runs[i] = runIn(variants[i].scene, header, inputs, fmt::format("{}, {}", scene.name, variants[i].name));
    } catch (...) {
      failed[i] = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    ++done;
    if (progress) progress(done, variants.size());
  });
  for (const std::exception_ptr& failure : failed) {
    if (failure) std::rethrow_exception(failure);
  }

  VariedValues varied;
  const double more =
      static_cast<double>(runs[finerMesh].tetrahedra) / static_cast<double>(runs[designBegin].tetrahedra);
  varied.meshRatio = std::cbrt(more);
  if (!(varied.meshRatio > minMeshRatio))
    throw Error(ErrorKind::refused, fmt::format("{}: its organs' meshes cannot be made finer", scene.name));
  varied.finerMesh = std::move(runs[finerMesh].values);
  varied.smallerStep = std::move(runs[smallerStep].values);
  const auto halvedTicks = scene.ticksPerStep / 2;  // whole: an odd step is not halved exactly
  varied.stepRatio = static_cast<double>(scene.ticksPerStep) / static_cast<double>(halvedTicks);
  for (std::size_t i = designBegin; i < runs.size(); ++i) varied.design.push_back(std::move(runs[i].values));
  return intervalsOf(values, varied);
}

std::vector<ValueInterval> estimateUncertainty(const std::filesystem::path& path,
                                               const std::vector<CheckpointValue>& values, unsigned threads,
                                               const UncertaintyProgress& progress) {
  recorder::Recording recording(path);
  const SceneDescription scene = recorder::sceneFromAssets(recording.header().assets).description;
  return estimateUncertainty(scene, recording.header(), recorder::inputsOf(recording), values, threads, progress);
}

}  // namespace calot::analytics
