// SPDX-License-Identifier: GPL-3.0-or-later
// First row of a values file: of what plan and share it is, and by which definitions its values were computed
// (schemas/values.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/shards/shard.h"

namespace calot::analytics {

inline constexpr std::uint32_t valuesFormatVersion = 2;

enum class SharedWork : std::uint8_t {
  regrade,  ///< recordings of a cohort's attempts
  assess,   ///< recordings of folders
};
const char* nameOf(SharedWork work);  ///< "regrade", "assess"

/// What a checkpoint's values say of their definition.
struct DefinedCheckpoint {
  std::string name, unit, filter;
  std::uint32_t version = 0;
  bool operator==(const DefinedCheckpoint&) const = default;
};

struct ValuesHeader {
  SharedWork work = SharedWork::regrade;
  Shard shard;
  std::uint64_t recordings = 0;  ///< of this share
  std::uint64_t planned = 0;     ///< of all shares
  std::string plan;              ///< digestOf() the list that was divided
  std::string software;          ///< "calot 0.1.0"
  std::uint32_t simulationVersion = 0, stepResultVersion = 0;
  std::vector<DefinedCheckpoint> checkpoints;  ///< the whole registry, in its order

  bool operator==(const ValuesHeader&) const = default;
};

/// A header of this build. @param planned everything that is divided
ValuesHeader headerOf(SharedWork work, const Shard& shard, std::uint64_t recordings, const std::vector<Dealt>& planned);

nlohmann::ordered_json jsonOf(const ValuesHeader& header);
/// @param file for messages. @throws Error (damaged) for what is no header; (undecided) for a later format
ValuesHeader valuesHeader(const nlohmann::json& row, const std::string& file);

/// Refuses values that this build would not compute in the same way. @throws Error: undecided, of another simulation
/// version; refused, of other definitions
void checkDefinitions(const ValuesHeader& header, const std::string& file);

}  // namespace calot::analytics
