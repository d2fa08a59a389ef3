// SPDX-License-Identifier: GPL-3.0-or-later
// Under a study's title: what was done, on what, when, and what counts as one observation.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

std::string dayOf(const std::string& utc) { return utc.substr(0, 10); }

std::string datesOf(const StudySetting& setting) {
  if (setting.firstStartUtc.empty()) return "The dates of the attempts are not known.";
  const std::string first = dayOf(setting.firstStartUtc), last = dayOf(setting.lastStartUtc);
  return first == last ? fmt::format("Attempts of {}.", first) : fmt::format("Attempts from {} to {}.", first, last);
}

/// What was compared, and that nothing else counts as an observation.
std::string unitLine(const Study& study) {
  return fmt::format("Unit of analysis: the participant ({}); {} {} and {} {}.", study.attemptRule,
                     study.participants[0], study.groups[0], study.participants[1], study.groups[1]);
}

}  // namespace

std::vector<std::string> studyHead(const Study& study) {
  std::vector<std::string> lines = protocolLines(study);
  if (study.source == "table") {
    lines.push_back(fmt::format("Table {}.", study.where));
  } else {
    for (const std::string& key : study.keys) {
      std::string words = comparabilityWords(key);
      if (!words.empty() && words[0] == 't') words[0] = 'T';
      lines.push_back(words + ".");
    }
    lines.push_back(fmt::format("{} Cohort {}{}.", datesOf(study.setting), study.where,
                                study.cohort.empty() ? "" : fmt::format(", participants of \"{}\"", study.cohort)));
  }
  lines.push_back(unitLine(study));
  return lines;
}

}  // namespace calot::analytics
