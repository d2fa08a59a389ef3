// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/uncertainty/uncertainty.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <exception>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

#include "analytics/checkpoints/collector.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/reader.h"
#include "sim/math/record.h"
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

namespace {

/// A number of parts along `dimension` directions, with parts shorter by the ratio.
std::uint32_t parts(std::uint32_t count, double ratio, double dimension) {
  return static_cast<std::uint32_t>(std::lround(count * std::pow(ratio, dimension)));
}

}  // namespace

SceneDescription redivided(const SceneDescription& scene, std::uint32_t ticksPerStep, double elements) {
  SceneDescription divided = scene;
  divided.ticksPerStep = ticksPerStep;
  const double ratio = std::cbrt(elements);
  for (OrganDescription& organ : divided.organs) organ.tetrahedra = parts(organ.tetrahedra, ratio, 3.0);
  for (VesselDescription& vessel : divided.vessels) vessel.elements = parts(vessel.elements, ratio, 1.0);
  for (ConnectiveDescription& bed : divided.connective) bed.strands = parts(bed.strands, ratio, 2.0);
  for (FatDescription& fat : divided.fat) fat.cellsPerCube = std::max(1U, parts(fat.cellsPerCube, ratio, -1.0));
  return divided;
}

const std::array<AssumedFactor, designFactors>& assumedFactors() {
  static const std::array<AssumedFactor, designFactors> factors{{
      {"stiffness of organs", {"organs.liver.material.youngModulus", "organs.gallbladder.material.youngModulus"}, {}},
      {"damping",
       {"organs.liver.material.stiffnessDamping", "organs.gallbladder.material.stiffnessDamping",
        "connective.*.damping"},
       {}},
      {"stiffness of fat", {"fat.*.material.youngModulus", "fat.*.attachments.*.stiffness"}, {}},
      {"stiffness of vessels", {"vessels.*.material.youngModulus", "vessels.*.wall"}, {}},
      {"strength of vessels", {"vessels.*.ultimateStrain"}, {}},
      {"stiffness of the bed", {"connective.*.stiffness"}, {}},
      {"strength of the bed", {"connective.*.strength"}, {}},
      {"friction",
       {"organs.liver.friction", "organs.gallbladder.friction", "vessels.*.friction", "fat.*.friction"},
       {}},
      {"grip", {"hands.*.slipForce", "hands.*.tearForce", "hands.*.couplingStiffness"}, {}},
      {"pace of cautery",
       {"cautery.power", "cautery.recession", "cautery.reach"},
       {"organs.liver.burnThrough", "organs.gallbladder.burnThrough", "vessels.*.burnThrough",
        "connective.*.fadeTime"}},
      {"char", {"cautery.spot", "cautery.cutChar"}, {"cautery.charTime"}},
  }};
  return factors;
}

int designSign(std::size_t run, std::size_t factor) {
  assert(run < designRuns && factor < designFactors);
  constexpr std::array<int, designFactors> generator{1, 1, -1, 1, 1, 1, -1, -1, -1, 1, -1};
  if (run + 1 == designRuns) return -1;
  return generator[(factor + designFactors - run) % designFactors];
}

SceneDescription perturbed(const SceneDescription& scene, std::size_t run) {
  SceneDescription changed = scene;
  for (std::size_t f = 0; f < designFactors; ++f) {
    const AssumedFactor& factor = assumedFactors()[f];
    const double times = 1.0 + designSign(run, f) * assumedChange;
    for (const std::string& name : factor.constants) findSceneConstant(name)->multiply(changed, times);
    for (const std::string& name : factor.inverse) findSceneConstant(name)->multiply(changed, 1.0 / times);
  }
  return changed;
}

namespace {

using Use = std::function<void(double&)>;

void useNumbers(const Record& record, void* object, std::string_view path, const Use& use);

/// Does a part of a path name this item of a list, or every one?
bool isNamed(std::string_view part, const Access& item, void* object) {
  if (part == "*") return true;
  const std::vector<Field>& fields = item.record().fields;
  const auto name =
      std::find_if(fields.begin(), fields.end(), [](const Field& f) { return f.name == std::string("name"); });
  return name != fields.end() && *static_cast<const std::string*>(name->value.get(object)) == part;
}

void useNumbers(const Access& access, void* value, std::string_view path, const Use& use) {
  if (access.type == Access::Type::numbers) {
    use(*static_cast<double*>(value));
  } else if (access.type == Access::Type::record) {
    useNumbers(access.record(), value, path, use);
  } else if (access.type == Access::Type::list) {
    const std::string_view part = path.substr(0, path.find('.'));
    for (std::size_t i = 0; i < access.items(value); ++i) {
      void* const item = access.itemAt(value, i);
      if (isNamed(part, *access.item, item)) useNumbers(*access.item, item, path.substr(part.size() + 1), use);
    }
  }
}

/// Visits the numbers that a path of keys of a scene file leads to; "*" is every key, or every item.
void useNumbers(const Record& record, void* object, std::string_view path, const Use& use) {
  const std::string_view key = path.substr(0, path.find('.'));
  const std::string_view rest = path.substr(std::min(key.size() + 1, path.size()));
  for (const Field& field : record.fields) {
    if ((key == "*" || key == field.name) && field.value.get != nullptr)
      useNumbers(field.value, field.value.get(object), rest, use);
  }
}

/// Multiplies the numbers of a path. @returns false where none differs from 0
bool multiplyAll(SceneDescription& scene, std::string_view path, double factor) {
  bool changed = false;
  useNumbers(recordOf<SceneDescription>(), &scene, path, [&](double& number) {
    changed = changed || number != 0.0;
    number *= factor;
  });
  return changed;
}

constexpr std::string_view compressibility = "organs.*.material.poissonRatio (0.5 - nu)",
                           bedStrength = "connective.*.strength";

}  // namespace

bool SceneConstant::multiply(SceneDescription& scene, double factor) const {
  // Times 0.5 - nu, which compressibility goes with: nu itself may not reach one half.
  if (name == compressibility) {
    for (OrganDescription& organ : scene.organs)
      organ.material.poissonRatio = 0.5 - factor * (0.5 - organ.material.poissonRatio);
    return true;
  }
  // With the share of the fracture's energy that is stored when it begins, sigma^2 / (2 k G_c), as it was.
  if (name == bedStrength) {
    for (ConnectiveDescription& bed : scene.connective) bed.fractureEnergy *= factor * factor;
  }
  return multiplyAll(scene, name, factor);
}

const std::vector<SceneConstant>& sceneConstants() {
  static const std::vector<SceneConstant> all{
      {"organs.liver.material.youngModulus"},
      {"organs.liver.material.stiffnessDamping"},
      {"organs.liver.material.density"},
      {"organs.liver.friction"},
      {"organs.liver.burnThrough"},
      {"organs.gallbladder.material.youngModulus"},
      {"organs.gallbladder.material.stiffnessDamping"},
      {"organs.gallbladder.material.density"},
      {"organs.gallbladder.friction"},
      {"organs.gallbladder.burnThrough"},
      {std::string(compressibility)},
      {"connective.*.stiffness"},
      {"connective.*.damping"},
      {std::string(bedStrength)},
      {"connective.*.fadeTime"},
      {"vessels.*.material.youngModulus"},
      {"vessels.*.wall"},
      {"vessels.*.ultimateStrain"},
      {"vessels.*.burnThrough"},
      {"vessels.*.friction"},
      {"fat.*.material.youngModulus"},
      {"fat.*.friction"},
      {"fat.*.attachments.*.stiffness"},
      {"retraction.*.stiffness"},
      {"hands.*.couplingStiffness"},
      {"hands.*.slipForce"},
      {"hands.*.tearForce"},
      {"cautery.power"},
      {"cautery.reach"},
      {"cautery.recession"},
      {"cautery.coagulationPace"},
      {"cautery.cutChar"},
      {"cautery.spot"},
      {"cautery.charTime"},
  };
  return all;
}

const SceneConstant* findSceneConstant(std::string_view name) {
  const std::vector<SceneConstant>& all = sceneConstants();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SceneConstant& c) { return c.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace calot::analytics
