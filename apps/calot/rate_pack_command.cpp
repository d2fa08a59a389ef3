// SPDX-License-Identifier: GPL-3.0-or-later
// calot rate pack: films and a form for raters who know neither whose attempt they see nor its group.
#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/rating_packs.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/intake/manifest_table.h"
#include "analytics/interchange/folder_output.h"
#include "analytics/report/rater_page.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/environment.h"
#include "apps/calot/rate_files.h"
#include "apps/common/exit_code.h"
#include "gui/film/film.h"
#include "gui/film/film_writer.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {
namespace {

/// Where the film of an attempt comes from.
struct FilmOrigin {
  std::string attempt;  ///< uuid
  std::filesystem::path file;
  bool isRecording = false;  ///< to be rendered
};

/// Films of attempts.
/// @param films a folder, in which a film has the uuid or the name of the recording or motion file (`.mp4`, `.mkv`,
/// `.webm`, `.mov`), and recordings without a film are rendered; or a CSV table with the columns `attempt` and `film`
/// @param chosen uuids or their beginnings; empty: every attempt that is not excluded, or every row of the table
/// @throws calot::Error (damaged) for an attempt without film, or a wrong row; (refused) for an attempt that is not
/// there
std::vector<FilmOrigin> findFilms(const analytics::CohortDatabase& cohort, const std::filesystem::path& films,
                                  const std::vector<std::string>& chosen);

namespace fs = std::filesystem;
using analytics::AttemptRow;

/// True if a file is a recording of this attempt.
bool isRecordingOf(const fs::path& file, const std::string& attempt) {
  std::error_code ignored;
  if (file.extension() != ".h5" || !fs::is_regular_file(file, ignored)) return false;
  recorder::probe(file);
  return recorder::Recording(file).header().attempt == attempt;
}

std::optional<FilmOrigin> filmIn(const fs::path& folder, const AttemptRow& attempt) {
  std::error_code ignored;
  const std::string stem = fs::path(attempt.fileName).stem().string();
  for (const std::string& name : {attempt.uuid, stem}) {
    for (const char* ending : {".mp4", ".mkv", ".webm", ".mov"}) {
      const fs::path film = folder / (name + ending);
      if (!name.empty() && fs::is_regular_file(film, ignored)) return FilmOrigin{attempt.uuid, film, false};
    }
  }
  const fs::path recording = folder / attempt.fileName;
  if (isRecordingOf(recording, attempt.uuid)) return FilmOrigin{attempt.uuid, recording, true};
  return std::nullopt;
}

std::vector<std::string> attemptsOf(const analytics::CohortDatabase& cohort, const std::vector<std::string>& chosen) {
  std::vector<std::string> uuids;
  std::set<std::string> seen;
  for (const std::string& name : chosen) {
    uuids.push_back(cohort.attemptNamed(name));
    if (!seen.insert(uuids.back()).second)
      throw Error(ErrorKind::invalid, fmt::format("rate: attempt {} is named twice", uuids.back()));
  }
  if (chosen.empty()) {
    for (const AttemptRow& a : cohort.listAttempts()) {
      if (!a.excluded) uuids.push_back(a.uuid);
    }
  }
  return uuids;
}

std::vector<FilmOrigin> filmsInTable(const analytics::CohortDatabase& cohort, const fs::path& path,
                                     const std::vector<std::string>& chosen) {
  const analytics::ManifestTable table(readCsvTable(path.string()), {"attempt", "film"});
  std::map<std::string, FilmOrigin> films;
  std::vector<std::string> order;
  for (const CsvRow& row : table.rows()) {
    const fs::path film = table.fileNamed(table.cell(row, "film"));
    std::error_code ignored;
    if (!fs::is_regular_file(film, ignored)) {
      throw table.fault(row, "film",
                        fmt::format("there is no file \"{}\"; paths are relative to the table",
                                    recorder::shown(table.cell(row, "film"))));
    }
    std::string uuid;
    try {
      uuid = cohort.attemptNamed(table.cell(row, "attempt"));
    } catch (const Error& e) {
      throw table.fault(row, "attempt", e.fault());
    }
    if (!films.emplace(uuid, FilmOrigin{uuid, film, isRecordingOf(film, uuid)}).second)
      throw table.fault(row, "attempt", "has a film in a row before; remove one");
    order.push_back(uuid);
  }
  std::vector<FilmOrigin> found;
  for (const std::string& uuid : chosen.empty() ? order : attemptsOf(cohort, chosen)) {
    const auto at = films.find(uuid);
    if (at == films.end())
      throw Error(ErrorKind::damaged, Where{path.string()}, fmt::format("has no film of attempt {}", uuid));
    found.push_back(at->second);
  }
  return found;
}

std::vector<FilmOrigin> findFilms(const analytics::CohortDatabase& cohort, const fs::path& films,
                                  const std::vector<std::string>& chosen) {
  std::error_code ignored;
  if (!fs::is_directory(films, ignored)) return filmsInTable(cohort, films, chosen);
  std::vector<FilmOrigin> found;
  for (const std::string& uuid : attemptsOf(cohort, chosen)) {
    const std::optional<FilmOrigin> film = filmIn(films, *cohort.attempt(uuid));
    if (!film) {
      throw Error(ErrorKind::damaged, Where{films.string()},
                  fmt::format("there is neither a film nor the recording of attempt {} ({}); add it, or leave the "
                              "attempt out with --attempts",
                              uuid, recorder::shown(cohort.attempt(uuid)->fileName)));
    }
    found.push_back(*film);
  }
  return found;
}

namespace fs = std::filesystem;

struct PackOptions {
  std::string database, form, films, output;
  std::vector<std::string> attempts, raters;
};

/// Raters' pseudonyms are names of folders.
void checkRaters(const std::vector<std::string>& raters) {
  std::set<std::string> seen;
  for (const std::string& rater : raters) {
    const bool plain = !rater.empty() && rater.size() <= 64 && rater.front() != '.' &&
                       std::all_of(rater.begin(), rater.end(), [](char c) {
                         return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                                c == '-' || c == '_' || c == '.';
                       });
    if (!plain || !seen.insert(rater).second) {
      throw Error(
          ErrorKind::invalid,
          fmt::format("rate: --raters: \"{}\": different pseudonyms of letters, digits, - and _ are wanted", rater));
    }
  }
}

void writeFilmTo(const fs::path& target, const FilmOrigin& origin) {
  if (!origin.isRecording) {
    gui::copyCleanFilm(origin.file, target);
    return;
  }
  gui::FilmSettings settings;
  settings.blinded = true;
  gui::writeFilm(origin.file, target, settings, [&](std::uint64_t, std::uint64_t) {
    if (stopRequested())
      throw Error(ErrorKind::failure, "rate: stopped before the pack was whole; nothing is left of it");
  });
}

/// One time for all files: their order in time would be that of the attempts.
void levelTimes(const fs::path& folder) {
  const auto day = std::chrono::floor<std::chrono::days>(fs::file_time_type::clock::now());
  std::error_code ignored;
  for (fs::recursive_directory_iterator it(folder, ignored), end; it != end; it.increment(ignored))
    fs::last_write_time(it->path(), day, ignored);
}

analytics::RatingPage pageOf(const analytics::RatingPack& pack, const analytics::PackedRater& rater,
                             const analytics::RatingForm& form) {
  analytics::RatingPage page{pack.id, rater.rater, form, {}};
  for (const analytics::PackedFilm& film : rater.films) page.films.push_back(film.name);
  return page;
}

int packForRaters(const PackOptions& o) {
  checkRaters(o.raters);
  const analytics::RatingForm form = analytics::readRatingForm(findAsset(o.form, "forms", "form"));
  if (!form.ofAttempts) throw Error(ErrorKind::invalid, fmt::format("rate: form {} is not about attempts", form.name));
  const std::vector<FilmOrigin> films =
      findFilms(analytics::CohortDatabase(o.database, analytics::CohortDatabase::Access::read), o.films, o.attempts);
  std::vector<std::string> attempts;
  std::map<std::string, const FilmOrigin*> originOf;
  for (const FilmOrigin& film : films) {
    attempts.push_back(film.attempt);
    originOf[film.attempt] = &film;
  }
  if (attempts.empty()) throw Error(ErrorKind::refused, Where{o.database}, "has no attempt to rate");

  const analytics::RatingPack pack =
      analytics::drawRatingPack({form.name, form.version, form.sha256, form.text}, o.raters, attempts);
  analytics::FolderOutput output(o.output);
  stopOnSignals();
  {
    Progress progress("packing, films");
    std::map<std::string, fs::path> first;  // each is encoded once
    std::size_t done = 0;
    for (const analytics::PackedRater& rater : pack.raters) {
      const fs::path folder = output.folder() / rater.rater / "films";
      fs::create_directories(folder);
      for (const analytics::PackedFilm& film : rater.films) {
        progress.show(done++, pack.raters.size() * films.size());
        const fs::path target = folder / (film.name + ".mp4");
        if (const auto [at, isNew] = first.emplace(film.attempt, target); isNew) {
          writeFilmTo(target, *originOf.at(film.attempt));
        } else {
          fs::copy_file(at->second, target);
        }
      }
      output.add(rater.rater + "/rate.html", analytics::ratingPageHtml(pageOf(pack, rater, form)));
    }
  }
  levelTimes(output.folder());
  // The key before the pack: a pack without one could not be taken back.
  analytics::storeRatingPack(o.database, pack);
  analytics::recordExport(o.database, "rating-pack", o.output, attempts);
  output.finish();
  std::cout << fmt::format(
      "{}: {} films for {} rater{} with {} version {}; give each the folder of their name, and "
      "store what comes back with calot rate {} --take answers-RATER.json\n",
      o.output, films.size(), o.raters.size(), o.raters.size() == 1 ? "" : "s", form.name, form.version, o.database);
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

CLI::App* addRatePack(CLI::App& rate, Run& run) {
  const auto o = std::make_shared<PackOptions>();
  CLI::App* command = rate.add_subcommand(
      "pack", "Pack films and a form for raters, under random names and in random order; the key stays in the cohort");
  addCohortOption(*command, o->database)->required();
  command->add_option("--form", o->form, "The form to fill in: its name, or a file")->required();
  command
      ->add_option("--films", o->films,
                   "A folder with the attempts' films or recordings, or a CSV table with columns attempt and film")
      ->required();
  command->add_option("--raters", o->raters, "Pseudonyms of the raters: R1,R2")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->required();
  command->add_option("--attempts", o->attempts, "Uuids, U1,U2 (default: all that are not excluded, or the table's)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("-o,--output", o->output, "The pack's folder, which must not exist")->required();
  command->callback([o, &run] { run = [o] { return packForRaters(*o); }; });
  return command;
}

}  // namespace calot::apps
