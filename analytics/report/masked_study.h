// SPDX-License-Identifier: GPL-3.0-or-later
// A study whose groups have no names, and what is fixed when its analysis is locked.
#pragma once

#include <string>
#include <vector>

#include "analytics/cohort/blinding.h"
#include "analytics/report/study.h"

namespace calot::analytics {

/// The study of a protocol with "group 1" and "group 2" in place of its groups: without directions, verdicts on
/// hypotheses, definitions of the populations, published values and pseudonyms. The groups' sizes remain.
/// @param swapped the protocol's second population is group 1. @pre options have a protocol
/// @throws Error as makeStudy(), whose messages name the masked groups
Study makeMaskedStudy(const CohortDatabase& database, const AssessmentDatabase& assessment, const StudyOptions& options,
                      bool swapped, const StudyProgress& progress = {});

/// Choices beside the protocol that decide the figures, a line each: what a lock compares.
std::string analysisOptions(const StudyOptions& options);

/// SHA-256 over every attempt with its participant, group and exclusion, every value, and every rating.
std::string analysisDigest(const CohortDatabase& database, const AssessmentDatabase& assessment);

/// Content fixed by a lock of this study's analysis, without time and name. @pre options have a protocol
AnalysisLock presentAnalysis(const CohortDatabase& database, const AssessmentDatabase& assessment,
                             const StudyOptions& options);

/// The study of a protocol with its forms: masked from the moment that somebody asks for it until its analysis is
/// locked; after that it says what has changed since. @pre options have a protocol
/// @param masked asks for it: which group is "group 1" is drawn, where it never was
/// @throws Error as makeStudy()
Study makeProtocolStudy(const CohortDatabase& database, const AssessmentDatabase& assessment,
                        const StudyOptions& options, bool masked, const StudyProgress& progress = {});

}  // namespace calot::analytics
