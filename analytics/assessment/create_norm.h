// SPDX-License-Identifier: GPL-3.0-or-later
// A norm of a cohort, made and stored; and what a person reads of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analytics/assessment/norm.h"

namespace calot::analytics {

/// How far it is, from 0 to 1, and what is being done. The last call comes before anything is stored; what it throws
/// ends the making, and nothing is stored.
using NormProgress = std::function<void(double share, const char* doing)>;

/// Makes a norm of a cohort's attempts, after the whole cohort was checked, and stores it as the next version of its
/// name. A protocol gets the participants' recorded experience.
/// @param only uuids of the attempts that it may be made of; empty: all that the request allows
/// @return as it is stored @throws Error as refuseUnsound(), makeNorm(), AssessmentDatabase::storeNorm() and
/// CohortDatabase
Norm createNorm(const std::string& database, NormRequest request, const std::vector<std::string>& only = {},
                const NormProgress& progress = {});

/// Members and author, its rule with the pass rates of the rule, and its permitted use: whole
/// sentences.
std::vector<std::string> normSummary(const Norm& norm);

/// Competent members who fail, harm that does not count, intervals that are too narrow: whole sentences, or none.
std::vector<std::string> normWarnings(const Norm& norm);

}  // namespace calot::analytics
