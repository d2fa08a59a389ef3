// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences of a study: its head, its protocol and methods, the meaning of its columns, and what is missing.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/ratings.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_population.h"
#include "analytics/report/study_rows.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

template <class Test>
bool any(const Study& study, Test test) {
  return std::any_of(study.rows.begin(), study.rows.end(), test);
}

void explainColumns(const Study& study, std::vector<std::string>& notes) {
  const std::string &a = study.groups[0], &b = study.groups[1];
  notes.emplace_back(
      "none: participants without a value. The interval of the shift is distribution-free, that of A the score "
      "interval; A is the area under the ROC curve. ~: p by normal approximation, else exact with ties. Without a "
      "direction of its own, a figure's A is that of the first group's values being larger.");
  const bool correlated = any(study, [](const StudyRow& r) { return static_cast<bool>(r.withDuration); });
  notes.push_back(
      fmt::format("g: Hedges, {} - {}, interval by non-central t, which assumes normal groups.{}", a, b,
                  correlated ? " rho: Spearman's correlation with the attempt's duration, over both groups." : ""));
  if (study.source == "cohort" && !correlated)
    notes.emplace_back("No correlation with the attempt's duration: durations are missing, too few, or all equal.");
  if (any(study, [](const StudyRow& r) { return r.unfinished[0] + r.unfinished[1] > 0; }))
    notes.emplace_back("*: has values of attempts that were not finished.");
  if (any(study, [](const StudyRow& r) { return r.simulation.has_value(); })) {
    notes.emplace_back(
        "Uncertainty of the simulation: each attempt was run again in smaller steps, with a finer mesh and with other "
        "assumed constants. half-width: of the values' intervals, their median. range of A: over these runs, in each "
        "of "
        "which all attempts have the same step, mesh and constants, and over what step and mesh are extrapolated to. "
        "decided: the same group is ahead in all of them. Figures that no simulation changes are left out.");
  }
  if (any(study, [](const StudyRow& r) { return r.adjusted.has_value(); })) {
    notes.push_back(fmt::format(
        "difference: {} - {} at one baseline, analysis of covariance with HC3 errors, Student's t; n: those "
        "with both. p, one slope: small where the difference depends on the baseline.",
        a, b));
  }
}

/// "no instrument in this hand"; of several kinds how many there are of each, and the commonest reason.
std::string whyMissing(const GroupSummary& s) {
  std::string kinds;
  for (std::size_t kind = 0; kind < s.missingOf.size(); ++kind) {
    if (s.missingOf[kind] == 0) continue;
    if (s.missingOf[kind] == s.missing) return s.missingReason;
    kinds +=
        fmt::format("{}{} {}", kinds.empty() ? "" : ", ", s.missingOf[kind], nameOf(static_cast<Availability>(kind)));
  }
  return fmt::format("{}; most: {}", kinds, s.missingReason);
}

/// Reason why a row has no value or an outcome no test; empty if there is one.
std::string untested(const StudyRow& row) {
  if (!hasNoValue(row)) return row.test || !row.notOutcome.empty() ? std::string() : "no test, " + row.test.reason();
  std::string why = row.group[0].missingReason;
  if (row.group[1].missingReason != why) why += (why.empty() ? "" : "; ") + row.group[1].missingReason;
  return fmt::format("no value in either group ({})", why);
}

/// The entry of a key, in the order in which keys came.
template <class Key, class Value>
Value& entryOf(std::vector<std::pair<Key, Value>>& entries, const Key& key) {
  const auto at = std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.first == key; });
  return at != entries.end() ? at->second : entries.emplace_back(key, Value()).second;
}

void addTo(std::string& names, const std::string& name) { names += (names.empty() ? "" : ", ") + name; }

/// Missing parts of one row, one line each.
void explainMissingOf(const Study& study, const StudyRow& row, std::vector<std::string>& notes) {
  const std::string name = rowName(row);
  if (const std::string reason = untested(row); !reason.empty()) notes.push_back(fmt::format("{}: {}", name, reason));
  if (hasNoValue(row)) return;
  if (row.brunnerMunzel && !study.unequalSpread)
    notes.push_back(fmt::format("{}: p {} by the test of Brunner and Munzel", name, pText(row.brunnerMunzel->p)));
  for (std::size_t g = 0; g < 2; ++g) {
    const GroupSummary& s = row.group[g];
    if (s.missing > 0) {
      notes.push_back(fmt::format("{}: {} of {} {} without a value ({})", name, s.missing, s.missing + s.n,
                                  study.groups[g], whyMissing(s)));
    }
    if (!row.worstRanked[g].empty()) {
      notes.push_back(
          fmt::format("{}: {} of these {} did not finish the attempt and rank behind all others in p "
                      "and A; shift and g are of the values alone",
                      name, row.worstRanked[g].size(), study.groups[g]));
    }
    if (s.partial > 0) {
      notes.push_back(fmt::format("{}: the mean of {} of {} {} lacks some of their {}", name, s.partial, s.n,
                                  study.groups[g], study.counted));
    }
    if (row.adjusted && row.adjusted->withoutBaseline[g] > 0) {
      notes.push_back(fmt::format("{}: {} of {} {} have no baseline", name, row.adjusted->withoutBaseline[g], s.n,
                                  study.groups[g]));
    }
  }
  if (row.adjusted && !row.adjusted->analysis)
    notes.push_back(fmt::format("{}: no analysis of covariance, {}", name, row.adjusted->analysis.reason()));
}

}  // namespace

std::vector<std::string> intervalWarnings(const Study& study, bool leading) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  std::size_t rows = 0;
  for (const StudyRow& row : study.rows) {
    if (row.leading != leading) continue;
    ++rows;
    for (const std::string& text : row.coverageWarnings) ++entryOf(counts, text);
  }
  // Intervals of which the same is to be said of as many rows share a line: "A, shift, g: ...".
  std::vector<std::pair<std::pair<std::string, std::size_t>, std::string>> shared;
  for (const auto& [text, count] : counts) {
    const std::size_t colon = text.find(": ");
    addTo(entryOf(shared, {text.substr(colon), count}), text.substr(0, colon));
  }
  std::vector<std::string> warnings;
  warnings.reserve(shared.size());
  for (const auto& [said, names] : shared)
    warnings.push_back(fmt::format("Warning ({} of {} rows): {}{}.", said.second, rows, names, said.first));
  return warnings;
}

void explainMissing(const Study& study, bool leading, std::vector<std::string>& notes) {
  std::vector<std::pair<std::string, std::string>> untestedRows;  // by what is said of them
  for (const StudyRow& row : study.rows) {
    if (row.leading != leading) continue;
    std::vector<std::string> own;
    explainMissingOf(study, row, own);
    if (own.size() == 1 && !untested(row).empty()) {
      addTo(entryOf(untestedRows, untested(row)), rowName(row));
    } else {
      notes.insert(notes.end(), own.begin(), own.end());
    }
  }
  for (const auto& [reason, names] : untestedRows) notes.push_back(fmt::format("{}: {}", names, reason));
}

std::vector<std::string> appendixNotes(const Study& study) {
  std::vector<std::string> notes;
  explainColumns(study, notes);
  if (any(study, [](const StudyRow& r) { return r.publishedExpert.has_value(); })) {
    notes.push_back(
        fmt::format("paper: published means of ten experts (E) and ten novices (N), for reference only ({}).",
                    study.publishedSource));
  }
  if (std::string note = coverageNote(study); !note.empty()) notes.push_back(std::move(note));
  for (std::string& warning : intervalWarnings(study, false)) notes.push_back(std::move(warning));
  explainMissing(study, false, notes);
  for (const FormReport& report : study.ratings) {
    for (std::string& note : ratingNotes(report)) notes.push_back(std::move(note));
  }
  return notes;
}

namespace {

std::string comparisons(const Study& study) {
  const bool exact = any(study, [](const StudyRow& r) { return r.attainableP && r.test->exact; });
  const bool normal = any(study, [](const StudyRow& r) { return r.attainableP && !r.test->exact; });
  if (!exact && !normal) return "Nothing was tested. ";
  return fmt::format("Groups were compared by the two-sided {}, {}. ",
                     study.unequalSpread ? "test of Brunner and Munzel" : "Mann-Whitney test",
                     exact && normal ? "exact with ties up to 80 values and by normal approximation beyond"
                     : exact         ? "exact with ties"
                                     : "by normal approximation with correction for ties and continuity");
}

std::string effects(const Study& study) {
  std::string text;
  if (any(study, [](const StudyRow& r) { return static_cast<bool>(r.area); }))
    text +=
        "The effect is the probability of superiority (A, the area under the ROC curve) with Newcombe's score interval "
        "at 95 %. ";
  if (any(study, [](const StudyRow& r) { return static_cast<bool>(r.shiftInterval); }))
    text += "The shift is that of Hodges and Lehmann with a distribution-free interval. ";
  if (any(study, [](const StudyRow& r) { return static_cast<bool>(r.hedges); }))
    text += "Hedges' g has an interval from the non-central t distribution. ";
  if (any(study, [](const StudyRow& r) { return static_cast<bool>(r.withDuration); }))
    text += "Correlation with the attempt's duration is Spearman's. ";
  if (any(study, [](const StudyRow& r) { return r.adjusted && r.adjusted->analysis; }))
    text += "Outcomes were compared at one baseline by analysis of covariance with HC3 errors. ";
  return text;
}

std::string missing(const Study& study) {
  std::uint64_t without = 0, worst = 0;
  for (const StudyRow& row : study.rows) {
    without += row.group[0].missing + row.group[1].missing;
    worst += row.worstRanked[0].size() + row.worstRanked[1].size();
  }
  if (without == 0) return "No value was missing. ";
  return fmt::format("{} values were missing over all figures; {}. ", without,
                     worst == 0
                         ? "who had none was left out of that figure"
                         : fmt::format("in {} of these cases, attempts that were not completed, the participant ranked "
                                       "behind all others, else was left out of that figure",
                                       worst));
}

/// Scripts that computed the external metrics.
std::string externalMetrics(const Study& study) {
  std::string list;
  for (const StudyRow& row : study.rows) {
    if (row.source.empty()) continue;
    list += fmt::format("{}{} version {} (SHA-256 {})", list.empty() ? "" : "; ", row.checkpoint,
                        fmt::join(row.versions, ", "), row.source);
  }
  return list.empty() ? list : fmt::format("External metrics are of scripts of the site: {}. ", list);
}

}  // namespace

std::string lockText(const StudyProtocol& protocol) {
  if (protocol.masked) return "Groups are masked until the analysis is locked.";
  if (!protocol.lock) return "The analysis is not locked.";
  const std::string changed = fmt::format("{}", fmt::join(protocol.lock->changed, ", "));
  return fmt::format("Analysis locked on {} by {}, after {} runs with named groups; {}.", protocol.lock->lockedUtc,
                     protocol.lock->by, protocol.runsBeforeLock,
                     changed.empty() ? "nothing has changed since" : "changed since: " + changed);
}

std::string registrationText(const Study& study) {
  if (!study.protocol)
    return "Exploratory, without a protocol: groups and figures may have been chosen after the data were seen.";
  const StudyProtocol& p = *study.protocol;
  const std::string protocol = fmt::format("protocol {} version {}", p.name, p.version);
  const std::string registered =
      p.whyExploratory.empty() ? fmt::format("Confirmatory: {} was registered on {}, before the first attempt ({}).",
                                             protocol, p.registeredUtc, p.firstAttemptUtc)
                               : fmt::format("Exploratory, by {}: {}.", protocol, p.whyExploratory);
  return registered + " " + lockText(p);
}

std::vector<std::string> protocolLines(const Study& study) {
  if (!study.protocol) return {};
  const StudyProtocol& p = *study.protocol;
  std::vector<std::string> lines{fmt::format("Protocol {} version {}: {}", p.name, p.version, p.title)};
  if (!p.question.empty()) lines.push_back(p.question);
  for (const auto& [what, text] : {std::pair("Ethics: ", &p.ethics),
                                   {"Registry: ", &p.registry},
                                   {"Sample size: ", &p.sampleSizeReason},
                                   {"Stopping rule: ", &p.stoppingRule}}) {
    if (!text->empty()) lines.push_back(what + *text);
  }
  lines.push_back(p.registeredUtc.empty()
                      ? fmt::format("SHA-256 {}, not registered.", p.sha256)
                      : fmt::format("SHA-256 {}, registered on {}; first attempt {}{}.", p.sha256, p.registeredUtc,
                                    p.firstAttemptUtc.empty() ? "at an unknown time" : p.firstAttemptUtc,
                                    p.starts.count("stated") > 0 ? ", as stated" : ""));
  if (p.masked || p.lock) lines.push_back(lockText(p));
  if (!p.whyExploratory.empty()) lines.push_back(fmt::format("Exploratory: {}.", p.whyExploratory));
  for (const ProtocolVersion& v : p.versions) {
    if (v.sha256 == p.sha256 && v.changed.empty()) continue;
    const std::string changed = fmt::format("{}", fmt::join(v.changed, ", "));
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
      text += fmt::format("{}: {}. ", study.groups[g], study.protocol->populations[g].definition);
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

namespace {

std::string dayOf(const std::string& utc) { return utc.substr(0, 10); }

std::string datesOf(const StudySetting& setting) {
  if (setting.firstStartUtc.empty()) return "The dates of the attempts are not known.";
  const std::string first = dayOf(setting.firstStartUtc), last = dayOf(setting.lastStartUtc);
  return first == last ? fmt::format("Attempts of {}.", first) : fmt::format("Attempts from {} to {}.", first, last);
}

/// States what was compared and that nothing else counts as an observation.
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
    for (const std::string& key : study.keys) lines.push_back(keySentence(key));
    lines.push_back(fmt::format("{} Cohort {}{}.", datesOf(study.setting), study.where,
                                study.cohort.empty() ? "" : fmt::format(", participants of \"{}\"", study.cohort)));
  }
  lines.push_back(unitLine(study));
  return lines;
}

}  // namespace calot::analytics
