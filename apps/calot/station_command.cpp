// SPDX-License-Identifier: GPL-3.0-or-later
// calot station: the key that a station signs its recordings with.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>

#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "apps/common/program.h"
#include "recorder/base/errors.h"
#include "recorder/recording/station_key.h"

namespace calot::apps {

void addStation(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("station", "The key that this station signs its recordings with");
  command->require_subcommand(1);
  struct Options {
    std::string name, file;
  };
  const auto o = std::make_shared<Options>();
  const auto tell = [](const recorder::StationKey& key) {
    std::cout << fmt::format("station {}\npublic key {}\n", key.station, toHex(key.publicKey));
    return static_cast<int>(ExitCode::yes);
  };
  CLI::App* init = command->add_subcommand("init", "Make a key; it is never replaced");
  init->add_option("name", o->name, "Name of the station")->required();
  init->add_option("-o,--output", o->file, "File to write; keep it on this station")->required();
  init->callback([o, tell, &run] {
    run = [o, tell] {
      const recorder::StationKey key = recorder::makeStationKey(o->name);
      recorder::writeStationKey(o->file, key);
      return tell(key);
    };
  });
  CLI::App* show = command->add_subcommand("show", "Print station and public key of a key file");
  show->add_option("file", o->file, "Key file")->required();
  show->callback([o, tell, &run] { run = [o, tell] { return tell(recorder::readStationKey(o->file)); }; });
}

}  // namespace calot::apps
