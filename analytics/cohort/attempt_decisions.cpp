// SPDX-License-Identifier: GPL-3.0-or-later
// What people decide about attempts: exclusions and tags.
#include <fmt/format.h>

#include <algorithm>

#include "analytics/cohort/cohort_storage.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics {

using namespace tables;

namespace {

bool isBlank(const std::string& text) { return text.find_first_not_of(" \t\r\n") == std::string::npos; }

void checkDecision(const std::string& reason, const std::string& by) {
  if (isBlank(by)) throw Error(ErrorKind::invalid, "exclusion: name who decides");
  if (isBlank(reason)) throw Error(ErrorKind::invalid, "exclusion: a reason is wanted");
}

std::int64_t knownAttempt(SQLite::Database& db, const std::string& path, const std::string& attempt) {
  const std::int64_t id = attemptId(db, attempt);
  if (id < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no attempt {}", attempt));
  return id;
}

/// Runs a statement for each attempt that binds its number and the tag, and audits those that it changes.
std::size_t changeTags(SQLite::Database& db, const std::string& path, const std::vector<std::string>& attempts,
                       const std::string& tag, const std::string& by, const char* sql, const char* action) {
  checkTag(tag);
  if (isBlank(by)) throw Error(ErrorKind::invalid, "tag: name who decides");
  return guarded(path, [&] {
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement change(db, sql);
    std::size_t changed = 0;
    for (const std::string& attempt : attempts) {
      change.reset();
      SQLite::bind(change, knownAttempt(db, path, attempt), tag);
      if (change.exec() == 0) continue;
      audit(db, action, attempt, fmt::format("{} (by {})", tag, by));
      ++changed;
    }
    transaction.commit();
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
    throw Error(ErrorKind::invalid, "tag: one word of 1 to 40 characters is wanted, without blanks and commas");
  }
}

void CohortDatabase::excludeAttempts(const std::vector<std::string>& attempts, const std::string& reason,
                                     const std::string& by) {
  checkDecision(reason, by);
  guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement put(db,
                          "INSERT INTO exclusion VALUES (?, ?, ?, ?) ON CONFLICT DO UPDATE SET reason = "
                          "excluded.reason, excluded_by = excluded.excluded_by, excluded_utc = excluded.excluded_utc");
    for (const std::string& attempt : attempts) {
      put.reset();
      SQLite::bind(put, knownAttempt(db, path(), attempt), reason, by, nowUtc());
      put.exec();
      audit(db, "attempt-exclude", attempt, fmt::format("{} (by {})", reason, by));
    }
    transaction.commit();
  });
}

void CohortDatabase::includeAttempts(const std::vector<std::string>& attempts, const std::string& reason,
                                     const std::string& by) {
  checkDecision(reason, by);
  guarded(path(), [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement clear(db, "DELETE FROM exclusion WHERE attempt = ?");
    for (const std::string& attempt : attempts) {
      clear.reset();
      clear.bind(1, knownAttempt(db, path(), attempt));
      if (clear.exec() == 0)
        throw Error(ErrorKind::refused, Where{path()}, fmt::format("attempt {} is not excluded", attempt));
      audit(db, "attempt-include", attempt, fmt::format("{} (by {})", reason, by));
    }
    transaction.commit();
  });
}

std::size_t CohortDatabase::tagAttempts(const std::vector<std::string>& attempts, const std::string& tag,
                                        const std::string& by) {
  return changeTags(*storage_->db, path(), attempts, tag, by,
                    "INSERT INTO attempt_tag (attempt, tag) VALUES (?, ?) ON CONFLICT DO NOTHING", "attempt-tag");
}

std::size_t CohortDatabase::untagAttempts(const std::vector<std::string>& attempts, const std::string& tag,
                                          const std::string& by) {
  return changeTags(*storage_->db, path(), attempts, tag, by, "DELETE FROM attempt_tag WHERE attempt = ? AND tag = ?",
                    "attempt-untag");
}

}  // namespace calot::analytics
