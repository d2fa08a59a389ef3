// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/values_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "analytics/checkpoints/registry.h"
#include "analytics/shards/row_text.h"
#include "recorder/attempt.h"
#include "recorder/base/errors.h"
#include "recorder/base/json_reader.h"
#include "sim/scene/step_result.h"
#include "sim/scene/version.h"

namespace calot::analytics {
namespace {

constexpr const char* formatName = "calot-values";
constexpr double maxVersion = 4294967295.0;
constexpr std::size_t maxCheckpoints = 10'000;

const recorder::ObjectRule& headerRule() {
  static const recorder::ObjectRule rule{"header",
                                         {{"format"},
                                          {"format_version", true, 1.0, maxVersion},
                                          {"work"},
                                          {"shard", true, 1.0, maxShards},
                                          {"of", true, 1.0, maxShards},
                                          countKey("recordings"),
                                          countKey("planned"),
                                          {"plan"},
                                          {"software"},
                                          {"simulation_version", true, 0.0, maxVersion},
                                          {"step_result_version", true, 0.0, maxVersion},
                                          {"checkpoints"}}};
  return rule;
}

const recorder::ObjectRule& checkpointRule() {
  static const recorder::ObjectRule rule{
      "checkpoint", {{"name"}, {"version", true, 0.0, maxVersion}, {"unit", false}, {"filter", false}}};
  return rule;
}

std::vector<DefinedCheckpoint> definedHere() {
  std::vector<DefinedCheckpoint> list;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const CheckpointDefinition& d = entry.definition;
    list.push_back({d.name, d.unit, d.filter, d.version});
  }
  return list;
}

/// Why the file's definitions are not this build's, or empty.
std::string differingDefinition(const std::vector<DefinedCheckpoint>& theirs) {
  const std::vector<DefinedCheckpoint> ours = definedHere();
  for (const DefinedCheckpoint& d : ours) {
    const auto same = [&](const DefinedCheckpoint& other) { return other.name == d.name; };
    const auto found = std::find_if(theirs.begin(), theirs.end(), same);
    if (found == theirs.end()) return fmt::format("{} is not among them", d.name);
    if (found->version != d.version)
      return fmt::format("{} is of version {} there, of {} here", d.name, found->version, d.version);
    if (*found != d) return fmt::format("{} has another unit or filter there", d.name);
  }
  if (theirs.size() != ours.size()) return "there are checkpoints among them that this build does not know";
  return {};
}

}  // namespace

const char* nameOf(SharedWork work) { return work == SharedWork::regrade ? "regrade" : "assess"; }

ValuesHeader headerOf(SharedWork work, const Shard& shard, std::uint64_t recordings,
                      const std::vector<Dealt>& planned) {
  ValuesHeader header;
  header.work = work;
  header.shard = shard;
  header.recordings = recordings;
  header.planned = planned.size();
  header.plan = digestOf(planned);
  header.software = recorder::softwareName();
  header.simulationVersion = simulationVersion;
  header.stepResultVersion = stepResultVersion;
  header.checkpoints = definedHere();
  return header;
}

nlohmann::ordered_json jsonOf(const ValuesHeader& h) {
  nlohmann::ordered_json row = {{"format", formatName},
                                {"format_version", valuesFormatVersion},
                                {"work", nameOf(h.work)},
                                {"shard", h.shard.number},
                                {"of", h.shard.of},
                                {"recordings", h.recordings},
                                {"planned", h.planned},
                                {"plan", h.plan},
                                {"software", h.software},
                                {"simulation_version", h.simulationVersion},
                                {"step_result_version", h.stepResultVersion}};
  row["checkpoints"] = nlohmann::ordered_json::array();
  for (const DefinedCheckpoint& d : h.checkpoints) {
    nlohmann::ordered_json checkpoint = {{"name", d.name}, {"version", d.version}};
    if (!d.unit.empty()) checkpoint["unit"] = d.unit;
    if (!d.filter.empty()) checkpoint["filter"] = d.filter;
    row["checkpoints"].push_back(std::move(checkpoint));
  }
  return row;
}

ValuesHeader valuesHeader(const nlohmann::json& row, const std::string& file) {
  const bool ours = row.is_object() && row.value("format", nlohmann::json()) == formatName;
  if (!ours) throw Error(ErrorKind::damaged, Where{file, "line 1"}, "is no values file of Calot");
  const nlohmann::json version = row.value("format_version", nlohmann::json());
  if (version.is_number_unsigned() && version > valuesFormatVersion) {
    throw Error(ErrorKind::undecided, Where{file},
                fmt::format("values of format {}, this program reads up to {}; use a newer Calot",
                            version.get<std::uint64_t>(), valuesFormatVersion));
  }
  const recorder::JsonObject object = recorder::JsonPlace(row, file).object(headerRule());
  ValuesHeader h;
  h.work = object.at("work").word<SharedWork>({{"regrade", SharedWork::regrade}, {"assess", SharedWork::assess}});
  object.read("shard", h.shard.number);
  object.read("of", h.shard.of);
  if (h.shard.number > h.shard.of) object.at("shard").fail(fmt::format("there are {} only", h.shard.of));
  h.recordings = takeCount(object, "recordings");
  h.planned = takeCount(object, "planned");
  if (h.recordings > h.planned) object.at("recordings").fail("more than there are in all shares");
  object.read("plan", h.plan, maxRowText);
  object.read("software", h.software, maxRowText);
  object.read("simulation_version", h.simulationVersion);
  object.read("step_result_version", h.stepResultVersion);
  for (const recorder::JsonPlace& place : object.at("checkpoints").list(0, maxCheckpoints)) {
    const recorder::JsonObject checkpoint = place.object(checkpointRule());
    DefinedCheckpoint& d = h.checkpoints.emplace_back();
    checkpoint.read("name", d.name, maxRowText);
    checkpoint.read("version", d.version);
    checkpoint.read("unit", d.unit, maxRowText);
    checkpoint.read("filter", d.filter, maxRowText);
  }
  return h;
}

void checkDefinitions(const ValuesHeader& h, const std::string& file) {
  if (h.simulationVersion != simulationVersion) {
    throw Error(ErrorKind::undecided, Where{file},
                fmt::format("values of simulation version {}, this build has {}; compute this shard again with this "
                            "build, or take it with one of that version",
                            h.simulationVersion, simulationVersion));
  }
  std::string other = differingDefinition(h.checkpoints);
  if (other.empty() && h.stepResultVersion != stepResultVersion)
    other = fmt::format("step results are of version {} there, of {} here", h.stepResultVersion, stepResultVersion);
  if (!other.empty()) {
    throw Error(ErrorKind::refused, Where{file},
                fmt::format("values of other definitions ({}); compute this shard again with this build", other));
  }
}

}  // namespace calot::analytics
