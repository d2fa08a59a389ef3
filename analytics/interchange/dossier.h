// SPDX-License-Identifier: GPL-3.0-or-later
// Validity dossier of a cohort: questions and reporting items (assets/dossier) answered from what the cohort holds.
#pragma once

#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study.h"
#include "analytics/report/value_tree.h"

namespace calot::analytics {

struct Dossier {
  ValueTree json;  ///< "sections" of "items", each with "state" (yes, part, no, author), "found", "missing"; "facts"
  ReportDocument document;
};

/// Analyses that a dossier needs beside the cohort's tables: the study, designs over repeated attempts and ratings, the
/// newest version of every norm with its decisions. One that is not possible has its "reason".
/// @param external readSignedFigures()
ValueTree dossierFacts(const CohortDatabase& database, const StudyOptions& options, const ValueTree& external);

/// Figures that other sites sent, signed by `calot station sign`; "station" and "registered" are added: its key is
/// registered here. @throws Error (damaged) where a signature does not fit; (refused) for another key than the
/// station's
ValueTree readSignedFigures(const std::vector<std::string>& files, const CohortDatabase& database);

/// @param questions assets/dossier/validity.json: queries over the cohort and the table `facts` find sentences, and one
/// without a row leaves its "missing" sentence @throws Error as CohortDatabase
Dossier makeDossier(const std::string& database, const ValueTree& questions, const ValueTree& facts);

}  // namespace calot::analytics
