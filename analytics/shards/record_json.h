// SPDX-License-Identifier: GPL-3.0-or-later
// What a cohort knows of an attempt from its recording, as JSON (schemas/values.md). Internal to this folder.
#pragma once

#include <nlohmann/json.hpp>

#include "analytics/cohort/cohort_database.h"
#include "recorder/base/json_reader.h"

namespace calot::analytics {

nlohmann::ordered_json jsonOfRecord(const AttemptRecord& record);
/// @throws Error (damaged)
AttemptRecord recordFrom(const recorder::JsonPlace& place);

}  // namespace calot::analytics
