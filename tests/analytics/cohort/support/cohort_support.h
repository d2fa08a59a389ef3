// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts to fill a cohort with, and a folder that goes away.
#pragma once

#include <unistd.h>

#include <fmt/format.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::analytics::support {

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "calot-cohort-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string uuidOf(unsigned n) { return fmt::format("00000000-0000-4000-8000-{:012x}", n); }

inline std::optional<Participant> findParticipant(const CohortDatabase& database, const std::string& pseudonym) {
  for (Participant& p : database.participants()) {
    if (p.pseudonym == pseudonym) return std::move(p);
  }
  return std::nullopt;
}

/// A finished, verified performer's attempt in assessment mode.
inline AttemptRecord attemptOf(unsigned n, const std::string& profile) {
  AttemptRecord a;
  a.uuid = uuidOf(n);
  a.scene = std::string("touch-liver");
  a.sceneMajor = 1;
  a.operatorKind = recorder::OperatorKind::performer;
  a.profile = profile;
  a.profileVersion = std::string("1");
  a.mode = recorder::Mode::assessment;
  a.purpose = std::string("study");
  a.outcome = recorder::Outcome::completed;
  a.startUtc = fmt::format("2026-01-01T00:{:02}:{:02}Z", n / 60 % 60, n % 60);
  a.seed = 18446744073709551615ULL - n;
  a.simulationVersion = 1;
  a.comparabilityKey =
      std::string("touch-liver/1 device=performer calibration=- simulation=1 results=1 mode=assessment");
  a.synthetic = true;
  a.fileName = fmt::format("{}.h5", n);
  a.complete = true;
  a.steps = 1000 + n;
  a.chainHead[0] = std::byte{0xC0};
  a.chainHead[31] = static_cast<std::byte>(n);
  a.verification = {Verdict::verified, "", "calot 0.1.0"};
  return a;
}

/// The same by a person.
inline AttemptRecord humanAttempt(unsigned n, const std::string& participant) {
  AttemptRecord a = attemptOf(n, "");
  a.operatorKind = recorder::OperatorKind::human;
  a.profileVersion.clear();
  a.participant = participant;
  a.device = std::string("falcon");
  a.comparabilityKey = std::string("touch-liver/1 device=falcon calibration=- simulation=1 results=1 mode=assessment");
  a.synthetic = false;
  return a;
}

/// The time that the checkpoint gives of an attempt that ends so.
inline CheckpointValue elapsedTime(double seconds, recorder::Outcome outcome) {
  AttemptEnd end;
  end.steps = static_cast<std::uint64_t>(100.0 * seconds + 0.5);
  end.outcome = outcome;
  return checkpointRegistry()[positionOf("elapsed-time")].make({})->values(end).front();
}

inline std::vector<CheckpointValue> valuesOf(double seconds, double left) {
  return {makeValue(*findCheckpoint("elapsed-time"), "", Origin::resimulated, seconds),
          makeValue(*findCheckpoint("path-length"), "left", Origin::samples, left),
          makeMissing(*findCheckpoint("path-length"), "right", Origin::samples, Availability::notApplicable,
                      "no instrument in this hand")};
}

/// Every row of every table, to compare two states of a database.
inline std::string dump(const std::string& path) {
  SQLite::Database db(path, SQLite::OPEN_READONLY);
  std::string text;
  SQLite::Statement tables(db, "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name");
  while (tables.executeStep()) {
    const std::string name = tables.getColumn(0).getString();
    text += name + "\n";
    SQLite::Statement rows(db, "SELECT * FROM " + name);
    while (rows.executeStep()) {
      for (int c = 0; c < rows.getColumnCount(); ++c) text += rows.getColumn(c).getString() + "|";
      text += "\n";
    }
  }
  return text;
}

/// The answer of SQLite's own check.
inline std::string integrity(const std::string& path) {
  SQLite::Database db(path, SQLite::OPEN_READONLY);
  return db.execAndGet("PRAGMA integrity_check").getString();
}

}  // namespace calot::analytics::support
