// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/intake/enrolment.h"

#include <fmt/format.h>

#include <optional>

#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::shown;

/// What is written where nothing was. @throws Error (refused) where something else was.
std::optional<std::string> filled(const std::string& path, const std::string& pseudonym, const std::string& what,
                                  const std::string& known, const std::string& wanted) {
  if (wanted.empty() || known == wanted) return std::nullopt;
  if (known.empty()) return wanted;
  throw Error(
      ErrorKind::refused, Where{path},
      fmt::format("participant \"{}\" has {} \"{}\", not \"{}\"", shown(pseudonym), what, shown(known), shown(wanted)),
      {Remedy::changeParticipant});
}

std::map<std::string, std::string> filled(const std::string& path, const std::string& pseudonym,
                                          const std::string& what, const std::map<std::string, std::string>& known,
                                          const std::map<std::string, std::string>& wanted) {
  std::map<std::string, std::string> added;
  for (const auto& [name, value] : wanted) {
    const auto at = known.find(name);
    const std::string before = at == known.end() ? std::string() : at->second;
    if (const auto more = filled(path, pseudonym, what + " " + shown(name), before, value)) added[name] = *more;
  }
  return added;
}

bool isEmpty(const ParticipantChange& c) {
  return !c.group && !c.arm && !c.site && c.experience.empty() && c.consent.empty();
}

}  // namespace

Enrolment::Enrolment(const CohortDatabase& database) : path_(database.path()) {
  for (Participant& p : database.participants()) known_.emplace(p.pseudonym, p);
}

ParticipantChange Enrolment::changeOf(const Participant& wanted) const {
  const auto at = known_.find(wanted.pseudonym);
  if (at == known_.end()) return {};
  const Participant& known = at->second;
  const std::string& who = wanted.pseudonym;
  ParticipantChange change;
  change.group = filled(path_, who, "group", known.group, wanted.group);
  change.arm = filled(path_, who, "arm", known.arm, wanted.arm);
  change.site = filled(path_, who, "site", known.site, wanted.site);
  change.experience = filled(path_, who, "experience", known.experience, wanted.experience);
  change.consent = filled(path_, who, "consent", known.consent, wanted.consent);
  return change;
}

void Enrolment::add(CohortDatabase& database, const Participant& wanted) {
  const auto [at, isNew] = known_.emplace(wanted.pseudonym, wanted);
  if (isNew) {
    database.addParticipant(wanted);
    return;
  }
  const ParticipantChange change = changeOf(wanted);
  if (isEmpty(change)) return;
  database.setParticipant(wanted.pseudonym, change);
  Participant& known = at->second;
  if (change.group) known.group = *change.group;
  if (change.arm) known.arm = *change.arm;
  if (change.site) known.site = *change.site;
  known.experience.insert(change.experience.begin(), change.experience.end());
  known.consent.insert(change.consent.begin(), change.consent.end());
}

std::vector<Error> Enrolment::conflicts(const MotionManifest& manifest) const {
  std::vector<Error> conflicts;
  for (const auto& [pseudonym, participant] : manifest.participants) {
    try {
      static_cast<void>(changeOf(participant));
    } catch (const Error& e) {
      conflicts.emplace_back(e.kind(), Where{manifest.path, fmt::format("line {}", manifest.lineOf.at(pseudonym))},
                             e.what(), e.remedies());
    }
  }
  return conflicts;
}

}  // namespace calot::analytics
