// SPDX-License-Identifier: GPL-3.0-or-later
// Which attempts of a cohort a study includes, and why others are excluded.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/study.h"

namespace calot::analytics {

/// Group of an attempt: the participant's study group or the performer's profile; empty: none.
std::string groupOf(const AttemptRow& attempt, Grouping grouping);

/// Unit of analysis: a participant's pseudonym, or "attempt UUID" for one performer's run.
std::string unitOf(const AttemptRow& attempt);

/// First reason that excludes an attempt, or empty. Details that differ between attempts follow a colon.
std::string whyOut(const AttemptRow& attempt, const StudyOptions& options);

/// Number of attempts excluded for each reason, in the order in which reasons are checked.
/// @param counted by what whyOut() said
std::vector<FlowRow> flowOf(const std::map<std::string, std::uint64_t>& counted);

}  // namespace calot::analytics
