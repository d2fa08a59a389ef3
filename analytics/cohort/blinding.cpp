// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/blinding.h"

#include <fmt/format.h>
#include <sodium.h>
#include <algorithm>
#include <set>
#include <utility>

#include "analytics/cohort/tables.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

using namespace tables;

std::optional<bool> findMask(SQLite::Database& db, const std::string& protocol) {
  const std::int64_t swapped = firstNumber(db, "SELECT swapped FROM group_mask WHERE protocol_sha256 = ?", {protocol});
  return swapped < 0 ? std::nullopt : std::optional(swapped != 0);
}

std::optional<AnalysisLock> findLock(SQLite::Database& db, const std::string& protocol) {
  const auto locks = selectRows(db, analysisLockTable, "WHERE protocol_sha256 = ?", {protocol});
  return locks.empty() ? std::nullopt : std::optional(locks.front());
}

}  // namespace

std::optional<bool> readGroupMask(const std::string& path, const std::string& protocolSha256) {
  return CohortConnection(path, CohortDatabase::Access::read).read([&](SQLite::Database& db) {
    return findMask(db, protocolSha256);
  });
}

void refuseWhileMasked(const std::string& path, const std::string& protocolSha256) {
  const std::vector<std::string> masked =
      CohortConnection(path, CohortDatabase::Access::read).read([&](SQLite::Database& db) {
        return firstTexts(db,
                          "SELECT coalesce((SELECT name || ' version ' || version FROM protocol p WHERE p.sha256 = "
                          "m.protocol_sha256), m.protocol_sha256) FROM group_mask m WHERE m.protocol_sha256 <> ? AND "
                          "m.protocol_sha256 NOT IN (SELECT protocol_sha256 FROM analysis_lock) ORDER BY drawn_utc",
                          {protocolSha256});
      });
  if (masked.empty()) return;
  throw Error(ErrorKind::refused, Where{path},
              fmt::format("the groups are masked until the analysis of protocol {} is locked; this analysis would name "
                          "them, make the study by that protocol",
                          masked.front()));
}

bool drawGroupMask(const std::string& path, const std::string& protocolSha256) {
  [[maybe_unused]] static const int ready = sodium_init();
  return CohortConnection(path, CohortDatabase::Access::write).change([&](SQLite::Database& db) {
    if (const std::optional<bool> known = findMask(db, protocolSha256)) return *known;
    const bool swapped = randombytes_uniform(2) == 1;
    execute(db, "INSERT INTO group_mask VALUES (?, ?, ?)", {protocolSha256, swapped ? 1 : 0, nowUtc()});
    audit(db, "group-mask", protocolSha256, "");
    return swapped;
  });
}

std::optional<AnalysisLock> readAnalysisLock(const std::string& path, const std::string& protocolSha256) {
  return CohortConnection(path, CohortDatabase::Access::read).read([&](SQLite::Database& db) {
    return findLock(db, protocolSha256);
  });
}

AnalysisLock storeAnalysisLock(const std::string& path, const AnalysisLock& lock, bool& added) {
  if (lock.by.empty()) throw Error(ErrorKind::invalid, "protocol: name who locks the analysis");
  return CohortConnection(path, CohortDatabase::Access::write).change([&](SQLite::Database& db) {
    const std::optional<AnalysisLock> known = findLock(db, lock.protocolSha256);
    added = !known;
    if (known) return *known;
    AnalysisLock fresh = lock;
    fresh.lockedUtc = nowUtc();
    InsertOf(db, analysisLockTable)(fresh);
    audit(db, "analysis-lock", fresh.protocol, fmt::format("values {} (by {})", fresh.valuesSha256, fresh.by));
    return fresh;
  });
}

std::uint64_t studyRuns(const std::string& path, const std::string& protocolSha256, const std::string& note) {
  CohortConnection cohort(path, note.empty() ? CohortDatabase::Access::read : CohortDatabase::Access::write);
  if (!note.empty()) cohort.change([&](SQLite::Database& db) { audit(db, "study-run", protocolSha256, note); });
  return cohort.read([&](SQLite::Database& db) {
    return static_cast<std::uint64_t>(
        firstNumber(db, "SELECT count(*) FROM audit WHERE action = 'study-run' AND subject = ?", {protocolSha256}));
  });
}

namespace {

constexpr std::size_t nameLetters = 6;

/// Without vowels, so that no name is a word, and without letters that look alike.
std::string drawName() {
  static constexpr char letters[] = "bcdfghjkmnpqrstvwxz2345679";
  std::string name;
  for (std::size_t i = 0; i < nameLetters; ++i) name += letters[randombytes_uniform(sizeof letters - 1)];
  return name;
}

/// Fisher and Yates.
template <class T>
void shuffle(std::vector<T>& items) {
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[randombytes_uniform(static_cast<std::uint32_t>(i))]);
}

}  // namespace

RatingPack drawRatingPack(const StoredDocument& form, const std::vector<std::string>& raters,
                          const std::vector<std::string>& attempts) {
  [[maybe_unused]] static const int ready = sodium_init();
  RatingPack pack{recorder::newUuid(), form, {}};
  std::set<std::string> taken;
  for (const std::string& name : raters) {
    PackedRater& rater = pack.raters.emplace_back();
    rater.rater = name;
    for (const std::string& attempt : attempts) {
      std::string film = drawName();
      while (!taken.insert(film).second) film = drawName();
      rater.films.push_back({film, attempt});
    }
    shuffle(rater.films);
  }
  return pack;
}

void storeRatingPack(const std::string& path, const RatingPack& pack) {
  CohortConnection(path, CohortDatabase::Access::write).change([&](SQLite::Database& db) {
    execute(db, "INSERT INTO rating_pack VALUES (?, ?, ?, ?, ?, ?)",
            {pack.id, pack.form.name, pack.form.version, pack.form.sha256, pack.form.text, nowUtc()});
    for (const PackedRater& rater : pack.raters) {
      checkPseudonym(rater.rater);
      // Earlier versions sealed the answers; the column stays, empty.
      execute(db, "INSERT INTO rating_pack_rater (pack, rater, seal_key) VALUES (?, ?, zeroblob(32))",
              {pack.id, rater.rater});
      std::int64_t position = 0;
      for (const PackedFilm& film : rater.films) {
        execute(db, "INSERT INTO rating_pack_film VALUES (?, ?, ?, ?, ?)",
                {pack.id, rater.rater, film.name, position++, knownAttempt(db, path, film.attempt)});
      }
    }
    audit(db, "rating-pack", pack.id, fmt::format("{} {}", pack.form.name, pack.form.version));
  });
}

std::optional<RatingPack> readRatingPack(const std::string& path, const std::string& id) {
  return CohortConnection(path, CohortDatabase::Access::write).read([&](SQLite::Database& db) {
    std::optional<RatingPack> pack;
    eachRow(db, "SELECT form, form_version, form_sha256, form_text FROM rating_pack WHERE id = ?", {id},
            [&](SQLite::Statement& row) {
              pack = {
                  id,
                  {text(row.getColumn(0)), row.getColumn(1).getUInt(), text(row.getColumn(2)), text(row.getColumn(3))},
                  {}};
            });
    eachRow(db, "SELECT rater FROM rating_pack_rater WHERE pack = ? ORDER BY rater", {id}, [&](SQLite::Statement& row) {
      pack->raters.push_back({text(row.getColumn(0)), {}});
    });
    if (!pack) return pack;
    for (PackedRater& rater : pack->raters) {
      eachRow(db,
              "SELECT f.name, a.uuid FROM rating_pack_film f JOIN attempt a ON a.id = f.attempt WHERE f.pack = ? AND "
              "f.rater = ? ORDER BY f.position",
              {id, rater.rater}, [&](SQLite::Statement& row) {
                rater.films.push_back({text(row.getColumn(0)), text(row.getColumn(1))});
              });
    }
    return pack;
  });
}

void storePackAnswers(const std::string& path, const RatingPack& pack, const std::string& rater,
                      const std::vector<Rating>& ratings, bool replace) {
  CohortConnection(path, CohortDatabase::Access::write).change([&](SQLite::Database& db) {
    const std::vector<std::string> taken =
        firstTexts(db, "SELECT taken_utc FROM rating_pack_rater WHERE pack = ? AND rater = ? AND taken_utc <> ''",
                   {pack.id, rater});
    if (!taken.empty() && !replace) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("answers of rater \"{}\" to this pack were stored on {}", rater, taken.front()),
                  {Remedy::replaceExisting});
    }
    for (const Rating& rating : ratings) putRating(db, path, pack.form, rating, replace);
    execute(db, "UPDATE rating_pack_rater SET taken_utc = ? WHERE pack = ? AND rater = ?", {nowUtc(), pack.id, rater});
  });
}

}  // namespace calot::analytics
