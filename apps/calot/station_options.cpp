// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/station_options.h"

#include <fmt/format.h>

#include <cstdlib>

#include "recorder/base/errors.h"

namespace calot::apps {

void addStationKey(CLI::App& command, std::string& file) {
  command.add_option("--station-key", file, "key file to sign with (calot station init); default: CALOT_STATION_KEY");
}

std::optional<recorder::StationKey> stationKeyOf(const std::string& file) {
  const char* set = std::getenv("CALOT_STATION_KEY");
  const std::string name = file.empty() && set != nullptr ? set : file;
  if (name.empty()) return std::nullopt;
  return recorder::readStationKey(name);
}

std::string stationOf(const std::string& named, const std::optional<recorder::StationKey>& key) {
  if (!key) return named;
  if (!named.empty() && named != key->station)
    throw Error(ErrorKind::invalid, fmt::format("--station {}: the key is that of station {}", named, key->station));
  return key->station;
}

}  // namespace calot::apps
