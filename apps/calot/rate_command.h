// SPDX-License-Identifier: GPL-3.0-or-later
// Ratings by files: tables of completed forms, packs for raters, and the answers that come back.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/calot/command.h"

namespace calot::apps {

/// `calot rate C.db --manifest F`. @param form of rows that name none. @return the exit code
int storeRatingManifest(const std::string& cohort, const std::string& manifest, const std::string& form, bool force,
                        bool json);

/// `calot rate C.db --take F`. @return the exit code
int takePackAnswers(const std::string& cohort, const std::string& file, bool force);

/// Adds `calot rate pack`.
CLI::App* addRatePack(CLI::App& rate, Run& run);

}  // namespace calot::apps
