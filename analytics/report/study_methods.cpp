// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences about the study as a whole: its protocol and its methods.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "analytics/report/study_tables.h"
#include "recorder/attempt.h"

namespace calot::analytics {
namespace {

template <class Test>
bool anyRow(const Study& study, Test test) {
  return std::any_of(study.rows.begin(), study.rows.end(), test);
}

std::string comparisons(const Study& study) {
  const bool exact = anyRow(study, [](const StudyRow& r) { return r.test && r.test->exact; });
  const bool normal = anyRow(study, [](const StudyRow& r) { return r.test && !r.test->exact; });
  if (!exact && !normal) return "No figure could be tested. ";
  return fmt::format("Groups were compared by the two-sided Mann-Whitney test, {}. ",
                     exact && normal ? "exact with ties up to 80 values and by normal approximation beyond"
                     : exact         ? "exact with ties"
                                     : "by normal approximation with correction for ties and continuity");
}

std::string effects(const Study& study) {
  std::string text;
  if (anyRow(study, [](const StudyRow& r) { return static_cast<bool>(r.area); }))
    text +=
        "The effect is the probability of superiority (A, the area under the ROC curve) with Newcombe's score interval "
        "at 95 %. ";
  if (anyRow(study, [](const StudyRow& r) { return static_cast<bool>(r.shiftInterval); }))
    text += "The shift is that of Hodges and Lehmann with a distribution-free interval. ";
  if (anyRow(study, [](const StudyRow& r) { return static_cast<bool>(r.hedges); }))
    text += "Hedges' g has an interval from the non-central t distribution. ";
  if (anyRow(study, [](const StudyRow& r) { return static_cast<bool>(r.withDuration); }))
    text += "Correlation with the attempt's duration is Spearman's. ";
  if (anyRow(study, [](const StudyRow& r) { return r.adjusted && r.adjusted->analysis; }))
    text += "Outcomes were compared at one baseline by analysis of covariance with HC3 errors. ";
  return text;
}

std::string missing(const Study& study) {
  std::uint64_t without = 0, worst = 0;
  for (const StudyRow& row : study.rows) {
    without += row.group[0].missing + row.group[1].missing;
    worst += row.worstRanked[0] + row.worstRanked[1];
  }
  if (without == 0) return "No value was missing. ";
  return fmt::format("{} values were missing over all figures; {}. ", without,
                     worst == 0
                         ? "who had none was left out of that figure"
                         : fmt::format("in {} of these cases, attempts that were not completed, the participant ranked "
                                       "behind all others, else was left out of that figure",
                                       worst));
}

/// Which scripts the figures of external metrics are of.
std::string externalMetrics(const Study& study) {
  std::string list;
  for (const StudyRow& row : study.rows) {
    if (row.source.empty()) continue;
    std::string versions;
    for (const std::uint32_t version : row.versions)
      versions += fmt::format("{}{}", versions.empty() ? "" : ", ", version);
    list += fmt::format("{}{} version {} (SHA-256 {})", list.empty() ? "" : "; ", row.checkpoint, versions, row.source);
  }
  return list.empty() ? list : fmt::format("External metrics are of scripts of the site: {}. ", list);
}

}  // namespace

std::string lockText(const StudyProtocol& protocol) {
  if (protocol.masked) return "Groups are masked until the analysis is locked.";
  if (!protocol.lock) return "The analysis is not locked.";
  std::string changed;
  for (const std::string& what : protocol.lock->changed) changed += (changed.empty() ? "" : ", ") + what;
  return fmt::format("Analysis locked on {} by {}; {}.", protocol.lock->lockedUtc, protocol.lock->by,
                     changed.empty() ? "nothing has changed since" : "changed since: " + changed);
}

std::vector<std::string> protocolLines(const Study& study) {
  if (!study.protocol) return {};
  const StudyProtocol& p = *study.protocol;
  std::vector<std::string> lines{fmt::format("Protocol {} version {}: {}", p.name, p.version, p.title)};
  if (!p.question.empty()) lines.push_back(p.question);
  lines.push_back(p.registeredUtc.empty()
                      ? fmt::format("SHA-256 {}, not registered.", p.sha256)
                      : fmt::format("SHA-256 {}, registered on {}; first attempt {}.", p.sha256, p.registeredUtc,
                                    p.firstAttemptUtc.empty() ? "at an unknown time" : p.firstAttemptUtc));
  if (p.masked || p.lock) lines.push_back(lockText(p));
  if (!p.whyExploratory.empty()) lines.push_back(fmt::format("Exploratory: {}.", p.whyExploratory));
  for (const ProtocolVersion& v : p.versions) {
    if (v.sha256 == p.sha256 && v.changed.empty()) continue;
    std::string changed;
    for (const std::string& place : v.changed) changed += (changed.empty() ? "" : ", ") + place;
    lines.push_back(fmt::format("Version {} was registered on {} by {}{}.", v.version, v.registeredUtc, v.by,
                                changed.empty() ? "" : "; changed from the version before: " + changed));
  }
  return lines;
}

std::string studyMethods(const Study& study) {
  std::string text = "Methods. ";
  if (study.protocol) {
    text += fmt::format("The study followed protocol {} version {}{}. ", study.protocol->name, study.protocol->version,
                        study.heading == "confirmatory" ? ", registered before the first attempt" : "");
    for (std::size_t g = 0; g < 2; ++g)
      text += fmt::format("{}: {}. ", study.groups[g], study.protocol->populations[g]);
  }
  if (study.synthetic) text += "Attempts were made by performers, which are programs. ";
  if (!study.cohort.empty())
    text += fmt::format("Of the cohort, participants of \"{}\" alone were taken. ", study.cohort);
  text +=
      fmt::format("Of {} {} in the {}, {} of {} {} and {} {} were analysed ({}); {} were left out. ", study.recruited,
                  study.counted, study.source, study.analysed, study.participants[0], study.groups[0],
                  study.participants[1], study.groups[1], study.attemptRule, study.recruited - study.analysed);
  text += comparisons(study) + externalMetrics(study) + effects(study) + missing(study);
  text += study.family;
  return text + fmt::format(" Quartiles are of type 7. Computed by {}.", recorder::softwareName());
}

}  // namespace calot::analytics
