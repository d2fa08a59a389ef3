// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/cohort_database.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <SQLiteCpp/Backup.h>
#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "analytics/cohort/embedded.h"
#include "analytics/cohort/tables.h"
#include "recorder/base/counted.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

using namespace tables;

std::string nameOf(Verdict verdict) {
  return nameIn({"verified", "diverged", "damaged", "not checkable here", "not checked"}, verdict);
}

CohortDatabase::CohortDatabase(const std::string& path, Access access, std::chrono::milliseconds patience)
    : connection_(std::make_unique<CohortConnection>(path, access, patience)) {}

CohortDatabase::~CohortDatabase() = default;
CohortDatabase::CohortDatabase(CohortDatabase&&) noexcept = default;
CohortDatabase& CohortDatabase::operator=(CohortDatabase&&) noexcept = default;

const std::string& CohortDatabase::path() const { return connection_->path; }

int CohortDatabase::schemaVersion() const {
  return connection_->read([](auto& db) { return db.execAndGet("PRAGMA user_version").getInt(); });
}

void checkParticipant(const Participant& p) {
  checkPseudonym(p.pseudonym);
  checkDetails(p.experience, p.consent);
}

void CohortDatabase::addParticipant(const Participant& p) {
  checkParticipant(p);
  connection_->change([&](SQLite::Database& db) {
    if (participantId(db, p.pseudonym) >= 0) {
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("participant \"{}\" is there already", p.pseudonym),
                  {Remedy::changeParticipant});
    }
    writeDetails(db, insertParticipant(db, p), p.experience, p.consent);
    audit(db, "participant-add", p.pseudonym,
          fmt::format("group \"{}\", arm \"{}\", site \"{}\"", p.group, p.arm, p.site));
  });
}

void CohortDatabase::setParticipant(const std::string& pseudonym, const ParticipantChange& change) {
  checkDetails(change.experience, change.consent);
  connection_->change([&](SQLite::Database& db) {
    const std::int64_t id = participantId(db, pseudonym);
    if (id < 0) {
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("no participant \"{}\"", pseudonym),
                  {Remedy::addParticipant});
    }
    std::string detail;
    const auto set = [&](const char* column, const char* word, const std::optional<std::string>& value) {
      if (!value) return;
      execute(db, fmt::format("UPDATE participant SET {} = ? WHERE id = ?", column), {*value, id});
      detail += fmt::format("{} \"{}\"; ", word, *value);
    };
    set("study_group", "group", change.group);
    set("arm", "arm", change.arm);
    set("site", "site", change.site);
    writeDetails(db, id, change.experience, change.consent);
    for (const auto& item : change.experience) detail += fmt::format("experience {} = {}; ", item.first, item.second);
    for (const auto& item : change.consent) detail += fmt::format("consent {} {}; ", item.first, item.second);
    audit(db, "participant-set", pseudonym, detail);
  });
}

std::vector<Participant> CohortDatabase::participants() const {
  return connection_->read([](SQLite::Database& db) {
    std::map<std::string, Participant> people;  // by pseudonym, in the order of their bytes
    for (Participant& p : selectRows(db, participantTable, "")) people.emplace(p.pseudonym, p);
    const auto add = [&](const char* query, std::map<std::string, std::string> Participant::*details) {
      eachRow(db, query, {}, [&](SQLite::Statement& row) {
        (people.at(text(row.getColumn(0))).*details)[text(row.getColumn(1))] = text(row.getColumn(2));
      });
    };
    add("SELECT pseudonym, criterion, value FROM participant_experience JOIN participant ON id = participant",
        &Participant::experience);
    add("SELECT pseudonym, purpose, given_on FROM consent JOIN participant ON id = participant", &Participant::consent);
    std::vector<Participant> list;
    list.reserve(people.size());
    for (auto& item : people) list.push_back(std::move(item.second));
    return list;
  });
}

Imported CohortDatabase::storeAttempt(const AttemptRecord& attempt, const std::vector<CheckpointValue>& values) {
  checkAttempt(attempt, path());
  return connection_->change([&](SQLite::Database& db) { return importAttempt(db, path(), attempt, &values); });
}

void CohortDatabase::storeValues(const std::string& attempt, const std::vector<CheckpointValue>& values) {
  connection_->change([&](SQLite::Database& db) {
    if (replaceValues(db, knownAttempt(db, path(), attempt), values))
      audit(db, "attempt-values", attempt, recorder::counted(values.size(), "value"));
  });
}

void CohortDatabase::storeIntervals(const std::string& attempt, const std::vector<ValueInterval>& intervals) {
  connection_->change([&](SQLite::Database& db) {
    if (replaceIntervals(db, knownAttempt(db, path(), attempt), intervals))
      audit(db, "attempt-intervals", attempt, fmt::format("{} intervals", intervals.size()));
  });
}

Imported CohortDatabase::storeExternal(const std::string& attempt, const std::vector<CheckpointValue>& values) {
  return connection_->change([&](SQLite::Database& db) {
    const std::size_t added = writeExternalValues(db, path(), knownAttempt(db, path(), attempt), values);
    if (added == 0) return Imported::unchanged;
    audit(db, "attempt-external", attempt, recorder::counted(added, "value"));
    return Imported::added;
  });
}

void CohortDatabase::checkMetric(const ExternalMetric& metric) const {
  connection_->read([&](SQLite::Database& db) { checkExternalMetric(db, path(), metric); });
}

std::vector<ExternalMetric> CohortDatabase::externalMetrics() const { return connection_->read(readExternalMetrics); }

std::string CohortDatabase::attemptNamed(const std::string& text) const {
  return connection_->read([&](SQLite::Database& db) {
    // Compared literally: wildcards in the text have no effect.
    const std::vector<std::string> found =
        firstTexts(db, "SELECT uuid FROM attempt WHERE substr(uuid, 1, length(?1)) = ?1 ORDER BY uuid LIMIT 2", {text});
    if (text.empty() || found.empty())
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("no attempt \"{}\"", recorder::shown(text)));
    if (found.size() > 1) {
      throw Error(
          ErrorKind::refused, Where{path()},
          fmt::format("more than one attempt begins with \"{}\"; give more of its uuid", recorder::shown(text)));
    }
    return found.front();
  });
}

std::vector<AttemptRow> CohortDatabase::listAttempts() const { return connection_->read(readAttempts); }

std::optional<AttemptRow> CohortDatabase::attempt(const std::string& uuid) const {
  return connection_->read([&](SQLite::Database& db) { return findAttempt(db, uuid); });
}

std::vector<CheckpointValue> CohortDatabase::values(const std::string& attempt) const {
  return connection_->read([&](SQLite::Database& db) {
    const std::int64_t id = attemptId(db, attempt);
    std::vector<CheckpointValue> all = readValues(db, id);
    for (CheckpointValue& v : readExternalValues(db, id)) all.push_back(std::move(v));
    return all;
  });
}

std::vector<ValueInterval> CohortDatabase::intervals(const std::string& attempt) const {
  return connection_->read([&](SQLite::Database& db) { return readIntervals(db, attemptId(db, attempt)); });
}

std::vector<AttemptValue> CohortDatabase::allValues(const std::vector<std::string>& without) const {
  std::vector<AttemptValue> values;
  eachValue(without, [&](const AttemptValue& value) { values.push_back(value); });
  // Those of external metrics come behind all others.
  const auto byAttempt = [](const AttemptValue& x, const AttemptValue& y) { return x.attempt < y.attempt; };
  if (!std::is_sorted(values.begin(), values.end(), byAttempt))
    std::stable_sort(values.begin(), values.end(), byAttempt);
  return values;
}

void CohortDatabase::eachValue(const std::vector<std::string>& without,
                               const std::function<void(const AttemptValue&)>& take) const {
  connection_->read([&](SQLite::Database& db) {
    readAllValues(db, without, take);
    for (const AttemptValue& value : readAllExternalValues(db, without)) take(value);
  });
}

std::map<std::string, CheckpointValue> CohortDatabase::valuesOf(std::string_view checkpoint) const {
  return connection_->read([&](SQLite::Database& db) { return readValuesOf(db, checkpoint); });
}

std::vector<GroupCount> CohortDatabase::groups() const {
  return connection_->read([](SQLite::Database& db) {
    std::vector<GroupCount> groups;
    eachRow(db,
            "SELECT coalesce(p.study_group, ''), count(DISTINCT p.id), count(a.id) FROM attempt a "
            "FULL OUTER JOIN participant p ON p.id = a.participant GROUP BY 1 ORDER BY 1",
            {}, [&](SQLite::Statement& row) {
              groups.push_back({text(row.getColumn(0)), static_cast<std::uint64_t>(row.getColumn(1).getInt64()),
                                static_cast<std::uint64_t>(row.getColumn(2).getInt64())});
            });
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

namespace {

void addFields(Fields& fields, const DeclaredTable& table, const void* row) {
  for (const DeclaredColumn& c : table.columns) {
    if (c.member.value != nullptr) fields.emplace_back(*c.listed != '\0' ? c.listed : c.name, c.member.value(row));
  }
}

}  // namespace

const char* startEvidence(const AttemptRecord& a) {
  if (a.startUtc.empty()) return "unknown";
  if (isMotion(a) || a.operatorKind == recorder::OperatorKind::kinematics) return "stated";
  return a.signature ? "signed" : "recorded";
}

Fields fieldsOf(const AttemptRow& a) {
  Fields fields;
  std::vector<std::string> leftOut;
  for (const LeftOut& out : a.leftOut) leftOut.push_back(out.rule);
  addFields(fields, attemptTable, static_cast<const AttemptRecord*>(&a));
  addFields(fields, recordingTable, static_cast<const AttemptRecord*>(&a));
  addFields(fields, verificationTable, &a.verification);
  const Fields others{{"participant", a.participant},
                      {"group", a.group},
                      {"arm", a.arm},
                      {"site", a.site},
                      {"seconds", static_cast<double>(a.steps) * a.stepSeconds},
                      {"start_evidence", startEvidence(a)},
                      {"excluded", a.excluded},
                      {"exclusion_reason", a.exclusionReason},
                      {"withdrawn", a.withdrawn},
                      {"tags", a.tags},
                      {"left_out", leftOut}};
  fields.insert(fields.end(), others.begin(), others.end());
  return fields;
}

Fields fieldsOf(const Participant& p) {
  Fields fields;
  addFields(fields, participantTable, &p);
  fields.emplace_back("experience", p.experience);
  fields.emplace_back("consent", p.consent);
  return fields;
}

Fields fieldsOf(const CheckpointValue& value) {
  Fields fields;
  addFields(fields, checkpointValueTable, &value);
  return fields;
}

CohortCheck checkCohort(const std::string& path) {
  return CohortConnection(path, CohortDatabase::Access::read).read([](SQLite::Database& stored) {
    // A copy in a temporary file: making it reads every page and compares its sum, and SQLite knows constraints only of
    // a database that it may write.
    SQLite::Database db("", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    if (SQLite::Backup(db, stored).executeStep(-1) != SQLITE_DONE) throw SQLite::Exception("in use", SQLITE_BUSY);
    CohortCheck result;
    result.schema = db.execAndGet("PRAGMA user_version").getInt();
    result.faults = schemaFaults(db);
    if (!result.faults.empty()) return result;  // what else would be said of it means nothing
    for (const std::string& line : firstTexts(db, "PRAGMA integrity_check")) {
      if (line != "ok") result.faults.push_back(printable(line));
    }
    if (!result.faults.empty()) return result;
    result.faults = valueFaults(db);
    for (const char* fault :
         {"SELECT count(*) || ' rows of ' || \"table\" || ' refer to no row of ' || \"parent\" FROM "
          "pragma_foreign_key_check GROUP BY \"table\", \"parent\"",
          "SELECT 'attempt ' || uuid || ' has no recording' FROM attempt WHERE id NOT IN (SELECT attempt FROM "
          "recording)",
          "SELECT 'attempt ' || a.uuid || ': its signature is of another content' FROM recording_signature s JOIN "
          "recording r USING (attempt) JOIN attempt a ON a.id = s.attempt WHERE s.chain_head <> r.chain_head"}) {
      for (std::string& line : firstTexts(db, fault)) result.faults.push_back(std::move(line));
    }
    const auto count = [&](const char* table) {
      return static_cast<std::uint64_t>(firstNumber(db, fmt::format("SELECT count(*) FROM {}", table)));
    };
    result.participants = count("participant");
    result.attempts = count("attempt");
    result.values = count("checkpoint_value");
    return result;
  });
}

void refuseUnsound(const std::string& path) {
  const CohortCheck check = checkCohort(path);
  if (check.faults.empty()) return;
  throw Error(ErrorKind::damaged, Where{path},
              fmt::format("{}, the first: {}; restore a copy, or assess the recordings into a new one",
                          recorder::counted(check.faults.size(), "fault"), check.faults.front()));
}

}  // namespace calot::analytics
