// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/registry.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"

namespace calot::analytics {

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

const CheckpointDefinition* findCheckpoint(std::string_view name) {
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    if (entry.definition.name == name) return &entry.definition;
  }
  return nullptr;
}

const CheckpointDefinition* definitionOf(const CheckpointValue& value) {
  return value.metric ? &value.metric->definition : findCheckpoint(value.name);
}

std::optional<CheckpointFamily> familyOf(std::string_view name) {
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    if (entry.definition.name == name) return entry.place.family;
  }
  return std::nullopt;
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
