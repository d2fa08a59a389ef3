// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/registers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/row_statements.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics {
namespace {

using namespace tables;

constexpr auto patience = std::chrono::seconds(10);

void checkName(const char* what, const std::string& name) {
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  if (name.empty() || name.size() > 64 || name.front() == ' ' || name.back() == ' ' ||
      std::any_of(name.begin(), name.end(), control)) {
    throw Error(ErrorKind::invalid,
                fmt::format("{}: a name has 1 to 64 characters, no control characters and no blank at its ends", what));
  }
}

/// Adds a name to a table, and its note where one is given. @returns whether anything changed
bool put(SQLite::Database& db, const char* table, const std::string& name, const std::optional<std::string>& note) {
  SQLite::Statement add(db, fmt::format("INSERT INTO {} (name) VALUES (?) ON CONFLICT DO NOTHING", table));
  add.bind(1, name);
  bool changed = add.exec() > 0;
  if (note) {
    SQLite::Statement set(db, fmt::format("UPDATE {} SET note = ?1 WHERE name = ?2 AND note <> ?1", table));
    SQLite::bind(set, *note, name);
    changed = set.exec() > 0 || changed;
  }
  return changed;
}

template <class Work>
void change(const std::string& path, const char* kind, const std::string& name, Work work) {
  checkName(kind, name);
  guarded(path, [&] {
    const auto db = openCohort(path, CohortDatabase::Access::create, patience);
    SQLite::Transaction transaction(*db, SQLite::TransactionBehavior::IMMEDIATE);
    std::string detail;
    if (work(*db, detail)) audit(*db, fmt::format("{}-set", kind), name, detail);
    transaction.commit();
  });
}

}  // namespace

void setSite(const std::string& path, const std::string& name, const std::optional<std::string>& note) {
  change(path, "site", name, [&](SQLite::Database& db, std::string&) { return put(db, "site", name, note); });
}

void setArm(const std::string& path, const std::string& name, const std::optional<std::string>& note) {
  change(path, "arm", name, [&](SQLite::Database& db, std::string&) { return put(db, "arm", name, note); });
}

void setStation(const std::string& path, const std::string& name, const std::optional<std::string>& site,
                const std::optional<PublicKey>& key, const std::optional<std::string>& note) {
  if (site && !site->empty()) checkName("site", *site);
  change(path, "station", name, [&](SQLite::Database& db, std::string& detail) {
    bool changed = put(db, "station", name, note);
    if (site) {
      if (!site->empty()) put(db, "site", *site, {});
      SQLite::Statement set(db, "UPDATE station SET site = ?1 WHERE name = ?2 AND site <> ?1");
      SQLite::bind(set, *site, name);
      if (set.exec() > 0) {
        changed = true;
        detail += fmt::format("site \"{}\"; ", *site);
      }
    }
    if (key) {
      SQLite::Statement known(db, "SELECT public_key FROM station WHERE name = ?");
      known.bind(1, name);
      known.executeStep();
      const SQLite::Column column = known.getColumn(0);
      const bool there = !column.isNull();
      if (there && std::memcmp(column.getBlob(), key->data(), key->size()) != 0) {
        throw Error(ErrorKind::refused, Where{path},
                    fmt::format("station \"{}\" has another key already; a station with a new key needs a new name, so "
                                "that old signatures keep their meaning",
                                name));
      }
      if (!there) {
        SQLite::Statement set(db, "UPDATE station SET public_key = ? WHERE name = ?");
        set.bind(1, key->data(), static_cast<int>(key->size()));
        set.bind(2, name);
        set.exec();
        changed = true;
        detail += "key registered; ";
      }
    }
    return changed;
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
        SQLite::Statement one(db, sql);
        SQLite::bind(one, name, id);
        if (one.exec() == 0) continue;
        changed = true;
        detail += fmt::format("{} {}; ", word, pseudonym);
      }
    };
    each(add, "INSERT INTO cohort_participant VALUES (?, ?) ON CONFLICT DO NOTHING", "with");
    each(remove, "DELETE FROM cohort_participant WHERE cohort = ? AND participant = ?", "without");
    return changed;
  });
}

Registers readRegisters(const std::string& path) {
  return guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::read, patience);
    SQLite::Database& db = *handle;
    Registers r;
    const auto named = [&](const char* sql, std::vector<Named>& to) {
      SQLite::Statement read(db, sql);
      while (read.executeStep()) to.push_back({text(read.getColumn(0)), text(read.getColumn(1))});
    };
    named("SELECT name, note FROM site ORDER BY name", r.sites);
    named("SELECT name, note FROM arm ORDER BY name", r.arms);
    r.stations = selectRows(db, stationTable(), "ORDER BY name");
    SQLite::Statement cohorts(db, "SELECT name, note FROM cohort ORDER BY name");
    while (cohorts.executeStep()) r.cohorts.push_back({text(cohorts.getColumn(0)), text(cohorts.getColumn(1)), {}});
    SQLite::Statement members(db,
                              "SELECT p.pseudonym FROM cohort_participant c JOIN participant p ON p.id = "
                              "c.participant WHERE c.cohort = ? ORDER BY 1");
    for (NamedCohort& cohort : r.cohorts) {
      members.reset();
      members.bind(1, cohort.name);
      while (members.executeStep()) cohort.participants.push_back(text(members.getColumn(0)));
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
