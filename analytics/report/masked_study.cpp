// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/masked_study.h"

#include <fmt/format.h>
#include <sodium.h>
#include <array>
#include <cstdint>
#include <utility>

#include "recorder/attempt.h"
#include "recorder/base/file_bytes.h"
#include "sim/scene/version.h"

namespace calot::analytics {
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

Study makeMaskedStudy(const CohortDatabase& database, const AssessmentDatabase& assessment, const StudyOptions& options,
                      bool swapped, const StudyProgress& progress) {
  const Protocol& protocol = options.protocol->protocol;
  StudyOptions masked = withCohortData(database, maskedOptions(options, swapped));
  std::vector<AttemptRow> attempts = database.listAttempts();
  for (AttemptRow& a : attempts) {
    std::string& group = protocol.performers ? a.profile : a.group;
    group = maskedName(group, protocol, swapped);
  }
  Study study = makeStudy(attempts, database.allValues(), masked, database.path(), progress);
  addRatings(study, assessment);
  for (StudyRow& row : study.rows) {
    row.publishedExpert = row.publishedNovice = std::nullopt;
    for (auto& people : row.participants) {
      for (std::size_t i = 0; i < people.size(); ++i) people[i] = fmt::format("{:05d}", i + 1);
    }
  }
  study.publishedSource.clear();
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

AnalysisLock presentAnalysis(const CohortDatabase& database, const AssessmentDatabase& assessment,
                             const StudyOptions& options) {
  const Protocol& protocol = options.protocol->protocol;
  return {protocol.sha256,
          fmt::format("{} version {}", protocol.name, protocol.version),
          analysisOptions(options),
          analysisDigest(database, assessment),
          fmt::format("{}, simulation version {}", recorder::softwareName(), simulationVersion),
          "",
          ""};
}

Study makeProtocolStudy(const CohortDatabase& database, const AssessmentDatabase& assessment,
                        const StudyOptions& options, bool masked, const StudyProgress& progress) {
  const std::string& path = database.path();
  const std::string& sha256 = options.protocol->protocol.sha256;
  const std::optional<AnalysisLock> lock = readAnalysisLock(path, sha256);
  if (!lock) {
    const std::optional<bool> drawn = readGroupMask(path, sha256);
    if (drawn || masked)
      return makeMaskedStudy(database, assessment, options, drawn ? *drawn : drawGroupMask(path, sha256), progress);
  }
  Study study = makeStudy(database, options, progress);
  addRatings(study, assessment);
  if (lock) describeLock(study, *lock, presentAnalysis(database, assessment, options));
  return study;
}

namespace {

/// Hashes cells, each behind its length: no two lists of cells give the same bytes.
class CellHash {
 public:
  CellHash() { crypto_hash_sha256_init(&state_); }

  template <class... Cells>
  void add(const Cells&... cells) {
    (cell(fmt::format("{}", cells)), ...);
  }

  std::string hex() {
    std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
    crypto_hash_sha256_final(&state_, digest.data());
    return recorder::hexOf(digest);
  }

 private:
  void cell(const std::string& text) {
    std::array<unsigned char, 8> size{};
    for (std::size_t i = 0; i < size.size(); ++i)
      size[i] = static_cast<unsigned char>(std::uint64_t{text.size()} >> (8 * i));
    crypto_hash_sha256_update(&state_, size.data(), size.size());
    crypto_hash_sha256_update(&state_, reinterpret_cast<const unsigned char*>(text.data()), text.size());
  }

  crypto_hash_sha256_state state_{};
};

}  // namespace

std::string analysisDigest(const CohortDatabase& database, const AssessmentDatabase& assessment) {
  [[maybe_unused]] static const int ready = sodium_init();
  CellHash hash;
  for (const AttemptRow& a : database.listAttempts()) {
    hash.add(a.uuid, a.participant, a.group, a.profile, a.startUtc, a.comparabilityKey, static_cast<int>(a.outcome),
             static_cast<int>(a.mode), static_cast<int>(a.verification.verdict), a.complete, a.excluded,
             a.exclusionReason);
  }
  for (const Participant& p : database.participants()) {
    hash.add(p.pseudonym, p.group, p.experience.size());
    for (const auto& [criterion, value] : p.experience) hash.add(criterion, value);
  }
  database.eachValue({}, [&](const AttemptValue& item) {
    const CheckpointValue& v = item.value;
    // Shortest digits that give the same double again.
    hash.add(item.attempt, v.name, v.subject, v.version, static_cast<int>(v.availability),
             v.value ? fmt::format("{}", *v.value) : std::string());
  });
  for (const Rating& r : assessment.ratings()) {
    hash.add(r.form, r.formVersion, r.attempt, r.rater, r.participant, r.answers.size());
    for (const auto& [item, score] : r.answers) hash.add(item, score);
  }
  return hash.hex();
}

}  // namespace calot::analytics
