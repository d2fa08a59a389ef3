// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_population.h"

#include <fmt/format.h>

#include "analytics/checkpoints/registry.h"
#include "analytics/cohort/registers.h"
#include "analytics/report/study_protocol.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

const std::vector<std::string>& exclusionReasons() {
  static const std::vector<std::string> reasons{"not in the named cohort",
                                                "withdrawn from research",
                                                "excluded by hand",
                                                "recording diverged or damaged",
                                                "not verified yet",
                                                "recording incomplete",
                                                "technical failure",
                                                "synthetic (performer)",
                                                "practice",
                                                "branch of another attempt",
                                                "golden recording",
                                                "no group",
                                                "not comparable (another key)"};
  return reasons;
}

}  // namespace

std::string groupOf(const AttemptRow& a, Grouping grouping) {
  if (grouping == Grouping::group) return a.group;
  return a.operatorKind == recorder::OperatorKind::performer ? a.profile : "";
}

std::string whyOut(const AttemptRow& a, const StudyOptions& options) {
  const std::vector<std::string>& reason = exclusionReasons();
  if (options.cohort && options.cohort->participants.count(a.participant) == 0)
    return reason[0] + ": " + options.cohort->name;
  if (a.withdrawn) return reason[1];
  if (a.excluded) return reason[2] + ": " + a.exclusionReason;
  if (a.verification.verdict == Verdict::diverged || a.verification.verdict == Verdict::damaged) return reason[3];
  if (a.verification.verdict == Verdict::notChecked) return reason[4];
  if (!a.complete || a.outcome == recorder::Outcome::running) return reason[5];
  if (a.outcome == recorder::Outcome::technicalFailure) return reason[6];
  if (a.synthetic && !options.includeSynthetic) return reason[7];
  if (a.mode == recorder::Mode::practice && !options.includePractice) return reason[8];
  if (!a.parent.empty() && !options.includeBranches) return reason[9];
  if (a.purpose == "golden") return reason[10];
  if (groupOf(a, options.grouping).empty()) return reason[11];
  if (options.protocol) {
    if (std::string why = whyOutByProtocol(a, groupOf(a, options.grouping), *options.protocol); !why.empty())
      return why;
  }
  if (!options.key.empty() && a.comparabilityKey != options.key) return reason[12];
  return {};
}

std::string unitOf(const AttemptRow& a) { return a.participant.empty() ? "attempt " + a.uuid : a.participant; }

std::vector<FlowRow> flowOf(const std::map<std::string, std::uint64_t>& counted) {
  std::vector<FlowRow> flow;
  for (const std::string& reason : exclusionReasons()) {
    for (const auto& [why, count] : counted) {
      if (why == reason || why.rfind(reason + ": ", 0) == 0) flow.push_back({why, count});
    }
  }
  for (const std::string& reason : protocolReasons()) {
    if (const auto at = counted.find(reason); at != counted.end()) flow.push_back({reason, at->second});
  }
  return flow;
}

void askForOneKey(const std::vector<std::string>& keys, const StudyOptions& options, const std::string& name,
                  std::vector<std::string>& remarks) {
  if (keys.size() < 2) return;
  if (!options.mixKeys) {
    std::string list;
    for (const auto& key : keys) list += (list.empty() ? "" : "; ") + key;
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("the attempts don't compare, they have {} comparability keys ({})", keys.size(), list),
                {Remedy::chooseKey, Remedy::mixKeys});
  }
  remarks.push_back(
      fmt::format("Attempts of {} comparability keys are mixed, as asked: differences between groups may be "
                  "differences of scene, device or version.",
                  keys.size()));
}

std::vector<std::string> unaskedPhases(const StudyOptions& options) {
  std::vector<std::string> unasked;
  if (options.includePhases) return unasked;
  std::set<std::string> asked(options.family.begin(), options.family.end());
  if (options.protocol) {
    for (const DirectedHypothesis& h : options.protocol->protocol.hypotheses) asked.insert(h.checkpoint);
  }
  for (const std::string& name : phaseCheckpoints()) {
    if (asked.count(name) == 0 && name != phaseDurationName) unasked.push_back(name);
  }
  return unasked;
}

std::set<std::string> participantsOf(const std::string& path, const std::string& cohort) {
  std::string list;
  for (const NamedCohort& c : readRegisters(path).cohorts) {
    if (c.name == cohort) return {c.participants.begin(), c.participants.end()};
    list += (list.empty() ? "" : ", ") + c.name;
  }
  throw Error(
      ErrorKind::invalid, Where{path},
      fmt::format("there is no cohort \"{}\" (there are: {})", recorder::shown(cohort), list.empty() ? "none" : list),
      {Remedy::nameCohort});
}

}  // namespace calot::analytics
