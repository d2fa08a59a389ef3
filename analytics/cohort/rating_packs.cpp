// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/rating_packs.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "analytics/cohort/tables.h"
#include "recorder/attempt.h"

namespace calot::analytics {
namespace {

using namespace tables;

constexpr auto packPatience = std::chrono::seconds(10);
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

PackedRater raterRow(SQLite::Statement& row) {
  PackedRater rater;
  rater.rater = text(row.getColumn(0));
  rater.takenUtc = text(row.getColumn(1));
  return rater;
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
  guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::write, packPatience);
    SQLite::Database& db = *handle;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement put(db, "INSERT INTO rating_pack VALUES (?, ?, ?, ?, ?, ?)");
    SQLite::bind(put, pack.id, pack.form.name, pack.form.version, pack.form.sha256, pack.form.text, nowUtc());
    put.exec();
    for (const PackedRater& rater : pack.raters) {
      checkPseudonym(rater.rater);
      // Earlier versions sealed the answers; the column stays, empty.
      SQLite::Statement who(db, "INSERT INTO rating_pack_rater (pack, rater, seal_key) VALUES (?, ?, zeroblob(32))");
      SQLite::bind(who, pack.id, rater.rater);
      who.exec();
      SQLite::Statement film(db, "INSERT INTO rating_pack_film VALUES (?, ?, ?, ?, ?)");
      for (std::size_t i = 0; i < rater.films.size(); ++i) {
        const std::int64_t attempt = attemptId(db, rater.films[i].attempt);
        if (attempt < 0)
          throw Error(ErrorKind::refused, Where{path}, fmt::format("no attempt {}", rater.films[i].attempt));
        film.reset();
        SQLite::bind(film, pack.id, rater.rater, rater.films[i].name, static_cast<std::int64_t>(i), attempt);
        film.exec();
      }
    }
    audit(db, "rating-pack", pack.id, fmt::format("{} {}", pack.form.name, pack.form.version));
    transaction.commit();
  });
}

std::optional<RatingPack> readRatingPack(const std::string& path, const std::string& id) {
  return guarded(path, [&]() -> std::optional<RatingPack> {
    const auto handle = openCohort(path, CohortDatabase::Access::write, packPatience);
    SQLite::Database& db = *handle;
    SQLite::Statement find(db, "SELECT form, form_version, form_sha256, form_text FROM rating_pack WHERE id = ?");
    find.bind(1, id);
    if (!find.executeStep()) return std::nullopt;
    RatingPack pack{
        id,
        {text(find.getColumn(0)), find.getColumn(1).getUInt(), text(find.getColumn(2)), text(find.getColumn(3))},
        {}};
    SQLite::Statement raters(db, "SELECT rater, taken_utc FROM rating_pack_rater WHERE pack = ? ORDER BY rater");
    raters.bind(1, id);
    while (raters.executeStep()) pack.raters.push_back(raterRow(raters));
    SQLite::Statement films(db,
                            "SELECT f.name, a.uuid FROM rating_pack_film f JOIN attempt a ON a.id = f.attempt WHERE "
                            "f.pack = ? AND f.rater = ? ORDER BY f.position");
    for (PackedRater& rater : pack.raters) {
      films.reset();
      SQLite::bind(films, id, rater.rater);
      while (films.executeStep()) rater.films.push_back({text(films.getColumn(0)), text(films.getColumn(1))});
    }
    return pack;
  });
}

void storePackAnswers(const std::string& path, const RatingPack& pack, const std::string& rater,
                      const std::vector<Rating>& ratings, bool replace) {
  guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::write, packPatience);
    SQLite::Database& db = *handle;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement find(db, "SELECT taken_utc FROM rating_pack_rater WHERE pack = ? AND rater = ?");
    SQLite::bind(find, pack.id, rater);
    const std::string taken = find.executeStep() ? text(find.getColumn(0)) : std::string();
    if (!taken.empty() && !replace) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("answers of rater \"{}\" to this pack were stored on {}", rater, taken),
                  {Remedy::replaceExisting});
    }
    for (const Rating& rating : ratings) putRating(db, path, pack.form, rating, replace);
    SQLite::Statement mark(db, "UPDATE rating_pack_rater SET taken_utc = ? WHERE pack = ? AND rater = ?");
    SQLite::bind(mark, nowUtc(), pack.id, rater);
    mark.exec();
    transaction.commit();
  });
}

}  // namespace calot::analytics
