// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "analytics/report/ratings.h"

namespace calot::analytics {

/// Every report with all of its numbers; missing numbers are null, with a reason if there is one.
nlohmann::ordered_json ratingsJson(const std::vector<FormReport>& reports);

}  // namespace calot::analytics
