// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts as the database lists them, and what people decide about them: exclusions and tags.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <map>
#include <utility>

#include "analytics/cohort/row_statements.h"
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
      memberColumns(attemptTable(), "a"), memberColumns(recordingTable(), "r"), memberColumns(verificationTable(), "v"),
      memberColumns(signatureTable(), "s"), clause);
}

AttemptRow attemptRow(SQLite::Statement& row) {
  AttemptRow a;
  int c = 0;
  readMembers<AttemptRecord>(attemptTable(), row, c, a);
  readMembers<AttemptRecord>(recordingTable(), row, c, a);
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
  readMembers(verificationTable(), row, c, a.verification);
  if (!verified) a.verification.verdict = Verdict::notChecked;
  if (isSigned) readMembers(signatureTable(), row, c, a.signature.emplace());
  return a;
}

}  // namespace

std::int64_t attemptId(SQLite::Database& db, const std::string& uuid) {
  SQLite::Statement find(db, "SELECT id FROM attempt WHERE uuid = ?");
  find.bind(1, uuid);
  return find.executeStep() ? find.getColumn(0).getInt64() : -1;
}

std::optional<AttemptRow> findAttempt(SQLite::Database& db, const std::string& uuid) {
  SQLite::Statement select(db, selectAttempts("WHERE a.uuid = ?"));
  select.bind(1, uuid);
  if (!select.executeStep()) return std::nullopt;
  AttemptRow row = attemptRow(select);
  SQLite::Statement tags(db, "SELECT tag FROM attempt_tag WHERE attempt = ? ORDER BY tag");
  tags.bind(1, attemptId(db, uuid));
  while (tags.executeStep()) row.tags.push_back(text(tags.getColumn(0)));
  return row;
}

std::vector<AttemptRow> readAttempts(SQLite::Database& db) {
  SQLite::Statement select(db, selectAttempts("ORDER BY a.start_utc, a.uuid"));
  std::vector<AttemptRow> rows;
  while (select.executeStep()) rows.push_back(attemptRow(select));
  // Few have any: looking for them beside each attempt would cost more.
  std::map<std::string, std::vector<std::string>> tagsOf;
  SQLite::Statement tags(db, "SELECT a.uuid, t.tag FROM attempt_tag t JOIN attempt a ON a.id = t.attempt ORDER BY 2");
  while (tags.executeStep()) tagsOf[text(tags.getColumn(0))].push_back(text(tags.getColumn(1)));
  if (tagsOf.empty()) return rows;
  for (AttemptRow& row : rows) {
    if (const auto at = tagsOf.find(row.uuid); at != tagsOf.end()) row.tags = std::move(at->second);
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
