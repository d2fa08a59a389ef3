// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts as the database lists them, and what people decide about them: exclusions and tags.

#include <fmt/format.h>
#include <algorithm>
#include <map>
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
    found->tags = firstTexts(db, "SELECT tag FROM attempt_tag WHERE attempt = ? ORDER BY tag", {attemptId(db, uuid)});
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
    throw Error(ErrorKind::invalid, "tag: one word of 1 to 40 characters is wanted, without blanks and commas");
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
