// SPDX-License-Identifier: GPL-3.0-or-later
// A study whose groups have no names, and what is fixed when its analysis is locked.
#pragma once

#include <string>
#include <vector>

#include "analytics/cohort/analysis_locks.h"
#include "analytics/report/study.h"

namespace calot::analytics {

/// The study of a protocol with "group 1" and "group 2" in place of its groups: without directions, verdicts on
/// hypotheses, definitions of the populations, published values and pseudonyms. The groups' sizes remain.
/// @param swapped the protocol's second population is group 1. @pre options have a protocol
/// @throws Error as makeStudy(), whose messages name the masked groups
Study makeMaskedStudy(const CohortDatabase& database, const AssessmentDatabase& assessment, const StudyOptions& options,
                      bool swapped);

/// Choices beside the protocol that decide the figures, a line each: what a lock compares.
std::string analysisOptions(const StudyOptions& options);

/// SHA-256 over every attempt with its participant, group and exclusion, every value, and every rating.
std::string analysisDigest(const CohortDatabase& database, const AssessmentDatabase& assessment);

/// Notes in the study when its analysis was locked, and what has changed since. @pre there is a protocol
void describeLock(Study& study, const AnalysisLock& lock, const AnalysisLock& now);

}  // namespace calot::analytics
