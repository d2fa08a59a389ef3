// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study_protocol.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sodium.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_population.h"
#include "analytics/statistics/rank_tests.h"
#include "recorder/loop.h"
#include "sim/scene/version.h"

namespace calot::analytics {
namespace {

/// "2026-01-01T00:00:00": seconds are what both times have, and text orders them.
std::string instant(const std::string& utc) { return utc.substr(0, 19); }

bool matches(const DirectedHypothesis& h, const StudyRow& row) {
  return figureOf(h) == figureOfRow(row) && (h.sha256.empty() || h.sha256 == row.source);
}

/// Evidence that Calot holds: hash and time of the registration, the time of import, and a start within the chain of a
/// recording, which a station may have signed.
std::string whyExploratory(const StudyProtocol& protocol, const std::vector<const AttemptRow*>& data) {
  if (protocol.registeredUtc.empty()) return "the protocol is not registered in this cohort (calot protocol register)";
  const std::string registered = instant(protocol.registeredUtc);
  if (protocol.starts.count("unknown") > 0)
    return "the start of an attempt is not known, so nothing shows that the protocol came first";
  if (instant(protocol.firstAttemptUtc) <= registered) {
    return fmt::format("the protocol was registered on {}, the first attempt is of {}", protocol.registeredUtc,
                       protocol.firstAttemptUtc);
  }
  for (const AttemptRow* a : data) {
    if (instant(a->importedUtc) < registered || instant(a->importedUtc) < instant(a->startUtc))
      return fmt::format(
          "attempt {} came into the cohort on {}, before it started or before the protocol was registered", a->uuid,
          a->importedUtc);
  }
  const auto stated = protocol.starts.find("stated");
  if (stated == protocol.starts.end()) return {};
  return fmt::format(
      "the start of {} of {} attempts is stated, not recorded, so nothing shows that the protocol came "
      "first",
      stated->second, data.size());
}

void listVersions(StudyProtocol& report, const std::vector<RegisteredProtocol>& registered) {
  const RegisteredProtocol* before = nullptr;
  for (const RegisteredProtocol& r : registered) {
    report.versions.push_back({r.version, r.sha256, r.registeredUtc, r.by,
                               before == nullptr ? std::vector<std::string>{} : changedPlaces(before->text, r.text)});
    before = &r;
  }
}

/// Exclusions by hand for reasons that the protocol does not name; keys chosen or mixed.
void listDeviations(StudyProtocol& report, const Study& study, const std::vector<const AttemptRow*>& data,
                    const StudyOptions& options) {
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
  const Protocol& protocol = options.protocol->protocol;
  for (std::size_t g = 0; g < 2; ++g) {
    const std::uint32_t planned = protocol.populations[g].planned;
    if (planned > 0 && planned != study.participants[g])
      report.deviations.push_back(fmt::format("{} {} were planned and {} are analysed.", planned,
                                              protocol.populations[g].group, study.participants[g]));
  }
  if (!protocol.covariates.empty())
    report.deviations.push_back(fmt::format("The comparison is not adjusted for the declared covariates: {}.",
                                            fmt::join(protocol.covariates, ", ")));
  if (options.mixKeys) report.deviations.emplace_back("Comparability keys or checkpoint versions were allowed to mix.");
}

/// Puts the adjusted p of `p` into the rows by `put`.
template <class Put>
void spread(const Expected<std::vector<double>>& adjusted, const std::vector<StudyRow*>& rows, Put put) {
  for (std::size_t i = 0; adjusted && i < rows.size(); ++i) put(*rows[i], (*adjusted)[i]);
}

}  // namespace

std::string nameOf(Role role) {
  constexpr const char* names[] = {"", "primary", "secondary", "exploratory"};
  return names[static_cast<std::size_t>(role)];
}

void chooseByProtocol(StudyChoices& choices, const Protocol& protocol) {
  choices.groups = {protocol.populations[0].group, protocol.populations[1].group};
  choices.better = protocol.better;
  choices.attemptRule = protocol.attemptRule;
  choices.unequalSpread = protocol.unequalSpread;
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

namespace {

std::string sceneOf(const AttemptRow& attempt) { return fmt::format("{}/{}", attempt.scene, attempt.sceneMajor); }

}  // namespace

std::size_t attemptsUnder(const Protocol& protocol, const std::vector<AttemptRow>& attempts) {
  return static_cast<std::size_t>(std::count_if(attempts.begin(), attempts.end(), [&](const AttemptRow& a) {
    const std::string group = groupOf(a, protocol.performers ? Grouping::performer : Grouping::group);
    return (protocol.scene.empty() || protocol.scene == sceneOf(a)) &&
           (group == protocol.populations[0].group || group == protocol.populations[1].group);
  }));
}

std::string whyOutByProtocol(const AttemptRow& attempt, const std::string& group, const ProtocolInUse& use) {
  static const std::map<std::string, std::string> nothing;
  const Protocol& protocol = use.protocol;
  if (const std::string scene = sceneOf(attempt); !protocol.scene.empty() && protocol.scene != scene)
    return fmt::format("{}: {} in place of {}", protocolReasons()[0], scene, protocol.scene);
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
  StudyProtocol report{protocol};
  for (const RegisteredProtocol& r : options.protocol->registered) {
    if (r.sha256 == protocol.sha256 && r.withdrawnUtc.empty()) report.registeredUtc = r.registeredUtc;
  }
  for (const AttemptRow* a : data) {
    ++report.starts[startEvidence(*a)];
    if (a->startUtc.empty()) continue;
    if (report.firstAttemptUtc.empty() || a->startUtc < report.firstAttemptUtc) report.firstAttemptUtc = a->startUtc;
  }
  listVersions(report, options.protocol->registered);
  listDeviations(report, study, data, options);
  report.masked = options.masked;
  report.whyExploratory = whyExploratory(report, data);
  study.heading = report.whyExploratory.empty() ? "confirmatory" : "exploratory";
  study.protocol = std::move(report);
}

void describeProtocolOfTable(Study& study, const Protocol& protocol) {
  StudyProtocol report{protocol};
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
    if (study.protocol->masked) continue;
    row.claim = h.claim;
    row.margin = h.margin;
    row.hypothesis = h.larger == study.groups[0] ? Hypothesis::firstLarger : Hypothesis::firstSmaller;
  }
}

namespace {

/// No test where somebody did not complete, who has no value to shift by the margin.
Expected<double> marginTestOf(const StudyRow& row) {
  if (!row.worstRanked[0].empty() || !row.worstRanked[1].empty()) return NoResult{"participants did not complete"};
  const std::size_t larger = row.hypothesis == Hypothesis::firstLarger ? 0 : 1;
  return marginTest(row.values[larger], row.values[1 - larger], *row.margin, row.claim == Claim::equivalence);
}

/// Answer to a claim with a margin.
std::string marginSentence(const Study& study, const StudyRow& row) {
  const std::size_t larger = row.hypothesis == Hypothesis::firstLarger ? 0 : 1;
  const std::optional<double>& adjusted = row.role == Role::primary ? row.holm : row.benjaminiHochberg;
  return fmt::format("{}: {}{} within {:g} {} is {} ({}).", figureOfRow(row), nameOf(row.claim),
                     row.claim == Claim::equivalence ? "" : fmt::format(" of {}", study.groups[larger]), *row.margin,
                     row.unit, row.supported.value_or(false) ? "shown" : "not shown",
                     row.marginP && adjusted
                         ? fmt::format("one-sided p {}, adjusted {}", pText(*row.marginP), pText(*adjusted))
                         : "no test, " + row.marginP.reason());
}

}  // namespace

void adjustByProtocol(Study& study, const Protocol& protocol) {
  std::vector<double> family, rest, smallestOfFamily, smallestOfRest;
  std::vector<StudyRow*> primary, others;
  for (StudyRow& row : study.rows) {
    if (row.role == Role::exploratory) continue;
    if (row.margin) row.marginP = marginTestOf(row);
    if (row.margin ? !row.marginP : !row.test) continue;
    const bool isPrimary = row.role == Role::primary;
    (isPrimary ? primary : others).push_back(&row);
    (isPrimary ? family : rest).push_back(row.margin ? *row.marginP : row.test->p);
    (isPrimary ? smallestOfFamily : smallestOfRest)
        .push_back(row.margin ? 0.5 * smallestRankTestP(row.values[0].size(), row.values[1].size())
                              : row.test->smallestP);
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
    if (p) row.supported = *p <= protocol.level && (row.margin || row.asHypothesised.value_or(false));
  }
  for (const StudyRow& row : study.rows) {
    if (row.margin) study.remarks.push_back(marginSentence(study, row));
  }
  for (const DirectedHypothesis& h : protocol.hypotheses) {
    if (std::any_of(study.rows.begin(), study.rows.end(), [&](const StudyRow& r) { return matches(h, r); })) continue;
    study.remarks.push_back(fmt::format("{} {}{}, of which the protocol has a {} hypothesis.",
                                        study.source == "table" ? "No outcome is" : "No attempt has", figureOf(h),
                                        h.sha256.empty() ? "" : " of the script with SHA-256 " + h.sha256,
                                        h.primary ? "primary" : "secondary"));
  }
  study.family = fmt::format(
      "Holm: adjusted over the {} primary hypotheses of the protocol{}.{} Exploratory figures have no p.", declared,
      untested == 0 ? "" : fmt::format(" ({} without a test: counted as p = 1)", untested),
      rest.empty() ? ""
                   : fmt::format(" BH: Benjamini-Hochberg over the {} tests of secondary hypotheses.", rest.size()));
}

namespace {

constexpr const char* maskedNames[] = {"group 1", "group 2"};
constexpr const char* untilLocked = "masked until the analysis is locked";

/// The masked name of a group; another group is of no study.
std::string maskedName(const std::string& group, const Protocol& protocol, bool swapped) {
  for (std::size_t g = 0; g < 2; ++g) {
    if (protocol.populations[g].group == group) return maskedNames[(g == 0) == swapped ? 1 : 0];
  }
  return group.empty() ? group : "another";
}

StudyOptions maskedOptions(const StudyOptions& options, bool swapped) {
  StudyOptions masked = options;
  Protocol& protocol = masked.protocol->protocol;
  if (swapped) std::swap(protocol.populations[0], protocol.populations[1]);
  for (std::size_t g = 0; g < 2; ++g) {
    protocol.populations[g].group = maskedNames[g];
    protocol.populations[g].definition = untilLocked;
  }
  protocol.better.clear();
  for (DirectedHypothesis& h : protocol.hypotheses) h.larger.clear();
  masked.masked = true;
  return masked;
}

/// Notes in the study when its analysis was locked, and what has changed since.
void describeLock(Study& study, const AnalysisLock& lock, const AnalysisLock& now) {
  StudyLock& told = study.protocol->lock.emplace();
  told.lockedUtc = lock.lockedUtc;
  told.by = lock.by;
  if (lock.valuesSha256 != now.valuesSha256) told.changed.emplace_back("data");
  if (lock.options != now.options) told.changed.emplace_back("options");
  if (lock.software != now.software)
    told.changed.push_back(fmt::format("software ({}, now {})", lock.software, now.software));
}

}  // namespace

Study makeMaskedStudy(const CohortDatabase& database, const StudyOptions& options, bool swapped,
                      const StudyProgress& progress) {
  const Protocol& protocol = options.protocol->protocol;
  StudyOptions masked = withCohortData(database, maskedOptions(options, swapped));
  std::vector<AttemptRow> attempts = database.listAttempts();
  for (AttemptRow& a : attempts) {
    std::string& group = protocol.performers ? a.profile : a.group;
    group = maskedName(group, protocol, swapped);
  }
  for (Participant& p : masked.people) p.group = maskedName(p.group, protocol, swapped);
  Study study = makeStudy(attempts, database.allValues(), masked, database.path(), progress);
  addRatings(study, database);
  for (StudyRow& row : study.rows) {
    row.publishedExpert = row.publishedNovice = std::nullopt;
    for (auto& people : row.participants) {
      for (std::size_t i = 0; i < people.size(); ++i) people[i] = fmt::format("{:05d}", i + 1);
    }
  }
  study.publishedSource.clear();
  study.people.clear();  // experience and site would name the groups
  study.remarks.emplace_back(
      "Groups are masked: their names are drawn, and directions, verdicts and published values are left out until the "
      "analysis is locked (calot protocol lock). The groups' sizes remain and may tell them apart.");
  if (protocol.missing == MissingRule::worstRank)
    study.remarks.emplace_back("Who did not complete is ranked behind all others only once directions are shown.");
  return study;
}

std::string analysisOptions(const StudyOptions& options) {
  return fmt::format("cohort: {}\nkey: {}\nmixed keys: {}\nphases: {}\n",
                     options.cohort ? options.cohort->name : "all participants",
                     options.key.empty() ? "any" : options.key, options.mixKeys ? "yes" : "no",
                     options.includePhases ? "all" : "durations");
}

AnalysisLock presentAnalysis(const CohortDatabase& database, const StudyOptions& options) {
  const Protocol& protocol = options.protocol->protocol;
  return {protocol.sha256,
          fmt::format("{} version {}", protocol.name, protocol.version),
          analysisOptions(options),
          analysisDigest(database),
          fmt::format("{}, simulation version {}", recorder::softwareName(), simulationVersion),
          "",
          ""};
}

Study makeProtocolStudy(const CohortDatabase& database, const StudyOptions& options, bool masked,
                        const StudyProgress& progress) {
  const std::string& path = database.path();
  const std::string& sha256 = options.protocol->protocol.sha256;
  const std::optional<AnalysisLock> lock = readAnalysisLock(path, sha256);
  if (!lock) {
    const std::optional<bool> drawn = readGroupMask(path, sha256);
    if (drawn || masked)
      return makeMaskedStudy(database, options, drawn ? *drawn : drawGroupMask(path, sha256), progress);
  }
  Study study = makeStudy(database, options, progress);
  addRatings(study, database);
  if (lock) describeLock(study, *lock, presentAnalysis(database, options));
  try {
    study.protocol->runsBeforeLock =
        studyRuns(path, sha256, lock ? "" : study.heading + "\n" + analysisOptions(options));
  } catch (const Error& e) {
    study.remarks.push_back(fmt::format("This run before the lock could not be noted in the audit: {}.", e.fault()));
  }
  return study;
}

namespace {

/// Each cell behind its length: no two lists of cells give the same bytes.
void hashCell(crypto_hash_sha256_state& state, const std::string& text) {
  std::array<unsigned char, 8> size{};
  for (std::size_t i = 0; i < size.size(); ++i)
    size[i] = static_cast<unsigned char>(std::uint64_t{text.size()} >> (8 * i));
  crypto_hash_sha256_update(&state, size.data(), size.size());
  crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(text.data()), text.size());
}

}  // namespace

std::string analysisDigest(const CohortDatabase& database) {
  [[maybe_unused]] static const int ready = sodium_init();
  crypto_hash_sha256_state state{};
  crypto_hash_sha256_init(&state);
  const auto add = [&](const auto&... cells) { (hashCell(state, fmt::format("{}", cells)), ...); };
  for (const AttemptRow& a : database.listAttempts()) {
    add(a.uuid, a.participant, a.group, a.profile, a.startUtc, a.comparabilityKey, static_cast<int>(a.outcome),
        static_cast<int>(a.mode), static_cast<int>(a.verification.verdict), a.complete, a.excluded, a.exclusionReason);
    for (const LeftOut& out : a.leftOut) {
      if (out.rule == "consent") add(out.rule);  // the other rules follow from the cells above
    }
  }
  for (const Participant& p : database.participants()) {
    add(p.pseudonym, p.group, p.experience.size());
    for (const auto& [criterion, value] : p.experience) add(criterion, value);
  }
  database.eachValue({}, [&](const AttemptValue& item) {
    const CheckpointValue& v = item.value;
    // Shortest digits that give the same double again.
    add(item.attempt, v.name, v.subject, v.version, static_cast<int>(v.availability),
        v.value ? fmt::format("{}", *v.value) : std::string());
  });
  for (const Rating& r : database.ratings()) {
    add(r.form, r.formVersion, r.attempt, r.rater, r.participant, r.answers.size());
    for (const auto& [item, score] : r.answers) add(item, score);
  }
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256_final(&state, digest.data());
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

}  // namespace calot::analytics
