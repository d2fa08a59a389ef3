// SPDX-License-Identifier: GPL-3.0-or-later
// The comparison of two groups of a cohort, as data; study_output.h prints it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/statistics/answer.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

enum class Grouping : std::uint8_t { performer, group };

struct StudyOptions {
  Grouping grouping = Grouping::group;
  std::vector<std::string> groups;  ///< the two to compare, in order; empty: the only two that are there
  bool includeSynthetic = false;
  bool includePractice = false;
  bool includeBranches = false;
  bool mixKeys = false;  ///< compare across comparability keys and checkpoint versions, and say so
};

/// One reason for which attempts stay out, in the order in which they are asked.
struct FlowRow {
  std::string reason;
  std::uint64_t attempts = 0;
};

/// One group's values of one checkpoint, one per participant, in the checkpoint's display unit.
struct GroupSummary {
  std::uint64_t n = 0;
  std::uint64_t missing = 0;  ///< participants without any value
  std::string missingReason;  ///< the commonest
  std::optional<double> mean, standardDeviation, median, lowerQuartile, upperQuartile;
};

struct StudyRow {
  std::string checkpoint;  ///< name
  std::string subject;
  std::string title;
  std::string unit;  ///< display unit
  Direction direction = Direction::none;
  std::vector<std::uint32_t> versions;  ///< of the values in it, ascending
  std::vector<std::string> origins;
  std::array<GroupSummary, 2> group;
  std::array<std::vector<std::string>, 2> participants;  ///< whose, ascending; "attempt UUID" for a performer's run
  std::array<std::vector<double>, 2> values;             ///< as many, in the display unit
  Answer<MannWhitney> test = Answer<MannWhitney>::none("not computed");
  Answer<Superiority> effect = Answer<Superiority>::none("not computed");
  Answer<double> shift = Answer<double>::none("not computed");
  Answer<ShiftInterval> shiftInterval = Answer<ShiftInterval>::none("not computed");
  std::optional<double> publishedExpert, publishedNovice;  ///< the paper's means, for reference
};

struct Study {
  std::string heading;     ///< "exploratory": there is no protocol
  bool synthetic = false;  ///< contains what performers made: watermarked everywhere
  std::array<std::string, 2> groups;
  std::array<std::uint64_t, 2> participants{}, attempts{};
  std::vector<std::string> keys;  ///< comparability keys of the attempts in it
  std::uint64_t recruited = 0;    ///< attempts in the database
  std::vector<FlowRow> flow;
  std::uint64_t analysed = 0;        ///< attempts
  std::vector<std::string> remarks;  ///< what a reader must know, whole sentences
  std::vector<StudyRow> rows;
  std::string publishedSource;  ///< of the paper's means
};

/// Two groups side by side. One value per participant: the mean over that participant's attempts; a performer's attempt
/// without participant counts as one synthetic participant. Practice, branches, goldens, excluded attempts, unfinished
/// recordings, technical failures and recordings that did not verify stay out, counted in the flow.
/// @throws Error 3 when there are not two groups, or when comparability keys or checkpoint versions would mix.
Study makeStudy(const CohortDatabase& database, const StudyOptions& options);

/// The same of attempts and values at hand: CohortDatabase::listAttempts() and allValues(). @param name of where they
/// are from, for errors
Study makeStudy(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                const StudyOptions& options, const std::string& name);

}  // namespace calot::analytics
