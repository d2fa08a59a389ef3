// SPDX-License-Identifier: GPL-3.0-or-later
// Which attempts of a cohort a study takes, and why the others stay out.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/study.h"

namespace calot::analytics {

/// What makes the group of an attempt: the participant's study group, or the performer's profile; empty: none.
std::string groupOf(const AttemptRow& attempt, Grouping grouping);

/// Whose value it is: a person's pseudonym, or "attempt UUID" for one performer's run.
std::string unitOf(const AttemptRow& attempt);

/// Why an attempt stays out, the first reason that holds, or empty. Reasons that differ between attempts go on behind a
/// colon.
std::string whyOut(const AttemptRow& attempt, const StudyOptions& options);

/// How many attempts stayed out for each reason, in the order in which they are asked.
/// @param counted by what whyOut() said
std::vector<FlowRow> flowOf(const std::map<std::string, std::uint64_t>& counted);

}  // namespace calot::analytics
