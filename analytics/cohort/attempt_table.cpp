// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts as the database lists them, what people decide about them (exclusions and tags), first and repeated import.

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {
namespace {

/// Rows beside a row of attempt (alias a).
std::string selectAttempts(const std::string& clause) {
  return fmt::format(
      "SELECT {}, {}, coalesce(p.pseudonym, ''), coalesce(p.study_group, ''), coalesce(p.arm, ''), coalesce(p.site, "
      "''), "
      "a.imported_utc, v.verified_utc, w.participant, e.reason, e.excluded_by, v.attempt, s.attempt, {}, {} "
      "FROM attempt a JOIN recording r ON r.attempt = a.id "
      "LEFT JOIN verification v ON v.attempt = a.id LEFT JOIN participant p ON p.id = a.participant "
      "LEFT JOIN exclusion e ON e.attempt = a.id LEFT JOIN recording_signature s ON s.attempt = a.id "
      "LEFT JOIN research_withdrawal w ON w.participant = a.participant {}",
      memberColumns(attemptTable, "a"), memberColumns(recordingTable, "r"), memberColumns(verificationTable, "v"),
      memberColumns(signatureTable, "s"), clause);
}

AttemptRow attemptRow(SQLite::Statement& row) {
  AttemptRow a;
  int c = 0;
  readMembers<AttemptRecord>(attemptTable, row, c, a);
  readMembers<AttemptRecord>(recordingTable, row, c, a);
  for (std::string* joinedText : {&a.participant, &a.group, &a.arm, &a.site, &a.importedUtc, &a.verifiedUtc})
    *joinedText = text(row.getColumn(c++));
  a.withdrawn = !row.getColumn(c++).isNull();
  const SQLite::Column reason = row.getColumn(c++), by = row.getColumn(c++);
  a.excluded = a.withdrawn || !reason.isNull();
  if (a.withdrawn) {
    a.exclusionReason = "withdrawn from research";
  } else if (a.excluded) {
    a.exclusionReason = fmt::format("{} ({})", text(reason), text(by));
  }
  const bool verified = !row.getColumn(c++).isNull(), isSigned = !row.getColumn(c++).isNull();
  readMembers(verificationTable, row, c, a.verification);
  if (!verified) a.verification.verdict = Verdict::notChecked;
  if (isSigned) readMembers(signatureTable, row, c, a.signature.emplace());
  return a;
}

/// By uuid. @param condition on rows of attempt_left_out (alias l), with its parameters
std::map<std::string, std::vector<LeftOut>> readLeftOut(SQLite::Database& db, const std::string& condition = "",
                                                        const std::vector<Cell>& parameters = {}) {
  std::map<std::string, std::vector<LeftOut>> found;
  eachRow(db,
          "SELECT a.uuid, l.position, l.rule, l.reason FROM attempt_left_out l JOIN attempt a ON a.id = l.attempt " +
              condition + " ORDER BY l.position",
          parameters, [&](SQLite::Statement& row) {
            found[text(row.getColumn(0))].push_back(
                {row.getColumn(1).getInt64(), text(row.getColumn(2)), text(row.getColumn(3))});
          });
  return found;
}

}  // namespace

std::int64_t attemptId(SQLite::Database& db, const std::string& uuid) {
  return firstNumber(db, "SELECT id FROM attempt WHERE uuid = ?", {uuid});
}

std::int64_t knownAttempt(SQLite::Database& db, const std::string& path, const std::string& uuid) {
  const std::int64_t id = attemptId(db, uuid);
  if (id < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no attempt {}", uuid));
  return id;
}

std::optional<AttemptRow> findAttempt(SQLite::Database& db, const std::string& uuid) {
  std::optional<AttemptRow> found;
  eachRow(db, selectAttempts("WHERE a.uuid = ?"), {uuid}, [&](SQLite::Statement& row) { found = attemptRow(row); });
  if (found) {
    const std::int64_t id = attemptId(db, uuid);
    found->tags = firstTexts(db, "SELECT tag FROM attempt_tag WHERE attempt = ? ORDER BY tag", {id});
    found->leftOut = readLeftOut(db, "WHERE l.attempt = ?", {id})[uuid];
  }
  return found;
}

std::vector<AttemptRow> readAttempts(SQLite::Database& db) {
  std::vector<AttemptRow> rows;
  eachRow(db, selectAttempts("ORDER BY a.start_utc, a.uuid"), {},
          [&](SQLite::Statement& row) { rows.push_back(attemptRow(row)); });
  // Few have any: looking for them beside each attempt would cost more.
  std::map<std::string, std::vector<std::string>> tagsOf;
  eachRow(db, "SELECT a.uuid, t.tag FROM attempt_tag t JOIN attempt a ON a.id = t.attempt ORDER BY 2", {},
          [&](SQLite::Statement& row) { tagsOf[text(row.getColumn(0))].push_back(text(row.getColumn(1))); });
  auto leftOut = readLeftOut(db);
  for (AttemptRow& row : rows) {
    if (const auto at = tagsOf.find(row.uuid); at != tagsOf.end()) row.tags = std::move(at->second);
    if (const auto at = leftOut.find(row.uuid); at != leftOut.end()) row.leftOut = std::move(at->second);
  }
  return rows;
}

}  // namespace calot::analytics::tables

namespace calot::analytics {

using namespace tables;

namespace {

bool isBlank(const std::string& text) { return text.find_first_not_of(" \t\r\n") == std::string::npos; }

void checkDecision(const std::string& reason, const std::string& by) {
  if (isBlank(by)) throw Error(ErrorKind::invalid, "exclusion: name who decides");
  if (isBlank(reason)) throw Error(ErrorKind::invalid, "exclusion: a reason is expected");
}

/// Runs a statement for each attempt that binds its number and the tag, and audits those that it changes.
std::size_t changeTags(CohortConnection& cohort, const std::vector<std::string>& attempts, const std::string& tag,
                       const std::string& by, const char* sql, const char* action) {
  checkTag(tag);
  if (isBlank(by)) throw Error(ErrorKind::invalid, "tag: name who decides");
  return cohort.change([&](SQLite::Database& db) {
    std::size_t changed = 0;
    for (const std::string& attempt : attempts) {
      if (execute(db, sql, {knownAttempt(db, cohort.path, attempt), tag}) == 0) continue;
      audit(db, action, attempt, fmt::format("{} (by {})", tag, by));
      ++changed;
    }
    return changed;
  });
}

}  // namespace

void checkTag(const std::string& tag) {
  const auto refused = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte <= 0x20 || byte == 0x7F || c == ',';
  };
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };  // a character, in UTF-8
  if (tag.empty() || std::count_if(tag.begin(), tag.end(), begins) > 40 ||
      std::any_of(tag.begin(), tag.end(), refused)) {
    throw Error(ErrorKind::invalid, "tag: one word of 1 to 40 characters is expected, without blanks and commas");
  }
}

void CohortDatabase::excludeAttempts(const std::vector<std::string>& attempts, const std::string& reason,
                                     const std::string& by) {
  checkDecision(reason, by);
  connection_->change([&](SQLite::Database& db) {
    for (const std::string& attempt : attempts) {
      execute(db, "INSERT OR REPLACE INTO exclusion VALUES (?, ?, ?, ?)",
              {knownAttempt(db, path(), attempt), reason, by, nowUtc()});
      audit(db, "attempt-exclude", attempt, fmt::format("{} (by {})", reason, by));
    }
  });
}

void CohortDatabase::includeAttempts(const std::vector<std::string>& attempts, const std::string& reason,
                                     const std::string& by) {
  checkDecision(reason, by);
  connection_->change([&](SQLite::Database& db) {
    for (const std::string& attempt : attempts) {
      if (execute(db, "DELETE FROM exclusion WHERE attempt = ?", {knownAttempt(db, path(), attempt)}) == 0)
        throw Error(ErrorKind::refused, Where{path()}, fmt::format("attempt {} is not excluded", attempt));
      audit(db, "attempt-include", attempt, fmt::format("{} (by {})", reason, by));
    }
  });
}

std::string CohortDatabase::uuidOfMotion(const std::string& uuid, const std::string& earlier,
                                         const std::array<std::byte, 32>& bytesHash) const {
  return connection_->read([&](SQLite::Database& db) {
    if (attemptId(db, uuid) >= 0) return uuid;
    const std::vector<std::string> sameBytes =
        firstTexts(db, "SELECT a.uuid FROM recording r JOIN attempt a ON a.id = r.attempt WHERE r.chain_head = ?",
                   {blobOf(bytesHash)});
    if (!sameBytes.empty()) return sameBytes.front();
    return isWithdrawn(db, earlier) ? earlier : uuid;
  });
}

std::size_t CohortDatabase::tagAttempts(const std::vector<std::string>& attempts, const std::string& tag,
                                        const std::string& by) {
  return changeTags(*connection_, attempts, tag, by,
                    "INSERT INTO attempt_tag (attempt, tag) VALUES (?, ?) ON CONFLICT DO NOTHING", "attempt-tag");
}

std::size_t CohortDatabase::untagAttempts(const std::vector<std::string>& attempts, const std::string& tag,
                                          const std::string& by) {
  return changeTags(*connection_, attempts, tag, by, "DELETE FROM attempt_tag WHERE attempt = ? AND tag = ?",
                    "attempt-untag");
}

}  // namespace calot::analytics

namespace calot::analytics::tables {

void checkAttempt(const AttemptRecord& a, const std::string& path) {
  constexpr std::string_view form = "00000000-0000-0000-0000-000000000000";
  const bool uuid = std::equal(a.uuid.begin(), a.uuid.end(), form.begin(), form.end(), [](char c, char of) {
    return of == '-' ? c == '-' : (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  });
  if (!uuid)
    throw Error(ErrorKind::damaged, Where{a.fileName.empty() ? path : a.fileName},
                fmt::format("attempt \"{}\" is not a uuid", a.uuid));
  if (a.steps > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) || !(a.stepSeconds > 0.0)) {
    throw Error(ErrorKind::damaged, Where{a.fileName}, "number or length of steps is out of range");
  }
  if (!a.participant.empty()) checkPseudonym(a.participant);
}

namespace {

/// Names the first thing in which two recordings of one uuid differ though it never changes, or nothing.
std::string contradiction(const AttemptRecord& known, const AttemptRecord& incoming) {
  if (known.scene != incoming.scene || known.sceneMajor != incoming.sceneMajor) return "scene";
  if (known.seed != incoming.seed) return "seed";
  if (known.operatorKind != incoming.operatorKind || known.profile != incoming.profile) return "operator";
  if (known.participant != incoming.participant) return "participant";
  if (known.startUtc != incoming.startUtc) return "start";
  if (known.simulationVersion != incoming.simulationVersion) return "simulation version";
  if (known.parent != incoming.parent) return "parent";
  if (known.mode != incoming.mode) return "mode";
  if (known.signature && incoming.signature && known.signature->publicKey != incoming.signature->publicKey)
    return "signer";
  if (!known.station.empty() && known.station != incoming.station) return "station";
  if (known.device != incoming.device || known.calibration != incoming.calibration) return "device";
  if (known.chainHead == incoming.chainHead || isMotion(known)) return {};  // motion's uuid is of its samples
  // Only an incomplete recording has a continuation. That the longer one begins with the shorter is the replay's to
  // show.
  if (known.steps == incoming.steps && known.complete == incoming.complete) return "content";
  if (known.complete && (incoming.complete || incoming.steps > known.steps)) return "content";
  if (incoming.complete && incoming.steps < known.steps) return "content";
  return {};
}

void writeRecording(SQLite::Database& db, std::int64_t id, const AttemptRecord& a) {
  InsertOf put(db, recordingTable, {"attempt"}, orUpdateAllBut(recordingTable, {"attempt", "step_seconds"}));
  put(a, {id});
  execute(db, "UPDATE attempt SET outcome = ? WHERE id = ?", {static_cast<int>(a.outcome), id});
}

void writeVerification(SQLite::Database& db, std::int64_t id, const Verification& v) {
  InsertOf put(db, verificationTable, {"attempt", "verified_utc"}, orUpdateAllBut(verificationTable, {"attempt"}));
  put(v, {id, nowUtc()});
}

void writeSignature(SQLite::Database& db, std::int64_t id, const AttemptRecord& a) {
  InsertOf put(db, signatureTable, {"attempt", "chain_head"}, orUpdateAllBut(signatureTable, {"attempt"}));
  put(*a.signature, {id, blobOf(a.chainHead)});
}

void refuseWithdrawn(SQLite::Database& db, const std::string& path, const AttemptRecord& a) {
  for (const std::string* uuid : {&a.uuid, &a.parent}) {
    if (!uuid->empty() && isWithdrawn(db, *uuid)) {
      throw Error(ErrorKind::refused, Where{a.fileName},
                  fmt::format("{} was withdrawn from {}; it is not taken in again, delete the file",
                              uuid == &a.uuid ? "its attempt" : "what it branches from", path));
    }
  }
}

void insertAttempt(SQLite::Database& db, const AttemptRecord& a, const std::vector<CheckpointValue>* values) {
  std::int64_t participant = -1;
  if (!a.participant.empty()) {
    participant = participantId(db, a.participant);
    if (participant < 0) {
      Participant fresh;
      fresh.pseudonym = a.participant;
      participant = insertParticipant(db, fresh);
      audit(db, "participant-add", a.participant, "named by attempt " + a.uuid);
    }
  }
  AttemptRecord entered = a;
  if (isMotion(a) && a.purpose.empty()) {
    const bool consented = firstNumber(db,
                                       "SELECT 1 FROM consent WHERE participant = ? AND purpose IN ('research', "
                                       "'study')",
                                       {participant}) == 1;
    entered.purpose = consented ? "study" : "training";
  }
  InsertOf put(db, attemptTable, {"participant", "imported_utc"});
  put(entered, {participant >= 0 ? Cell(participant) : Cell(), nowUtc()});
  const std::int64_t id = db.getLastInsertRowid();
  writeRecording(db, id, a);
  if (a.signature) writeSignature(db, id, a);
  writeVerification(db, id, a.verification);
  if (values != nullptr) replaceValues(db, id, *values);
  audit(db, "attempt-import", a.uuid,
        fmt::format("{}, {} steps, {}", a.fileName, a.steps, nameOf(a.verification.verdict)));
}

Imported updateAttempt(SQLite::Database& db, const std::string& path, const AttemptRow& known, const AttemptRecord& a,
                       const std::vector<CheckpointValue>* values) {
  const auto conflict = [&](const std::string& what) {
    return Error(ErrorKind::refused, Where{a.fileName},
                 fmt::format("conflict: attempt {} is in {} already, from {}, {}; nothing was changed", a.uuid, path,
                             known.fileName, what));
  };
  const bool judged = a.verification.verdict == Verdict::diverged || a.verification.verdict == Verdict::damaged;
  const bool trusted = known.verification.verdict == Verdict::verified;
  if (trusted && judged) throw conflict(fmt::format("verified, and this file is {}", nameOf(a.verification.verdict)));
  if (const std::string what = contradiction(known, a); !what.empty()) throw conflict("with another " + what);
  if (a.chainHead != known.chainHead && (a.steps < known.steps || known.complete))
    return Imported::unchanged;  // an earlier copy
  // A build that cannot judge a recording does not overwrite the verdict of one that could.
  const bool blind =
      a.verification.verdict == Verdict::notCheckableHere || a.verification.verdict == Verdict::notChecked;
  const std::int64_t id = attemptId(db, a.uuid);
  const bool longer = a.chainHead != known.chainHead || a.steps != known.steps || a.complete != known.complete ||
                      a.outcome != known.outcome;
  bool changed = longer || a.fileName != known.fileName;
  if (changed) writeRecording(db, id, a);
  if (a.signature && a.signature != known.signature) {
    writeSignature(db, id, a);
    changed = true;
  } else if (longer && !a.signature && known.signature) {
    execute(db, "DELETE FROM recording_signature WHERE attempt = ?", {id});  // it was of the shorter content
  }
  if (known.station.empty() && !a.station.empty()) {
    execute(db, "UPDATE attempt SET station = ? WHERE id = ?", {a.station, id});  // came in before stations were kept
    changed = true;
  }
  if (longer || !(trusted && blind)) {
    const Verification &was = known.verification, &is = a.verification;
    if (was.verdict != is.verdict || was.text != is.text || was.software != is.software) {
      writeVerification(db, id, is);
      changed = true;
    }
    if (values != nullptr && replaceValues(db, id, *values)) changed = true;
    // Those of external metrics are of the shorter content, or of one that does not verify.
    if ((longer || (values != nullptr && values->empty())) &&
        execute(db, "DELETE FROM external_value WHERE attempt = ?", {id}) > 0)
      changed = true;
  }
  if (!changed) return Imported::unchanged;
  audit(db, "attempt-update", a.uuid,
        fmt::format("{}, {} steps, {}", a.fileName, a.steps, nameOf(a.verification.verdict)));
  return Imported::extended;
}

}  // namespace

Imported importAttempt(SQLite::Database& db, const std::string& path, const AttemptRecord& attempt,
                       const std::vector<CheckpointValue>* values) {
  refuseWithdrawn(db, path, attempt);
  if (const std::optional<AttemptRow> known = findAttempt(db, attempt.uuid))
    return updateAttempt(db, path, *known, attempt, values);
  insertAttempt(db, attempt, values);
  return Imported::added;
}

}  // namespace calot::analytics::tables
