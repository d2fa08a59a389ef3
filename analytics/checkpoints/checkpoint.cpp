// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/phases.h"
#include "sim/connective/connective_tissue.h"

namespace calot::analytics {
namespace {

double areaOf(const SurfaceDescription& surface) {
  double area = 0.0;
  for (const Index3& t : surface.triangle) {
    const Vec3& origin = surface.vertex[static_cast<std::size_t>(t[0])];
    const Vec3 a = surface.vertex[static_cast<std::size_t>(t[1])] - origin;
    const Vec3 b = surface.vertex[static_cast<std::size_t>(t[2])] - origin;
    const double x = a.y() * b.z() - a.z() * b.y();
    const double y = a.z() * b.x() - a.x() * b.z();
    const double z = a.x() * b.y() - a.y() * b.x();
    area += 0.5 * std::sqrt(x * x + y * y + z * z);
  }
  return area;
}

TriangleMesh meshOf(const SurfaceDescription& surface) { return {surface.vertex, surface.triangle}; }

/// Area of the bed of a tissue (m^2), as the simulation finds it; 0 where the scene lacks one of its organs.
double bedAreaOf(const SceneDescription& scene, const ConnectiveDescription& tissue) {
  const auto organ = [&](const std::string& name) {
    return std::find_if(scene.organs.begin(), scene.organs.end(), [&](const auto& o) { return o.name == name; });
  };
  const auto first = organ(tissue.first), second = organ(tissue.second);
  if (first == scene.organs.end() || second == scene.organs.end() || second->surface.triangle.empty()) return 0.0;
  const SurfaceDistance distance(meshOf(second->surface));
  return areaOf({first->surface.vertex, bedTriangles(meshOf(first->surface), distance, tissue.reach)});
}

}  // namespace

bool SceneFacts::hasCystic() const {
  return std::any_of(vessel.begin(), vessel.end(), [](const Vessel& v) { return v.cystic; });
}

bool SceneFacts::hasSpared() const {
  return std::any_of(vessel.begin(), vessel.end(), [](const Vessel& v) { return v.spared; });
}

SceneFacts sceneFacts(const SceneDescription& scene) {
  SceneFacts facts;
  for (const OrganDescription& organ : scene.organs) {
    facts.organ.push_back({organ.name, organ.role, areaOf(organ.surface), organ.burnThrough > 0.0});
  }
  for (const VesselDescription& vessel : scene.vessels) {
    const std::vector<std::string>& spare = scene.procedure.spare;
    facts.vessel.push_back(
        {vessel.name, isCystic(vessel.role), std::find(spare.begin(), spare.end(), vessel.name) != spare.end()});
  }
  for (const ConnectiveDescription& tissue : scene.connective) {
    const bool holds = tissue.role == StructureRole::cysticPlate;
    facts.connective.push_back({tissue.name, holds, holds ? bedAreaOf(scene, tissue) : 0.0});
  }
  facts.fat = scene.fat.size();
  facts.picture = {scene.camera, scene.verticalFieldOfView};
  facts.triangle = std::any_of(scene.fat.begin(), scene.fat.end(),
                               [](const FatDescription& fat) { return fat.triangleDepth > 0.0; });
  facts.retractionOnRequest = std::any_of(scene.retraction.begin(), scene.retraction.end(),
                                          [](const RetractionDescription& r) { return r.stage > 0.0; });
  return facts;
}

namespace {

std::string firstObjection(const CheckpointEntry& entry, const AttemptContext& context) {
  for (const Requirement& need : entry.needs) {
    if (!need.met(context)) return need.otherwise;
  }
  return whyTooOld(context, entry.results);
}

}  // namespace

std::vector<std::string> subjectsOf(const CheckpointEntry& entry, const AttemptContext& context) {
  if (entry.subjects != nullptr) return entry.subjects(context);
  std::vector<std::string> phases, handsInPhases;
  for (const Phase phase : windowPhases) {
    phases.emplace_back(nameOf(phase));
    for (std::size_t h = 0; h < handNames.size(); ++h) handsInPhases.push_back(handAndPhase(h, phase));
  }
  switch (entry.definition.aggregation) {
    case Aggregation::attempt:
      break;
    case Aggregation::hand:
      return {handNames.begin(), handNames.end()};
    case Aggregation::organ:
      return context.structures;
    case Aggregation::phase:
      return phases;
    case Aggregation::handAndPhase:
      return handsInPhases;
  }
  return {""};
}

std::string nameOf(Direction direction) { return nameIn({"none", "lower", "higher"}, direction); }

std::string nameOf(Origin origin) { return nameIn({"re-simulated", "observables", "samples", "external"}, origin); }

std::string nameOf(Aggregation aggregation) {
  return nameIn({"attempt", "hand", "organ", "phase", "hand and phase"}, aggregation);
}

std::string nameOf(Finality finality) { return nameIn({"running", "final"}, finality); }

std::string nameOf(Availability availability) {
  return nameIn({"value", "not applicable", "not available", "absent hand", "too little coverage"}, availability);
}

std::string nameOf(CheckpointFamily family) {
  return nameIn(
      {"Table 2", "motion", "phases", "contact and force", "errors and safety", "exactness of the simulation"}, family);
}

std::string whyTooOld(const AttemptContext& context, std::uint32_t needed) {
  if (context.resultVersion >= needed) return {};
  return fmt::format("not recorded in results of version {}", context.resultVersion);
}

std::string coverageText(const CheckpointDefinition& definition) {
  if (definition.minCoverage <= 0.0) return {};
  return fmt::format("at least {:g} % of the window", 100.0 * definition.minCoverage);
}

std::string stretchNote(const AttemptEnd& end) {
  return end.stretched > 0.0 ? fmt::format("tick clock stretched by {:.3f} s", end.stretched) : std::string();
}

namespace {

CheckpointValue valueOf(const CheckpointDefinition& definition, std::string subject, Origin origin) {
  CheckpointValue v;
  v.name = definition.name;
  v.subject = std::move(subject);
  v.version = definition.version;
  v.unit = definition.unit;
  v.origin = origin;
  v.filter = definition.filter;
  return v;
}

}  // namespace

CheckpointValue makeMissing(const CheckpointDefinition& definition, std::string subject, Origin origin,
                            Availability availability, std::string reason) {
  assert(availability != Availability::value && !reason.empty());
  CheckpointValue v = valueOf(definition, std::move(subject), origin);
  v.availability = availability;
  v.reason = std::move(reason);
  return v;
}

CheckpointValue makeValue(const CheckpointDefinition& definition, std::string subject, Origin origin, double value,
                          std::string note) {
  if (!std::isfinite(value))
    return makeMissing(definition, std::move(subject), origin, Availability::notAvailable, "the figure is not finite");
  CheckpointValue v = valueOf(definition, std::move(subject), origin);
  v.value = value;
  v.note = std::move(note);
  return v;
}

CheckpointDefinition completed(CheckpointDefinition definition) {
  const auto fill = [](std::string& text, const std::string& usual) {
    if (text.empty()) text = usual;
  };
  fill(definition.window, "whole attempt");
  fill(definition.instruments, "union over instruments");
  fill(definition.filter, "none");
  if (definition.origins.empty()) definition.origins = {Origin::resimulated, Origin::observables};
  struct Display {
    double factor;
    const char* unit;
  };
  static const std::map<std::string, Display> displays{
      {"%", {100.0, "1"}},       {"mm", {1000.0, "m"}},
      {"mm/s", {1000.0, "m/s"}}, {"deg", {180.0 / std::numbers::pi, "rad"}},
      {"ml", {1e6, "m^3"}},      {"cm^2", {1e4, "m^2"}},
      {"cm^2/ml", {0.01, "1/m"}}};
  if (const auto display = displays.find(definition.displayUnit); display != displays.end()) {
    definition.displayFactor = display->second.factor;
    fill(definition.unit, display->second.unit);
  }
  fill(definition.unit, "1");
  fill(definition.displayUnit, definition.unit);
  return definition;
}

std::unique_ptr<Checkpoint> CheckpointEntry::make(const AttemptContext& context) const {
  return std::make_unique<Checkpoint>(*this, context);
}

Checkpoint::Checkpoint(const CheckpointEntry& entry, AttemptContext context)
    : entry_(entry),
      context_(std::move(context)),
      notApplicable_(firstObjection(entry, context_)),
      subjects_(subjectsOf(entry, context_)),
      accumulator_(notApplicable_.empty() ? entry.accumulate(context_) : nullptr) {}

void Checkpoint::onStep(const recorder::StepRecord& record, const Judgement& judgement) {
  if (accumulator_) accumulator_->add(record, judgement);
}

Measured Checkpoint::measured(const AttemptEnd& end, std::size_t subject) const {
  if (!accumulator_) return Measured::notApplicable(notApplicable_);
  if (isOfPhases(entry_.definition) && !entry_.ofAbsentPhases) {
    const std::size_t perPhase = subjects_.size() / windowPhases.size();
    if (!((*end.phases)[subject / perPhase].seconds > 0.0)) return Measured::notApplicable(noSuchPhase);
  }
  return accumulator_->figure(end, subject, entry_.definition);
}

std::vector<CheckpointValue> Checkpoint::values(const AttemptEnd& end) const {
  const CheckpointDefinition& d = entry_.definition;
  const Origin origin = d.origins == std::vector{Origin::samples} ? Origin::samples : end.origin;
  // Without phases there are no subjects either.
  if (!accumulator_ && isOfPhases(d)) return {makeMissing(d, "", origin, Availability::notApplicable, notApplicable_)};
  const double cutoff = end.motion[0] != nullptr ? end.motion[0]->cutoff : motionCutoff;
  std::vector<CheckpointValue> result;
  for (std::size_t s = 0; s < subjects_.size(); ++s) {
    const Measured m = measured(end, s);
    CheckpointValue& value = result.emplace_back(m.value ? makeValue(d, subjects_[s], origin, *m.value, m.note)
                                                         : makeMissing(d, subjects_[s], origin, m.missing, m.reason));
    if (cutoff != motionCutoff && d.filter == motionFilterText()) value.filter = motionFilterText(cutoff);
    value.coverage = m.coverage;
    value.rate = m.rate;
    value.noise = m.noise;
  }
  return result;
}

const std::vector<CheckpointEntry>& checkpointRegistry() {
  static const std::vector<CheckpointEntry> registry = [] {
    std::vector<CheckpointEntry> list;
    for (const auto rows :
         {attemptRows, motionRows, smoothnessRows, cameraRows, forceRows, contactRows, dissectionRows, safetyRows}) {
      std::vector<CheckpointEntry> those = rows();
      list.insert(list.end(), std::make_move_iterator(those.begin()), std::make_move_iterator(those.end()));
    }
    for (CheckpointEntry& entry : list) entry.definition = completed(std::move(entry.definition));
    std::sort(list.begin(), list.end(), [](const CheckpointEntry& a, const CheckpointEntry& b) {
      return std::pair(a.place.family, a.place.rank) < std::pair(b.place.family, b.place.rank);
    });
    return list;
  }();
  return registry;
}

CheckpointEntry phaseRow(const CheckpointEntry& whole, int rank, const char* pieces, AccumulatorMaker accumulate,
                         std::uint32_t version) {
  std::vector<Requirement> needs{hasProcedure};
  needs.insert(needs.end(), whole.needs.begin(), whole.needs.end());
  return {.place = {CheckpointFamily::phases, rank},
          .definition = phaseDefinition(completed(whole.definition), pieces, version),
          .needs = std::move(needs),
          .results = std::max<std::uint32_t>(whole.results, 3),  // since then steps are judged by phase
          .accumulate = std::move(accumulate)};
}

std::size_t positionOf(std::string_view name) {
  const auto& registry = checkpointRegistry();
  return static_cast<std::size_t>(
      std::find_if(registry.begin(), registry.end(), [&](const auto& entry) { return entry.definition.name == name; }) -
      registry.begin());
}

const CheckpointDefinition* findCheckpoint(std::string_view name) {
  const std::size_t position = positionOf(name);
  return position < checkpointRegistry().size() ? &checkpointRegistry()[position].definition : nullptr;
}

const CheckpointDefinition* definitionOf(const CheckpointValue& value) {
  return value.metric ? &value.metric->definition : findCheckpoint(value.name);
}

std::optional<CheckpointFamily> familyOf(std::string_view name) {
  const std::size_t position = positionOf(name);
  if (position == checkpointRegistry().size()) return std::nullopt;
  return checkpointRegistry()[position].place.family;
}

bool isOfPhases(const CheckpointDefinition& definition) {
  return definition.aggregation == Aggregation::phase || definition.aggregation == Aggregation::handAndPhase;
}

const std::vector<std::string>& phaseCheckpoints() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const CheckpointEntry& entry : checkpointRegistry()) {
      if (isOfPhases(entry.definition)) list.push_back(entry.definition.name);
    }
    return list;
  }();
  return names;
}

}  // namespace calot::analytics
