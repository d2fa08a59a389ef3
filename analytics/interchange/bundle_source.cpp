// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/bundle_source.h"

#include <utility>

#include "analytics/checkpoints/registry.h"

namespace calot::analytics {

BundleSource readBundleSource(const std::string& path) {
  const auto read = CohortDatabase::Access::read;
  const CohortDatabase cohort(path, read);
  BundleSource source;
  source.attempts = cohort.listAttempts();
  for (Participant& p : cohort.participants()) source.participants.emplace(p.pseudonym, std::move(p));
  for (AttemptValue& v : cohort.allValues()) source.values[v.attempt].push_back(std::move(v.value));
  source.metrics = cohort.externalMetrics();
  source.ratings = AssessmentDatabase(path, read).ratings();
  source.registers = readRegisters(path);
  return source;
}

const std::vector<std::string>& bundleReasons() {
  static const std::vector<std::string> all{
      "made by a performer", "without participant",           "withdrawn from research", "no consent to the scope",
      "excluded by hand",    "recording diverged or damaged", "recording incomplete",    "golden recording"};
  return all;
}

std::size_t whyLeftOut(const AttemptRow& a, const BundleSource& source, const BundleOptions& options) {
  if (a.synthetic && !options.includeSynthetic) return 0;
  // A performer's branch of a person's attempt begins with that person's motion, and bears the pseudonym.
  if (!a.synthetic || !a.parent.empty()) {
    const auto person = source.participants.find(a.participant);
    if (person == source.participants.end()) return 1;
    if (a.withdrawn) return 2;
    if (person->second.consent.count(options.scope) == 0) return 3;
  }
  if (a.excluded) return 4;
  if (a.verification.verdict == Verdict::diverged || a.verification.verdict == Verdict::damaged) return 5;
  if (!a.complete || a.outcome == recorder::Outcome::running) return 6;
  return a.purpose == "golden" ? 7 : bundleReasons().size();
}

OriginalNames originalsOf(const BundleSource& source) {
  OriginalNames names;
  for (const AttemptRow& a : source.attempts) {
    names.add(a.uuid, "an attempt's uuid");
    names.add(a.parent, "an attempt's uuid");
    names.add(a.startUtc, "a start");
    names.add(a.station, "a station");
    names.add(a.fileName, "a file");
    names.add(a.calibration, "a calibration");
    names.add(a.comparabilityKey, "a comparability key");
  }
  for (const auto& [pseudonym, p] : source.participants) {
    names.add(pseudonym, "a pseudonym");
    names.add(p.site, "a site");
  }
  for (const Rating& r : source.ratings) names.add(r.rater, "a rater");
  for (const Named& site : source.registers.sites) names.add(site.name, "a site");
  for (const Station& station : source.registers.stations) names.add(station.name, "a station");
  return names;
}

std::set<std::string> vocabularyOf(const BundleSource& source) {
  std::set<std::string> words{"human", "kinematics", "performer", "practice", "assessment", "falcon", "gamepad"};
  for (const AttemptRow& a : source.attempts) {
    words.insert({a.device, a.scene, a.profile});
  }
  for (const auto& [attempt, values] : source.values) {
    for (const CheckpointValue& value : values) words.insert({value.name, value.subject, value.unit});
  }
  for (const CheckpointEntry& e : checkpointRegistry()) words.insert(e.definition.name);
  return words;
}

}  // namespace calot::analytics
