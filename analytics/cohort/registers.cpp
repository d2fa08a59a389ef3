// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/registers.h"

#include <fmt/format.h>

#include <algorithm>

#include "analytics/cohort/tables.h"

namespace calot::analytics {
namespace {

using namespace tables;

/// Adds a name to a table, and its note where one is given. @returns whether anything changed
bool put(SQLite::Database& db, const char* table, const std::string& name, const std::optional<std::string>& note) {
  const bool added =
      execute(db, fmt::format("INSERT INTO {} (name) VALUES (?) ON CONFLICT DO NOTHING", table), {name}) > 0;
  if (!note) return added;
  return execute(db, fmt::format("UPDATE {} SET note = ?1 WHERE name = ?2 AND note <> ?1", table), {*note, name}) > 0 ||
         added;
}

template <class Work>
void change(const std::string& path, const char* kind, const std::string& name, Work work) {
  checkName(fmt::format("{}: a name", kind), name);
  CohortConnection(path, CohortDatabase::Access::create).change([&](SQLite::Database& db) {
    std::string detail;
    if (work(db, detail)) audit(db, fmt::format("{}-set", kind), name, detail);
  });
}

}  // namespace

void setNamed(const std::string& path, const char* kind, const std::string& name,
              const std::optional<std::string>& note) {
  change(path, kind, name, [&](SQLite::Database& db, std::string&) { return put(db, kind, name, note); });
}

void setStation(const std::string& path, const std::string& name, const std::optional<std::string>& site,
                const std::optional<PublicKey>& key, const std::optional<std::string>& note) {
  if (site && !site->empty()) checkName("site: a name", *site);
  change(path, "station", name, [&](SQLite::Database& db, std::string& detail) {
    bool changed = put(db, "station", name, note);
    if (site) {
      if (!site->empty()) put(db, "site", *site, {});
      if (execute(db, "UPDATE station SET site = ?1 WHERE name = ?2 AND site <> ?1", {*site, name}) > 0) {
        changed = true;
        detail += fmt::format("site \"{}\"; ", *site);
      }
    }
    if (!key) return changed;
    const Cell wanted = blobOf(*key),
               known = firstColumn(db, "SELECT public_key FROM station WHERE name = ?", {name}).at(0);
    if (known == wanted) return changed;
    if (!isEmpty(known)) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("station \"{}\" has another key already; a station with a new key needs a new name, so "
                              "that old signatures keep their meaning",
                              name));
    }
    execute(db, "UPDATE station SET public_key = ? WHERE name = ?", {wanted, name});
    detail += "key registered; ";
    return true;
  });
}

void setCohort(const std::string& path, const std::string& name, const std::optional<std::string>& note,
               const std::vector<std::string>& add, const std::vector<std::string>& remove) {
  change(path, "cohort", name, [&](SQLite::Database& db, std::string& detail) {
    bool changed = put(db, "cohort", name, note);
    const auto each = [&](const std::vector<std::string>& who, const char* sql, const char* word) {
      for (const std::string& pseudonym : who) {
        const std::int64_t id = participantId(db, pseudonym);
        if (id < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no participant \"{}\"", pseudonym));
        if (execute(db, sql, {name, id}) == 0) continue;
        changed = true;
        detail += fmt::format("{} {}; ", word, pseudonym);
      }
    };
    each(add, "INSERT INTO cohort_participant VALUES (?, ?) ON CONFLICT DO NOTHING", "with");
    each(remove, "DELETE FROM cohort_participant WHERE cohort = ? AND participant = ?", "without");
    return changed;
  });
}

void setRater(const std::string& path, const std::string& name,
              const std::vector<std::pair<std::string, std::string>>& criteria) {
  change(path, "rater", name, [&](SQLite::Database& db, std::string& detail) {
    for (const auto& [criterion, value] : criteria) {
      checkName("rater: a criterion", criterion);
      if (execute(db,
                  "INSERT INTO rater VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET value = excluded.value WHERE value <> "
                  "excluded.value",
                  {name, criterion, value}) > 0)
        detail += criterion + "; ";
    }
    return !detail.empty();
  });
}

Registers readRegisters(const std::string& path) {
  return CohortConnection(path, CohortDatabase::Access::read).read([](SQLite::Database& db) {
    Registers r;
    const auto named = [&](const char* table, auto& to) {
      eachRow(db, fmt::format("SELECT name, note FROM {} ORDER BY name", table), {}, [&](SQLite::Statement& row) {
        auto& added = to.emplace_back();
        added.name = text(row.getColumn(0));
        added.note = text(row.getColumn(1));
      });
    };
    named("site", r.sites);
    named("arm", r.arms);
    named("cohort", r.cohorts);
    r.stations = selectRows(db, stationTable, "ORDER BY name");
    for (NamedCohort& cohort : r.cohorts) {
      cohort.participants = firstTexts(db,
                                       "SELECT p.pseudonym FROM cohort_participant c JOIN participant p ON p.id = "
                                       "c.participant WHERE c.cohort = ? ORDER BY 1",
                                       {cohort.name});
    }
    return r;
  });
}

KeyStanding standingOf(const Registers& registers, const std::string& station, const std::optional<PublicKey>& key) {
  const auto at = std::find_if(registers.stations.begin(), registers.stations.end(),
                               [&](const Station& s) { return s.name == station; });
  const bool registered = at != registers.stations.end() && at->publicKey;
  if (!key) return registered ? KeyStanding::unsignedButExpected : KeyStanding::unsignedAndUnknown;
  if (!registered) return KeyStanding::unregistered;
  return *key == *at->publicKey ? KeyStanding::known : KeyStanding::another;
}

}  // namespace calot::analytics
