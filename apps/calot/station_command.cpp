// SPDX-License-Identifier: GPL-3.0-or-later
// calot station: the key that a station signs its recordings with.

#include "apps/calot/command.h"
#include "recorder/base/files.h"
#include "recorder/recording/station_key.h"

namespace calot::apps {

namespace {

struct StationOptions {
  std::string name, file;
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
}

}  // namespace calot::apps
