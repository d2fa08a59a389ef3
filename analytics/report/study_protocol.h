// SPDX-License-Identifier: GPL-3.0-or-later
// Effects of a protocol on a study: population, roles of rows, family and heading; a study whose groups have no names,
// and what is fixed when its analysis is locked.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analytics/cohort/blinding.h"
#include "analytics/report/study.h"

namespace calot::analytics {

/// Replaces the study's choices by those of the protocol. @pre there is a protocol.
StudyOptions byProtocol(const StudyOptions& options);

/// Reason why the protocol excludes an attempt, one of protocolReasons(), details behind a colon: another scene, an
/// outcome that it excludes, a participant who is not of the population of `group`; or empty.
std::string whyOutByProtocol(const AttemptRow& attempt, const std::string& group, const ProtocolInUse& protocol);
/// Attempts of the protocol's groups in its scene, whether a study takes them or not.
std::size_t attemptsUnder(const Protocol& protocol, const std::vector<AttemptRow>& attempts);
/// In the order in which they are asked, for the flow.
const std::vector<std::string>& protocolReasons();

/// The choices that the protocol makes of any study.
void chooseByProtocol(StudyChoices& choices, const Protocol& protocol);

/// The figure of a hypothesis as figureOfRow() has it: "path-length left".
std::string figureOf(const DirectedHypothesis& hypothesis);

/// For a table: `study.protocol`, the reason why it is exploratory, and what of the protocol a table cannot answer, as
/// deviations.
void describeProtocolOfTable(Study& study, const Protocol& protocol);

/// Fills `study.protocol` and the heading: confirmatory where the registered hash, the times of import and recorded
/// starts show that the protocol came before the data, else exploratory, with the reason. Lists versions, what changed,
/// and what deviates.
/// @param data attempts that are analysed, or were excluded by hand
void describeProtocol(Study& study, const std::vector<const AttemptRow*>& data, const StudyOptions& options);

/// The row's role and, of a hypothesis, its direction.
void declareRow(StudyRow& row, const Study& study, const Protocol& protocol);

/// Holm's adjustment over the primary hypotheses alone, one without a test counting as p = 1; Benjamini-Hochberg over
/// secondary ones; exploratory figures have no adjusted p. Hypotheses that no row answers to become remarks.
void adjustByProtocol(Study& study, const Protocol& protocol);

/// The study of a protocol with "group 1" and "group 2" in place of its groups: without directions, verdicts on
/// hypotheses, definitions of the populations, published values and pseudonyms. The groups' sizes remain.
/// @param swapped the protocol's second population is group 1. @pre options have a protocol
/// @throws Error as makeStudy(), whose messages name the masked groups
Study makeMaskedStudy(const CohortDatabase& database, const StudyOptions& options, bool swapped,
                      const StudyProgress& progress = {});

/// Choices beside the protocol that decide the figures, a line each: what a lock compares.
std::string analysisOptions(const StudyOptions& options);

/// SHA-256 over every attempt with its participant, group and exclusion, every value, and every rating.
std::string analysisDigest(const CohortDatabase& database);

/// Content fixed by a lock of this study's analysis, without time and name. @pre options have a protocol
AnalysisLock presentAnalysis(const CohortDatabase& database, const StudyOptions& options);

/// The study of a protocol with its forms: masked from the moment that somebody asks for it until its analysis is
/// locked; after that it says what has changed since. @pre options have a protocol
/// @param masked asks for it: which group is "group 1" is drawn, where it never was
/// @throws Error as makeStudy()
Study makeProtocolStudy(const CohortDatabase& database, const StudyOptions& options, bool masked,
                        const StudyProgress& progress = {});

}  // namespace calot::analytics
