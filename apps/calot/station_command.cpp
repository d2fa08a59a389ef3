// SPDX-License-Identifier: GPL-3.0-or-later
// calot station: the key that a station signs its recordings with.

#include "apps/calot/command.h"
#include "recorder/base/files.h"
#include "recorder/base/json_reader.h"
#include "recorder/recording/station_key.h"

namespace calot::apps {

namespace {

struct StationOptions {
  std::string name, file, key;
};

void printKey(const recorder::StationKey& key) {
  fmt::print("station {}\npublic key {}\n", key.station, recorder::hexOf(key.publicKey));
}

void initStation(const StationOptions& o) {
  const recorder::StationKey key = recorder::makeStationKey(o.name);
  recorder::writeStationKey(o.file, key);
  printKey(key);
}

void showStation(const StationOptions& o) { printKey(recorder::readStationKey(o.file)); }

void signText(const StationOptions& o) {
  const recorder::StationKey key = recorder::readStationKey(o.key);
  const std::vector<std::byte> bytes = recorder::readFileBytes(o.name, o.name, std::size_t{1} << 20U);
  recorder::parseStrictJson(bytes, o.name);  // others can read it
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const Json json{{"format", "calot-signed-text"},
                  {"format_version", 1},
                  {"station", key.station},
                  {"public_key", recorder::hexOf(key.publicKey)},
                  {"signature", recorder::hexOf(recorder::signHead(key, recorder::headOfText(text)))},
                  {"text", text}};
  recorder::writeText(o.file, json.dump(1) + "\n", false);
}

}  // namespace

void addStation(CLI::App& app, Run& run) {
  CLI::App& command = addGroup(app, {"station", "The key that this station signs its recordings with",
                                     "calot station init trainer-1 -o station.json"});
  const auto [init, i] = addCommand(
      command, run, {"init", "Make a key; it is never replaced", "calot station init trainer-1 -o station.json"},
      initStation);
  init->add_option("name", i->name, "Name of the station")->required();
  init->add_option("-o,--output", i->file, "File to write; keep it on this station")->required();
  const auto [show, s] = addCommand(
      command, run, {"show", "Print station and public key of a key file", "calot station show station.json"},
      showStation);
  show->add_option("file", s->file, "Key file")->required();
  const auto [sign, t] =
      addCommand(command, run,
                 {"sign", "Sign a JSON file, such as figures for another site, with the station's key",
                  "calot station sign figures.json --station-key station.json -o signed.json"},
                 signText);
  sign->add_option("file", t->name, "JSON file")->required();
  sign->add_option("--station-key", t->key, "Key file")->required();
  sign->add_option("-o,--output", t->file, "File to write: the text and its signature")->required();
}

}  // namespace calot::apps
