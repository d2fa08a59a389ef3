// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/cohort_database.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "analytics/cohort/row_statements.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics {

using namespace tables;

std::string nameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::verified:
      return "verified";
    case Verdict::diverged:
      return "diverged";
    case Verdict::damaged:
      return "damaged";
    case Verdict::notCheckableHere:
      return "not checkable here";
    case Verdict::notChecked:
      return "not checked";
  }
  return "unknown";
}

CohortDatabase::CohortDatabase(const std::string& path, Access access, std::chrono::milliseconds patience)
    : storage_(std::make_unique<Storage>()) {
  storage_->path = path;
  storage_->db = openCohort(path, access, patience);
}

CohortDatabase::~CohortDatabase() = default;
CohortDatabase::CohortDatabase(CohortDatabase&&) noexcept = default;
CohortDatabase& CohortDatabase::operator=(CohortDatabase&&) noexcept = default;

const std::string& CohortDatabase::path() const { return storage_->path; }

int CohortDatabase::schemaVersion() const {
  return guarded(path(), [&] { return storage_->db->execAndGet("PRAGMA user_version").getInt(); });
}

void checkParticipant(const Participant& p) {
  checkPseudonym(p.pseudonym);
  checkDetails(p.experience, p.consent);
}

void CohortDatabase::addParticipant(const Participant& p) {
  checkParticipant(p);
  guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    if (participantId(db, p.pseudonym) >= 0) {
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("participant \"{}\" is there already", p.pseudonym),
                  {Remedy::changeParticipant});
    }
    writeDetails(db, insertParticipant(db, p), p.experience, p.consent);
    audit(db, "participant-add", p.pseudonym,
          fmt::format("group \"{}\", arm \"{}\", site \"{}\"", p.group, p.arm, p.site));
    transaction.commit();
  });
}

void CohortDatabase::setParticipant(const std::string& pseudonym, const ParticipantChange& change) {
  checkDetails(change.experience, change.consent);
  guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    const std::int64_t id = participantId(db, pseudonym);
    if (id < 0) {
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("no participant \"{}\"", pseudonym),
                  {Remedy::addParticipant});
    }
    std::string detail;
    const auto set = [&](const char* column, const char* word, const std::optional<std::string>& value) {
      if (!value) return;
      SQLite::Statement update(db, fmt::format("UPDATE participant SET {} = ? WHERE id = ?", column));
      SQLite::bind(update, *value, id);
      update.exec();
      detail += fmt::format("{} \"{}\"; ", word, *value);
    };
    set("study_group", "group", change.group);
    set("arm", "arm", change.arm);
    set("site", "site", change.site);
    writeDetails(db, id, change.experience, change.consent);
    for (const auto& item : change.experience) detail += fmt::format("experience {} = {}; ", item.first, item.second);
    for (const auto& item : change.consent) detail += fmt::format("consent {} {}; ", item.first, item.second);
    audit(db, "participant-set", pseudonym, detail);
    transaction.commit();
  });
}

std::vector<Participant> CohortDatabase::participants() const {
  return guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    std::vector<Participant> result;
    std::map<std::int64_t, std::size_t> index;
    SQLite::Statement select(
        db, fmt::format("SELECT id, {} FROM participant ORDER BY pseudonym", memberColumns(participantTable())));
    while (select.executeStep()) {
      index[select.getColumn(0).getInt64()] = result.size();
      int c = 1;
      readMembers(participantTable(), select, c, result.emplace_back());
    }
    SQLite::Statement experience(db, "SELECT participant, criterion, value FROM participant_experience");
    while (experience.executeStep()) {
      if (const auto at = index.find(experience.getColumn(0).getInt64()); at != index.end())
        result[at->second].experience[text(experience.getColumn(1))] = text(experience.getColumn(2));
    }
    SQLite::Statement consent(db, "SELECT participant, purpose, given_on FROM consent");
    while (consent.executeStep()) {
      if (const auto at = index.find(consent.getColumn(0).getInt64()); at != index.end())
        result[at->second].consent[text(consent.getColumn(1))] = text(consent.getColumn(2));
    }
    return result;
  });
}

std::optional<Participant> CohortDatabase::participant(const std::string& pseudonym) const {
  for (Participant& p : participants()) {
    if (p.pseudonym == pseudonym) return std::move(p);
  }
  return std::nullopt;
}

Imported CohortDatabase::storeAttempt(const AttemptRecord& attempt, const std::vector<CheckpointValue>& values) {
  checkAttempt(attempt, path());
  return guarded(path(), [&] {
    SQLite::Transaction transaction(*storage_->db, SQLite::TransactionBehavior::IMMEDIATE);
    const Imported imported = importAttempt(*storage_->db, path(), attempt, &values);
    transaction.commit();
    return imported;
  });
}

Imported CohortDatabase::upsertAttempt(const AttemptRecord& attempt) {
  checkAttempt(attempt, path());
  return guarded(path(), [&] {
    SQLite::Transaction transaction(*storage_->db, SQLite::TransactionBehavior::IMMEDIATE);
    const Imported imported = importAttempt(*storage_->db, path(), attempt, nullptr);
    transaction.commit();
    return imported;
  });
}

void CohortDatabase::storeValues(const std::string& attempt, const std::vector<CheckpointValue>& values) {
  guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    const std::int64_t id = attemptId(db, attempt);
    if (id < 0) throw Error(ErrorKind::refused, Where{path()}, fmt::format("no attempt {}", attempt));
    if (replaceValues(db, id, values)) audit(db, "attempt-values", attempt, fmt::format("{} values", values.size()));
    transaction.commit();
  });
}

void CohortDatabase::storeIntervals(const std::string& attempt, const std::vector<ValueInterval>& intervals) {
  guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    const std::int64_t id = attemptId(db, attempt);
    if (id < 0) throw Error(ErrorKind::refused, Where{path()}, fmt::format("no attempt {}", attempt));
    if (replaceIntervals(db, id, intervals))
      audit(db, "attempt-intervals", attempt, fmt::format("{} intervals", intervals.size()));
    transaction.commit();
  });
}

Imported CohortDatabase::storeExternal(const std::string& attempt, const std::vector<CheckpointValue>& values) {
  return guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    const std::int64_t id = attemptId(db, attempt);
    if (id < 0) throw Error(ErrorKind::refused, Where{path()}, fmt::format("no attempt {}", attempt));
    const std::size_t added = writeExternalValues(db, path(), id, values);
    if (added > 0) audit(db, "attempt-external", attempt, fmt::format("{} values", added));
    transaction.commit();
    return added > 0 ? Imported::added : Imported::unchanged;
  });
}

void CohortDatabase::checkMetric(const ExternalMetric& metric) const {
  guarded(path(), [&] { checkExternalMetric(*storage_->db, path(), metric); });
}

std::vector<ExternalMetric> CohortDatabase::externalMetrics() const {
  return guarded(path(), [&] { return readExternalMetrics(*storage_->db); });
}

std::string CohortDatabase::attemptNamed(const std::string& text) const {
  return guarded(path(), [&] {
    // Compared literally: wildcards in the text have no effect.
    SQLite::Statement find(*storage_->db,
                           "SELECT uuid FROM attempt WHERE substr(uuid, 1, ?) = ? ORDER BY uuid LIMIT 2");
    find.bind(1, static_cast<std::int64_t>(text.size()));
    find.bind(2, text);
    if (text.empty() || !find.executeStep()) {
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("no attempt \"{}\"", text));
    }
    std::string uuid = find.getColumn(0).getString();
    if (find.executeStep()) {
      throw Error(ErrorKind::refused, Where{path()},
                  fmt::format("more than one attempt begins with \"{}\"; give more of its uuid", text));
    }
    return uuid;
  });
}

std::vector<AttemptRow> CohortDatabase::listAttempts() const {
  return guarded(path(), [&] { return readAttempts(*storage_->db); });
}

std::optional<AttemptRow> CohortDatabase::attempt(const std::string& uuid) const {
  return guarded(path(), [&] { return findAttempt(*storage_->db, uuid); });
}

std::vector<CheckpointValue> CohortDatabase::values(const std::string& attempt) const {
  return guarded(path(), [&] {
    const std::int64_t id = attemptId(*storage_->db, attempt);
    std::vector<CheckpointValue> all = readValues(*storage_->db, id);
    for (CheckpointValue& v : readExternalValues(*storage_->db, id)) all.push_back(std::move(v));
    return all;
  });
}

std::vector<ValueInterval> CohortDatabase::intervals(const std::string& attempt) const {
  return guarded(path(), [&] { return readIntervals(*storage_->db, attemptId(*storage_->db, attempt)); });
}

std::vector<AttemptValue> CohortDatabase::allValues(const std::vector<std::string>& without) const {
  std::vector<AttemptValue> values;
  eachValue(without, [&](const AttemptValue& value) { values.push_back(value); });
  const auto external = [](const AttemptValue& v) { return static_cast<bool>(v.value.metric); };
  if (std::any_of(values.begin(), values.end(), external)) {
    std::stable_sort(values.begin(), values.end(),
                     [](const AttemptValue& x, const AttemptValue& y) { return x.attempt < y.attempt; });
  }
  return values;
}

void CohortDatabase::eachValue(const std::vector<std::string>& without,
                               const std::function<void(const AttemptValue&)>& take) const {
  guarded(path(), [&] {
    readAllValues(*storage_->db, without, take);
    for (const AttemptValue& value : readAllExternalValues(*storage_->db, without)) take(value);
  });
}

std::vector<GroupCount> CohortDatabase::groups() const {
  return guarded(path(), [&] {
    SQLite::Statement select(*storage_->db,
                             "SELECT coalesce(p.study_group, ''), count(DISTINCT p.id), count(a.id) FROM attempt a "
                             "FULL OUTER JOIN participant p ON p.id = a.participant GROUP BY 1 ORDER BY 1");
    std::vector<GroupCount> groups;
    while (select.executeStep()) {
      groups.push_back({text(select.getColumn(0)), static_cast<std::uint64_t>(select.getColumn(1).getInt64()),
                        static_cast<std::uint64_t>(select.getColumn(2).getInt64())});
    }
    return groups;
  });
}

std::string comparabilityKey(const recorder::AttemptHeader& header) {
  const auto orDash = [](const std::string& s) { return s.empty() ? std::string("-") : s; };
  // Without a device, the kind of operator takes its place: a performer's hands are not a human's.
  const std::string device =
      header.provenance.device.empty() ? wordFor(header.provenance.kind) : header.provenance.device;
  return fmt::format("{}/{} device={} calibration={} simulation={} results={} mode={}", header.sceneName,
                     header.sceneMajor, device, orDash(header.provenance.calibration), header.simulationVersion,
                     header.stepResultVersion, wordFor(header.mode));
}

std::string comparabilityWords(const std::string& key) {
  constexpr std::array<std::string_view, 5> marks{" device=", " calibration=", " simulation=", " results=", " mode="};
  std::array<std::string, marks.size()> part;
  std::string rest = key;
  // From the end: a device's name is free text.
  for (std::size_t i = marks.size(); i-- > 0;) {
    const std::size_t at = rest.rfind(marks[i]);
    if (at == std::string::npos) return key;
    part[i] = rest.substr(at + marks[i].size());
    rest.resize(at);
  }
  const std::size_t slash = rest.rfind('/');
  if (slash == std::string::npos) return key;
  const std::string major = rest.substr(slash + 1);
  const std::string simulation = part[2] == "0" ? "imported motion without simulation"
                                                : fmt::format("simulation {}, step results {}", part[2], part[3]);
  return fmt::format("task {}{}, device {}, {}, {}, mode {}", rest.substr(0, slash), major == "0" ? "" : " " + major,
                     part[0], part[1] == "-" ? "no calibration" : "calibration " + part[1], simulation, part[4]);
}

}  // namespace calot::analytics
