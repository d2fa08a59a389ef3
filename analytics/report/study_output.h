// SPDX-License-Identifier: GPL-3.0-or-later
// A study as one tree of values, and what is written of it: tables and sentences, the same on the terminal and in a
// document; JSON and CSV. Numbers are written with a point, whatever the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/plots.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study.h"
#include "analytics/report/value_tree.h"

namespace calot::analytics {

enum class StudyDetail : std::uint8_t {
  first,  ///< heading, flow, participants, the first result and its notes: a screen, two pages
  all     ///< the appendix as well
};

/// For a terminal of 120 columns.
void printStudy(const Study& study, std::ostream& out, StudyDetail detail = StudyDetail::all);

/// Everything as one tree; missing numbers are null, with a reason.
ValueTree studyTree(const Study& study);
ValueTree rowTree(const Study& study, const StudyRow& row);  ///< one of its "rows"

/// Writes study.csv (a row a checkpoint), values.csv (a row a participant and checkpoint), flow.csv and, where forms
/// were filled in, ratings.csv (a row an item and group) into a folder, which is made; files that are there are kept
/// unless `force`.
/// @throws Error (invalid) when a file is there already, Error (failure) when writing fails.
void writeStudyCsv(const Study& study, const std::string& folder, bool force);

/// First: two pages of A4 whatever the study's size. The first has question and groups, flow, participants and the
/// first result, the second its forest plots, box plots of the figures that lead, methods, and limits in short; what
/// has no space on them is counted there. All: from the third page on an appendix, which has what the two pages
/// shortened, all other tables, a box plot with all points for each row, and the spread of each completed form's
/// scores.
ReportDocument studyDocument(const Study& study, StudyDetail detail = StudyDetail::all);

std::string studyTitle(const Study& study);  ///< "Study (exploratory): expert against novice"
/// Checkpoint and subject, "path-length left"; external metrics are marked, "mean-grasp-force (external)".
std::string rowName(const StudyRow& row);
std::string figureOfRow(const StudyRow& row);  ///< the same without the mark
bool hasNoValue(const StudyRow& row);          ///< nobody of either group has one
/// The protocol, when it was registered, why the study is exploratory all the same; or empty.
std::vector<std::string> protocolLines(const Study& study);
/// States whether the protocol's analysis is locked, by whom, and what has changed since: one sentence.
std::string lockText(const StudyProtocol& protocol);
/// States in one line whether a protocol was registered before the first attempt, and whether the analysis is locked.
std::string registrationText(const Study& study);
/// Under the title: the protocol, task, device and versions in words, dates, and the unit of analysis.
std::vector<std::string> studyHead(const Study& study);
/// Methods paragraph for a paper: states only what was done.
std::string studyMethods(const Study& study);

/// The first result: the primary hypotheses; without a protocol the rows that lead (StudyRow::leading). With n, shift,
/// A, their intervals, p, adjusted p and the smallest adjusted p that the groups can give.
ReportTable primaryTable(const Study& study);
/// The same of the secondary hypotheses; without rows where there are none.
ReportTable secondaryTable(const Study& study);
/// A of the first result's rows with intervals, one below the other: of those with a hypothesis, then of those without
/// a direction. Empty without such figures. @param most rows of all drawings
std::vector<Drawing> forestsOf(const Study& study, std::size_t most = std::string::npos);
/// A row's values in both groups; marks are participants. None where it has no values.
std::optional<Drawing> boxPlotOf(const Study& study, const StudyRow& row, const PlotFrame& frame = {});
/// Notes to the first result: its columns, whether the groups can reach the level at all, warnings, remarks,
/// deviations from the protocol, and what its rows lack.
std::vector<std::string> primaryNotes(const Study& study);

/// Everything else: secondary hypotheses, values and comparison of every row by the checkpoints' families, figures that
/// are no outcomes, coverage, correlation, forms. A row without any value is in none of them, nor is an empty table.
std::vector<ReportTable> appendixTables(const Study& study);
/// Meaning of the appendix's columns, published figures, and gaps of the other rows.
std::vector<std::string> appendixNotes(const Study& study);
/// Intervals whose published coverage is low at these sizes, and how many of the rows that lead, or of the others, have
/// them.
std::vector<std::string> intervalWarnings(const Study& study, bool leading);
/// Reasons why rows have no test, and who has no value of them: sentences for `notes`. @param leading of the rows that
/// lead, or of the others
void explainMissing(const Study& study, bool leading, std::vector<std::string>& notes);

}  // namespace calot::analytics
