// SPDX-License-Identifier: GPL-3.0-or-later
// Which attempts of a cohort a study includes, and why others are excluded.
#pragma once

#include <map>
#include <set>
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

/// Adds a remark where attempts of several comparability keys are mixed, as asked.
/// @throws Error (refused) where they would be mixed and nobody asked for it.
void askForOneKey(const std::vector<std::string>& keys, const StudyOptions& options, const std::string& name,
                  std::vector<std::string>& remarks);

/// The checkpoint of a phase's duration, which is always reported.
inline constexpr const char* phaseDurationName = "phase-duration";
/// Checkpoints of phases that were not requested.
std::vector<std::string> unaskedPhases(const StudyOptions& options);

/// Pseudonyms in a named cohort. @throws Error (invalid) where the database at `path` has no such cohort.
std::set<std::string> participantsOf(const std::string& path, const std::string& cohort);

}  // namespace calot::analytics
