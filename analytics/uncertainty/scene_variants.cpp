// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/uncertainty/scene_variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/math/record.h"

namespace calot::analytics {
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

std::vector<SceneConstant> listed() {
  std::vector<SceneConstant> all;
  const auto add = [&](const std::string& path) {
    all.push_back({path, [path](SceneDescription& scene, double factor) { return multiplyAll(scene, path, factor); }});
  };
  for (const char* organ : {"liver", "gallbladder"}) {
    for (const char* key :
         {"material.youngModulus", "material.stiffnessDamping", "material.density", "friction", "burnThrough"})
      add(fmt::format("organs.{}.{}", organ, key));
  }
  // Times 0.5 - nu, which compressibility goes with: nu itself may not reach one half.
  all.push_back({"organs.*.material.poissonRatio (0.5 - nu)", [](SceneDescription& scene, double factor) {
                   useNumbers(recordOf<SceneDescription>(), &scene, "organs.*.material.poissonRatio",
                              [&](double& nu) { nu = 0.5 - factor * (0.5 - nu); });
                   return true;
                 }});
  // With the share of the fracture's energy that is stored when it begins, sigma^2 / (2 k G_c), as it was.
  all.push_back({"connective.*.strength", [](SceneDescription& scene, double factor) {
                   multiplyAll(scene, "connective.*.fractureEnergy", factor * factor);
                   return multiplyAll(scene, "connective.*.strength", factor);
                 }});
  for (const char* path : {"connective.*.stiffness",
                           "connective.*.damping",
                           "connective.*.fadeTime",
                           "vessels.*.material.youngModulus",
                           "vessels.*.wall",
                           "vessels.*.ultimateStrain",
                           "vessels.*.burnThrough",
                           "vessels.*.friction",
                           "fat.*.material.youngModulus",
                           "fat.*.friction",
                           "fat.*.attachments.*.stiffness",
                           "retraction.*.stiffness",
                           "hands.*.couplingStiffness",
                           "hands.*.slipForce",
                           "hands.*.tearForce",
                           "cautery.power",
                           "cautery.reach",
                           "cautery.recession",
                           "cautery.coagulationPace",
                           "cautery.cutChar",
                           "cautery.spot",
                           "cautery.charTime"})
    add(path);
  return all;
}

}  // namespace

const std::vector<SceneConstant>& sceneConstants() {
  static const std::vector<SceneConstant> all = listed();
  return all;
}

const SceneConstant* findSceneConstant(std::string_view name) {
  const std::vector<SceneConstant>& all = sceneConstants();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SceneConstant& c) { return c.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace calot::analytics
