// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "analytics/report/study_output.h"
#include "analytics/statistics/rank_tests.h"

namespace calot::analytics {
namespace {

/// "2026-01-01T00:00:00": seconds are what both times have, and text orders them.
std::string instant(const std::string& utc) { return utc.substr(0, 19); }

bool matches(const DirectedHypothesis& h, const StudyRow& row) {
  return figureOf(h) == figureOfRow(row) && (h.sha256.empty() || h.sha256 == row.source);
}

std::string whyExploratory(const StudyProtocol& protocol, bool unknownStart) {
  if (protocol.registeredUtc.empty()) return "the protocol is not registered in this cohort (calot protocol register)";
  if (unknownStart) return "the start of an attempt is not known, so nothing shows that the protocol came first";
  if (instant(protocol.firstAttemptUtc) > instant(protocol.registeredUtc)) return {};
  return fmt::format("the protocol was registered on {}, the first attempt is of {}", protocol.registeredUtc,
                     protocol.firstAttemptUtc);
}

void listVersions(StudyProtocol& report, const std::vector<RegisteredProtocol>& registered) {
  const RegisteredProtocol* before = nullptr;
  for (const RegisteredProtocol& r : registered) {
    report.versions.push_back({r.version, r.sha256, r.registeredUtc, r.by,
                               before == nullptr ? std::vector<std::string>{} : changedPlaces(before->text, r.text)});
    before = &r;
  }
}

StudyProtocol headOf(const Protocol& protocol) {
  StudyProtocol report;
  report.name = protocol.name;
  report.title = protocol.title;
  report.question = protocol.question;
  report.version = protocol.version;
  report.sha256 = protocol.sha256;
  report.level = protocol.level;
  report.missing = protocol.missing;
  report.populations = {protocol.populations[0].definition, protocol.populations[1].definition};
  return report;
}

/// Exclusions by hand for reasons that the protocol does not name; keys chosen or mixed.
void listDeviations(StudyProtocol& report, const std::vector<const AttemptRow*>& data, const StudyOptions& options) {
  const std::vector<std::string>& allowed = options.protocol->protocol.exclusionReasons;
  for (const AttemptRow* a : data) {
    // The database answers with "REASON (WHO)".
    const bool named = std::any_of(allowed.begin(), allowed.end(),
                                   [&](const std::string& reason) { return a->exclusionReason.rfind(reason, 0) == 0; });
    if (a->excluded && !named) {
      report.deviations.push_back(
          fmt::format("Attempt {} was excluded by hand for a reason that the protocol does not "
                      "name: {}.",
                      a->uuid, a->exclusionReason));
    }
  }
  if (options.cohort)
    report.deviations.push_back(
        fmt::format("Only participants of the named cohort \"{}\" were taken.", options.cohort->name));
  if (!options.key.empty())
    report.deviations.push_back(fmt::format("Only attempts of the key \"{}\" were taken.", options.key));
  if (options.mixKeys) report.deviations.emplace_back("Comparability keys or checkpoint versions were allowed to mix.");
}

/// Puts the adjusted p of `p` into the rows by `put`.
template <class Put>
void spread(const Expected<std::vector<double>>& adjusted, const std::vector<StudyRow*>& rows, Put put) {
  for (std::size_t i = 0; adjusted && i < rows.size(); ++i) put(*rows[i], (*adjusted)[i]);
}

}  // namespace

std::string nameOf(Role role) {
  switch (role) {
    case Role::undeclared:
      return "";
    case Role::primary:
      return "primary";
    case Role::secondary:
      return "secondary";
    case Role::exploratory:
      return "exploratory";
  }
  return "";
}

void chooseByProtocol(StudyChoices& choices, const Protocol& protocol) {
  choices.groups = {protocol.populations[0].group, protocol.populations[1].group};
  choices.better = protocol.better;
  choices.attemptRule = protocol.attemptRule;
  choices.family.clear();
}

std::string figureOf(const DirectedHypothesis& h) { return figureName(h.checkpoint, h.subject); }

StudyOptions byProtocol(const StudyOptions& options) {
  StudyOptions chosen = options;
  const Protocol& protocol = options.protocol->protocol;
  chooseByProtocol(chosen, protocol);
  chosen.grouping = protocol.performers ? Grouping::performer : Grouping::group;
  chosen.includeSynthetic = protocol.performers;
  chosen.includePractice = chosen.includeBranches = false;
  return chosen;
}

const std::vector<std::string>& protocolReasons() {
  static const std::vector<std::string> reasons{"another scene than the protocol's",
                                                "ended in a way that the protocol excludes",
                                                "outside of the protocol's population"};
  return reasons;
}

std::string whyOutByProtocol(const AttemptRow& attempt, const std::string& group, const ProtocolInUse& use) {
  static const std::map<std::string, std::string> nothing;
  const Protocol& protocol = use.protocol;
  if (!protocol.scene.empty() && protocol.scene != fmt::format("{}/{}", attempt.scene, attempt.sceneMajor))
    return protocolReasons()[0];
  const auto& outcomes = protocol.excludedOutcomes;
  if (std::find(outcomes.begin(), outcomes.end(), attempt.outcome) != outcomes.end()) return protocolReasons()[1];
  const auto experience = use.experience.find(attempt.participant);
  for (const Population& population : protocol.populations) {
    const auto& known = experience == use.experience.end() ? nothing : experience->second;
    if (population.group == group && !whyOutside(population, known).empty()) return protocolReasons()[2];
  }
  return {};
}

void describeProtocol(Study& study, const std::vector<const AttemptRow*>& data, const StudyOptions& options) {
  const Protocol& protocol = options.protocol->protocol;
  StudyProtocol report = headOf(protocol);
  for (const RegisteredProtocol& r : options.protocol->registered) {
    if (r.sha256 == protocol.sha256) report.registeredUtc = r.registeredUtc;
  }
  bool unknownStart = false;
  for (const AttemptRow* a : data) {
    unknownStart = unknownStart || a->startUtc.empty();
    if (a->startUtc.empty()) continue;
    if (report.firstAttemptUtc.empty() || a->startUtc < report.firstAttemptUtc) report.firstAttemptUtc = a->startUtc;
  }
  listVersions(report, options.protocol->registered);
  listDeviations(report, data, options);
  report.masked = options.masked;
  report.whyExploratory = whyExploratory(report, unknownStart);
  study.heading = report.whyExploratory.empty() ? "confirmatory" : "exploratory";
  study.protocol = std::move(report);
}

void describeProtocolOfTable(Study& study, const Protocol& protocol) {
  StudyProtocol report = headOf(protocol);
  report.whyExploratory =
      "a table does not say when its figures came about, so nothing shows that the protocol came first";
  const auto notApplied = [&](bool declared, const char* what) {
    if (declared) report.deviations.push_back(fmt::format("{} could not be applied: a table does not tell.", what));
  };
  notApplied(!protocol.scene.empty(), "The scene that the protocol asks for");
  notApplied(!protocol.excludedOutcomes.empty(), "The exclusion of attempts by how they ended");
  notApplied(!protocol.populations[0].criteria.empty() || !protocol.populations[1].criteria.empty(),
             "The populations' criteria of experience");
  notApplied(protocol.missing == MissingRule::worstRank, "Ranking those who did not complete behind all others");
  study.heading = "exploratory";
  study.protocol = std::move(report);
}

void declareRow(StudyRow& row, const Study& study, const Protocol& protocol) {
  row.role = Role::exploratory;
  for (const DirectedHypothesis& h : protocol.hypotheses) {
    if (!matches(h, row)) continue;
    row.role = h.primary ? Role::primary : Role::secondary;
    if (!study.protocol->masked)
      row.hypothesis = h.larger == study.groups[0] ? Hypothesis::firstLarger : Hypothesis::firstSmaller;
  }
}

void adjustByProtocol(Study& study, const Protocol& protocol) {
  std::vector<double> family, rest, smallestOfFamily, smallestOfRest;
  std::vector<StudyRow*> primary, others;
  for (StudyRow& row : study.rows) {
    if (!row.test) continue;
    const bool isPrimary = row.role == Role::primary;
    (isPrimary ? primary : others).push_back(&row);
    (isPrimary ? family : rest).push_back(row.test->p);
    (isPrimary ? smallestOfFamily : smallestOfRest).push_back(row.test->smallestP);
  }
  const auto declared = static_cast<std::size_t>(
      std::count_if(protocol.hypotheses.begin(), protocol.hypotheses.end(), [](const auto& h) { return h.primary; }));
  const std::size_t untested = declared - family.size();
  family.resize(declared, 1.0);
  smallestOfFamily.resize(declared, 1.0);
  spread(holm(family), primary, [](StudyRow& row, double p) { row.holm = p; });
  spread(benjaminiHochberg(rest), others, [](StudyRow& row, double p) { row.benjaminiHochberg = p; });
  // Both adjustments rise with each p: the smallest p of all tests give the smallest adjusted ones.
  const auto putAttainable = [](StudyRow& row, double p) { row.attainableP = p; };
  spread(holm(smallestOfFamily), primary, putAttainable);
  spread(benjaminiHochberg(smallestOfRest), others, putAttainable);
  for (StudyRow& row : study.rows) {
    if (row.role != Role::primary && row.role != Role::secondary) continue;
    if (study.protocol->masked || isOutOfReach(row, protocol.level)) continue;
    const std::optional<double>& p = row.role == Role::primary ? row.holm : row.benjaminiHochberg;
    if (p) row.supported = *p <= protocol.level && row.asHypothesised.value_or(false);
  }
  for (const DirectedHypothesis& h : protocol.hypotheses) {
    const bool there =
        std::any_of(study.rows.begin(), study.rows.end(), [&](const StudyRow& r) { return matches(h, r); });
    if (there) continue;
    study.remarks.push_back(fmt::format("{} {}{}, of which the protocol has a {} hypothesis.",
                                        study.source == "table" ? "No outcome is" : "No attempt has", figureOf(h),
                                        h.sha256.empty() ? "" : " of the script with SHA-256 " + h.sha256,
                                        h.primary ? "primary" : "secondary"));
  }
  study.family = fmt::format(
      "Holm: adjusted over the {} primary hypotheses of the protocol{}. BH: Benjamini-Hochberg over the "
      "{} other rank tests, of secondary hypotheses and exploratory figures.",
      declared, untested == 0 ? "" : fmt::format(" ({} without a test: counted as p = 1)", untested), rest.size());
}

}  // namespace calot::analytics
