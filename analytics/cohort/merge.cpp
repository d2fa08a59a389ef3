// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/cohort_database.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "analytics/cohort/tables.h"
#include "analytics/cohort/withdraw.h"

namespace calot::analytics {
namespace {

using namespace tables;

/// Tables that are merged as attempts, not row by row.
bool ofAttempts(const std::string& table) {
  static const std::set<std::string> names{"attempt",      "recording",        "recording_signature",
                                           "verification", "checkpoint_value", "value_interval"};
  return names.contains(table);
}

/// Tables of one cohort as it was: the merged one is another, with a mask and a lock of its own.
bool belongsToOneCohort(const std::string& table) { return table == "group_mask" || table == "analysis_lock"; }

/// Tables whose empty entries say "not known".
bool mayBeFilled(const std::string& table) {
  static const std::set<std::string> names{"participant", "site", "arm", "station", "cohort"};
  return names.contains(table);
}

class Merge {
 public:
  Merge(SQLite::Database& into, std::string intoPath, SQLite::Database& from, std::string fromPath)
      : into_(into), from_(from), intoPath_(std::move(intoPath)), fromPath_(std::move(fromPath)) {}

  CohortMerge run() {
    theirs_ = guarded(fromPath_, [&] { return readAttempts(from_); });
    findSkipped();
    for (const TableFacts& table : readTables(into_)) {
      if (table.name == "attempt") {
        mergeAttempts();
      } else if (!ofAttempts(table.name) && !belongsToOneCohort(table.name)) {
        mergeTable(table);
      }
    }
    return std::move(result_);
  }

 private:
  /// Attempts withdrawn here stay out; attempts withdrawn there must first be withdrawn here.
  void findSkipped() {
    std::map<std::string, std::pair<int, int>> attemptsOf;  // pseudonym -> all, withdrawn
    for (const AttemptRow& a : theirs_) {
      const bool gone = isGone(a);
      if (gone) skippedWords_.push_back(a.uuid);
      if (a.participant.empty()) continue;
      ++attemptsOf[a.participant].first;
      attemptsOf[a.participant].second += gone ? 1 : 0;
    }
    result_.withdrawn = skippedWords_.size();
    for (const auto& [pseudonym, count] : attemptsOf) {
      if (count.first != count.second || participantId(into_, pseudonym) >= 0) continue;
      skippedParticipants_.insert(pseudonym);
      skippedWords_.push_back(pseudonym);
    }
    for (const AttemptRow& a : readAttempts(into_)) {
      if (guarded(fromPath_, [&] { return isWithdrawn(from_, a.uuid); })) {
        result_.conflicts.push_back(
            fmt::format("attempt {} of participant \"{}\" was withdrawn from {}; withdraw it from {} first", a.uuid,
                        a.participant, fromPath_, intoPath_));
      }
    }
  }

  bool isGone(const AttemptRow& a) const {
    return isWithdrawn(into_, a.uuid) || (!a.parent.empty() && isWithdrawn(into_, a.parent));
  }

  void mergeAttempts() {
    std::map<std::string, std::int64_t> number;
    guarded(fromPath_, [&] {
      eachRow(from_, "SELECT uuid, id FROM attempt", {},
              [&](SQLite::Statement& row) { number[text(row.getColumn(0))] = row.getColumn(1).getInt64(); });
    });
    for (const AttemptRow& a : theirs_) {
      checkAttempt(a, fromPath_);
      if (isGone(a)) continue;
      try {
        mergeAttempt(a, number[a.uuid]);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::refused) throw;
        result_.conflicts.emplace_back(error.what());
        continue;
      }
      numbers_["attempt"][number[a.uuid]] = attemptId(into_, a.uuid);
      mergeIntervals(a.uuid, number[a.uuid]);
    }
  }

  /// Theirs where there are none here: like values they can be made again, so that two sets are no conflict.
  void mergeIntervals(const std::string& uuid, std::int64_t number) {
    const std::int64_t id = attemptId(into_, uuid);
    if (!readIntervals(into_, id).empty()) return;
    const auto intervals = guarded(fromPath_, [&] { return readIntervals(from_, number); });
    if (replaceIntervals(into_, id, intervals)) result_.rows += intervals.size();
  }

  void mergeAttempt(const AttemptRow& a, std::int64_t number) {
    const std::vector<CheckpointValue> values = guarded(fromPath_, [&] { return readValues(from_, number); });
    const std::optional<AttemptRow> known = findAttempt(into_, a.uuid);
    if (!known) {
      importAttempt(into_, intoPath_, a, &values);
      ++result_.attempts;
      return;
    }
    AttemptRecord incoming = a;
    const bool same = known->chainHead == a.chainHead && known->steps == a.steps && known->complete == a.complete;
    const bool judgedThere = a.verification.verdict == Verdict::verified || !a.verification.text.empty();
    const bool judgedHere =
        known->verification.verdict != Verdict::notChecked && known->verification.verdict != Verdict::notCheckableHere;
    const std::vector<CheckpointValue>* taken = &values;
    if (same) {
      // File name and values are kept; identity of the attempt is still checked.
      incoming.fileName = known->fileName;
      if (judgedHere || !judgedThere) incoming.verification = known->verification;
      if (judgedHere || !readValues(into_, attemptId(into_, a.uuid)).empty()) taken = nullptr;
      if (known->signature) incoming.signature = known->signature;
    }
    if (importAttempt(into_, intoPath_, incoming, taken) == Imported::extended) ++result_.extended;
  }

  bool skipped(const TableFacts& table, const Row& row) const {
    if (table.name == "participant") return skippedParticipants_.count(textOf(row.at("pseudonym"))) > 0;
    if (table.name != "audit") return false;
    const std::string about = textOf(row.at("subject")), detail = textOf(row.at("detail"));
    return std::any_of(skippedWords_.begin(), skippedWords_.end(),
                       [&](const std::string& word) { return namesWord(about, word) || namesWord(detail, word); });
  }

  /// Maps row ids of the other database to those of this one. @returns false where such a row stayed out.
  bool translate(const TableFacts& table, Row& row) const {
    for (const ForeignKey& key : table.foreign) {
      const auto map = numbers_.find(key.parent);
      Cell& cell = row[key.column];
      if (map == numbers_.end() || !std::holds_alternative<std::int64_t>(cell)) continue;
      const auto at = map->second.find(std::get<std::int64_t>(cell));
      if (at == map->second.end()) return false;
      cell = at->second;
    }
    return true;
  }

  void mergeTable(const TableFacts& table) {
    if (!table.number.empty()) numbers_[table.name];
    const std::vector<Row> rows = guarded(fromPath_, [&] { return readRows(from_, table); });
    for (Row row : rows) {
      if (!skipped(table, row) && translate(table, row)) mergeRow(table, row);
    }
  }

  void mergeRow(const TableFacts& table, const Row& row) {
    const std::vector<Row> found = readRows(into_, table, whereKey(table), keyOf(table, row));
    const Row* here = found.empty() ? nullptr : &found.front();
    const std::int64_t there = table.number.empty() ? 0 : numberOf(row.at(table.number));
    if (here == nullptr) {
      const std::int64_t number = insert(table, row);
      if (!table.number.empty()) numbers_[table.name][there] = number;
      ++(table.name == "participant" ? result_.participants : table.name == "audit" ? result_.audit : result_.rows);
      return;
    }
    if (!table.number.empty()) numbers_[table.name][there] = numberOf(here->at(table.number));
    for (const ColumnFacts& c : table.columns) {
      const Cell &mine = here->at(c.name), &theirs = row.at(c.name);
      if (c.name == table.number || c.isTime() || mine == theirs) continue;
      if (mayBeFilled(table.name) && isEmpty(theirs)) continue;
      if (mayBeFilled(table.name) && isEmpty(mine)) {
        fill(table, row, c.name);
        continue;
      }
      std::vector<std::string> name;
      for (const std::string& k : table.key) name.push_back(named(table, k, row.at(k)));
      result_.conflicts.push_back(fmt::format("{} {}: {} is {} in {} and {} in {}", table.name, joined(name, ", "),
                                              c.name, shownCell(mine), intoPath_, shownCell(theirs), fromPath_));
    }
  }

  /// A key's entry in readable form: a pseudonym or uuid instead of a row id.
  std::string named(const TableFacts& table, const std::string& column, const Cell& cell) const {
    for (const ForeignKey& key : table.foreign) {
      if (key.column != column || !std::holds_alternative<std::int64_t>(cell)) continue;
      const char* word = key.parent == "attempt" ? "uuid" : key.parent == "participant" ? "pseudonym" : nullptr;
      if (word == nullptr) continue;
      const auto names =
          firstTexts(into_, fmt::format("SELECT {} FROM {} WHERE id = ?", word, quotedName(key.parent)), {cell});
      if (!names.empty()) return names.front();
    }
    return shownCell(cell);
  }

  std::string whereKey(const TableFacts& table) const {
    std::vector<std::string> tests;
    for (const std::string& k : table.key) tests.push_back(quotedName(k) + " IS ?");
    return joined(tests, " AND ");
  }

  static std::vector<Cell> keyOf(const TableFacts& table, const Row& row) {
    std::vector<Cell> key;
    for (const std::string& k : table.key) key.push_back(row.at(k));
    return key;
  }

  std::int64_t insert(const TableFacts& table, const Row& row) {
    std::vector<std::string> columns;
    std::vector<Cell> cells;
    for (const ColumnFacts& c : table.columns) {
      if (c.name == table.number) continue;
      columns.push_back(quotedName(c.name));
      cells.push_back(row.at(c.name));
    }
    execute(into_,
            fmt::format("INSERT INTO {} ({}) VALUES ({})", quotedName(table.name), joined(columns, ", "),
                        joined(std::vector<std::string>(cells.size(), "?"), ", ")),
            cells);
    return into_.getLastInsertRowid();
  }

  void fill(const TableFacts& table, const Row& row, const std::string& column) {
    std::vector<Cell> cells = keyOf(table, row);
    cells.insert(cells.begin(), row.at(column));
    execute(into_,
            fmt::format("UPDATE {} SET {} = ? WHERE {}", quotedName(table.name), quotedName(column), whereKey(table)),
            cells);
    ++result_.filled;
  }

  SQLite::Database &into_, &from_;
  std::string intoPath_, fromPath_;
  CohortMerge result_;
  std::vector<AttemptRow> theirs_;
  std::map<std::string, std::map<std::int64_t, std::int64_t>> numbers_;  ///< table -> number there -> number here
  std::set<std::string> skippedParticipants_;
  std::vector<std::string> skippedWords_;
};

}  // namespace

CohortMerge mergeCohorts(const std::string& into, const std::string& from) {
  std::error_code ignored;
  if (std::filesystem::equivalent(into, from, ignored))
    throw Error(ErrorKind::invalid, Where{from}, fmt::format("is {}; name two databases", into));
  const CohortConnection source(from, CohortDatabase::Access::read);
  return CohortConnection(into, CohortDatabase::Access::create).read([&](SQLite::Database& db) {
    const SQLite::Transaction reading(*source.db);  // one moment of it
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    CohortMerge merge = Merge(db, into, *source.db, from).run();
    if (!merge.conflicts.empty()) return merge;  // rolled back
    if (merge.changed()) {
      audit(db, "cohort-merge", std::filesystem::path(from).filename().string(),
            fmt::format("{} participants, {} attempts, {} extended, {} other rows, {} filled", merge.participants,
                        merge.attempts, merge.extended, merge.rows, merge.filled));
    }
    transaction.commit();
    return merge;
  });
}

}  // namespace calot::analytics
