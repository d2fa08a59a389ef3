// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/golden_list.h"

#include <nlohmann/json.hpp>
#include <set>

#include "recorder/base/file_bytes.h"
#include "recorder/base/json_reader.h"

namespace calot::apps {

namespace {

using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::ObjectRule;

constexpr double maxSeconds = 36000.0;
constexpr double any = 1e300;
constexpr std::size_t maxBytes = 4U << 20U;

const ObjectRule rootRule{
    "", {{"simulation_version", true, 1, 4294967295.0}, {"reason"}, {"values_reason", false}, {"recordings"}}};
const ObjectRule recordingRule{"recording",
                               {{"file"},
                                {"scene"},
                                {"performer"},
                                {"seed", true, 0, 4294967295.0},
                                {"seconds", true, 0, maxSeconds},
                                {"checkpoints", false}}};
const ObjectRule valueRule{
    "value", {{"name"}, {"subject", false}, {"version", true, 1, 4294967295.0}, {"value", true, -any, any}}};

GoldenValue readValue(const JsonPlace& place) {
  const JsonObject o = place.object(valueRule);
  GoldenValue v;
  o.read("name", v.name, 100);
  o.read("subject", v.subject, 100);
  o.read("version", v.version);
  o.read("value", v.value);
  return v;
}

GoldenEntry readEntry(const JsonPlace& place) {
  const JsonObject o = place.object(recordingRule);
  GoldenEntry e;
  o.read("file", e.file, 100);
  o.read("scene", e.scene, 100);
  o.read("performer", e.performer, 100);
  o.read("seed", e.seed);
  o.read("seconds", e.seconds);
  if (e.file.empty() || e.file.front() == '.' || std::filesystem::path(e.file).filename() != e.file)
    o.at("file").fail("is no file's name: a name without folders is wanted");
  if (o.has("checkpoints")) {
    for (const JsonPlace& value : o.at("checkpoints").list(0, 1000)) e.values.push_back(readValue(value));
  }
  return e;
}

}  // namespace

GoldenList readGoldenList(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = recorder::readFileBytes(file, file.string(), maxBytes);
  const nlohmann::json json = recorder::parseStrictJson(bytes, file.string());
  const JsonObject root = JsonPlace(json, file.string()).object(rootRule);
  GoldenList list;
  root.read("simulation_version", list.simulationVersion);
  root.read("reason", list.reason, 1000);
  root.read("values_reason", list.valuesReason, 1000);
  std::set<std::string> names;
  for (const JsonPlace& place : root.at("recordings").list(1, 1000)) {
    list.recordings.push_back(readEntry(place));
    if (!names.insert(list.recordings.back().file).second) place.fail("names a file that stands above already");
  }
  return list;
}

std::string toJson(const GoldenList& list) {
  nlohmann::ordered_json json;
  json["simulation_version"] = list.simulationVersion;
  json["reason"] = list.reason;
  if (!list.valuesReason.empty()) json["values_reason"] = list.valuesReason;
  json["recordings"] = nlohmann::ordered_json::array();
  for (const GoldenEntry& e : list.recordings) {
    nlohmann::ordered_json row;
    row["file"] = e.file;
    row["scene"] = e.scene;
    row["performer"] = e.performer;
    row["seed"] = e.seed;
    row["seconds"] = e.seconds;
    row["checkpoints"] = nlohmann::ordered_json::array();
    for (const GoldenValue& v : e.values) {
      nlohmann::ordered_json value = {{"name", v.name}};
      if (!v.subject.empty()) value["subject"] = v.subject;
      value["version"] = v.version;
      value["value"] = v.value;
      row["checkpoints"].push_back(value);
    }
    json["recordings"].push_back(row);
  }
  return json.dump(1) + "\n";
}

}  // namespace calot::apps
