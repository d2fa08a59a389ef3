// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/pack_films.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "analytics/intake/manifest_table.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {
namespace {

namespace fs = std::filesystem;
using analytics::AttemptRow;

/// Whether a file is a recording of this attempt.
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

}  // namespace

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

}  // namespace calot::apps
