// SPDX-License-Identifier: GPL-3.0-or-later
// First and repeated import of an attempt.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/tables.h"

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
  if (known.chainHead == incoming.chainHead) return {};
  // Only an incomplete recording has a continuation. That the longer one begins with the shorter is the replay's to
  // show.
  if (known.steps == incoming.steps && known.complete == incoming.complete) return "content";
  if (known.complete && (incoming.complete || incoming.steps > known.steps)) return "content";
  if (incoming.complete && incoming.steps < known.steps) return "content";
  return {};
}

void writeRecording(SQLite::Database& db, std::int64_t id, const AttemptRecord& a) {
  InsertOf put(db, recordingTable(), {"attempt"}, orUpdateAllBut(recordingTable(), {"attempt", "step_seconds"}));
  put(a, {id});
  execute(db, "UPDATE attempt SET outcome = ? WHERE id = ?", {static_cast<int>(a.outcome), id});
}

void writeVerification(SQLite::Database& db, std::int64_t id, const Verification& v) {
  InsertOf put(db, verificationTable(), {"attempt", "verified_utc"}, orUpdateAllBut(verificationTable(), {"attempt"}));
  put(v, {id, nowUtc()});
}

void writeSignature(SQLite::Database& db, std::int64_t id, const AttemptRecord& a) {
  InsertOf put(db, signatureTable(), {"attempt", "chain_head"}, orUpdateAllBut(signatureTable(), {"attempt"}));
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
  InsertOf put(db, attemptTable(), {"participant", "imported_utc"});
  put(a, {participant >= 0 ? Cell(participant) : Cell(), nowUtc()});
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
