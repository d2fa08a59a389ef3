// SPDX-License-Identifier: GPL-3.0-or-later
// The station that records: its name and its key.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "recorder/recording/station_key.h"

namespace calot::apps {

/// Adds --station-key. @param file outlives the parsing.
void addStationKey(CLI::App& command, std::string& file);

/// The key of the option, or else of the environment (CALOT_STATION_KEY); none where neither names a file.
/// @throws Error as recorder::readStationKey
std::optional<recorder::StationKey> stationKeyOf(const std::string& file);

/// The station that a recording names. @throws Error (invalid) where the key is another station's.
std::string stationOf(const std::string& named, const std::optional<recorder::StationKey>& key);

}  // namespace calot::apps
