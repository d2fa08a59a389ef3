// SPDX-License-Identifier: GPL-3.0-or-later
// calot rate: what people judge, by forms.
// calot rate pack: films and a form for raters who know neither whose attempt they see nor its group.

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/blinding.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/intake/manifests.h"
#include "analytics/interchange/folder_output.h"
#include "analytics/report/rater_page.h"
#include "analytics/report/ratings.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "gui/film/film.h"
#include "gui/film/film_writer.h"
#include "recorder/base/counted.h"
#include "recorder/base/files.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {
namespace {

using Access = analytics::CohortDatabase::Access;
using Given = std::vector<std::pair<std::string, std::string>>;

struct RateOptions {
  std::string database, form, attempt, rater, participant, answersFile, manifest, taken;
  std::vector<std::string> answers, described;
  recorder::SimilarNames similarNames = recorder::SimilarNames::ask;
  bool forms = false, json = false, force = false;
};

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorKind::invalid, "rate: " + what); }

void listForms(const RateOptions& o) {
  Json rows = Json::array();
  std::string text;
  for (const std::filesystem::path& file : listAssets("forms")) {
    const analytics::RatingForm form = analytics::readRatingForm(file);
    const std::string head = fmt::format("{} version {}: {} ({}, {} to {})", form.name, form.version, form.title,
                                         form.ofAttempts ? "of attempts" : "of the simulator", form.least, form.most);
    text += wrappedText(head, terminalColumns(), 4) + '\n';
    Json items = Json::array();
    for (const analytics::FormItem& item : form.items()) {
      items.push_back({{"item", item.key}, {"text", item.text}});
      text += fmt::format("  {}  {}\n", item.key, item.text);
    }
    rows.push_back({{"form", form.name},
                    {"version", form.version},
                    {"title", form.title},
                    {"source", form.source},
                    {"about", form.ofAttempts ? "attempt" : "simulator"},
                    {"least", form.least},
                    {"most", form.most},
                    {"items", items}});
  }
  printResult(o.json, "forms", {{"forms", rows}}, text);
}

/// A JSON object of items and scores; null where an item was left blank.
Given readAnswers(const std::string& file) {
  const std::filesystem::path path(file);
  const std::string name = path.filename().string();
  const nlohmann::json json =
      recorder::parseStrictJson(recorder::readFileBytes(path, name, std::size_t{1} << 20U), name);
  if (!json.is_object()) throw Error(ErrorKind::damaged, Where{name}, "/: an object of items and scores is expected");
  Given given;
  for (const auto& item : json.items()) {
    if (!item.value().is_null() && !item.value().is_number_integer())
      throw Error(ErrorKind::damaged, Where{name}, "an item's score is a whole number, or null");
    given.emplace_back(item.key(), item.value().is_null() ? "-" : item.value().dump());
  }
  return given;
}

/// "ITEM=SCORE" of each. @param form as messages show it
Given readItems(const std::vector<std::string>& items, const char* option, const char* form) {
  Given given;
  for (const std::string& item : items) {
    const std::size_t at = item.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == item.size())
      fail(fmt::format("{} {}: {} is expected", option, recorder::shown(item), form));
    given.emplace_back(item.substr(0, at), item.substr(at + 1));
  }
  return given;
}

void storeAnswers(const RateOptions& o) {
  const analytics::RatingForm form = analytics::readRatingForm(findAsset(o.form, "forms", "form"));
  if (form.ofAttempts && (o.attempt.empty() || o.rater.empty() || !o.participant.empty()))
    fail(fmt::format("form {} is about an attempt: name --attempt and --rater", form.name));
  if (!form.ofAttempts && (o.participant.empty() || !o.attempt.empty() || !o.rater.empty()))
    fail(fmt::format("form {} is filled in by a participant: name --participant alone", form.name));
  if (o.answersFile.empty() == o.answers.empty()) fail("give the answers by --answer or by --answers");
  analytics::Rating rating;
  rating.attempt = o.attempt;
  rating.rater = o.rater;
  rating.participant = o.participant;
  rating.answers = analytics::answersOf(
      form, o.answersFile.empty() ? readItems(o.answers, "--answer", "ITEM=SCORE") : readAnswers(o.answersFile));
  analytics::CohortDatabase database(o.database, Access::write);
  database.storeRating({form.name, form.version, form.sha256, form.text}, rating, o.force);
  fmt::print("{}: {} version {} of {}, {} of {} items answered\n", o.database, form.name, form.version,
             form.ofAttempts ? "attempt " + o.attempt : "participant " + o.participant, rating.answers.size(),
             form.items().size());
}

void describeRater(const RateOptions& o) {
  if (o.rater.empty() || !(o.form + o.attempt + o.participant + o.answersFile).empty() || !o.answers.empty())
    fail("--describe goes with --rater alone");
  const analytics::CohortDatabase database(o.database, Access::write);  // it is there
  analytics::setRater(o.database, o.rater, readItems(o.described, "--describe", "CRITERION=TEXT"));
  fmt::print("{}: rater {} described\n", o.database, o.rater);
}

void showRatings(const RateOptions& o) {
  const analytics::CohortDatabase cohort(o.database, Access::read);
  std::map<std::string, std::string> groupOf;
  std::set<std::string> groups;
  for (const analytics::Participant& p : cohort.participants()) groupOf[p.pseudonym] = p.group;
  std::map<std::string, analytics::AttemptOf> attemptOf;
  for (const analytics::AttemptRow& a : cohort.listAttempts()) {
    groupOf[a.uuid] = a.group;
    attemptOf[a.uuid] = {a.participant, a.startUtc};
  }
  for (const analytics::Rating& r : cohort.ratings()) {
    const auto at = groupOf.find(r.attempt.empty() ? r.participant : r.attempt);
    if (at != groupOf.end()) groups.insert(at->second);
  }
  const std::vector<analytics::FormReport> reports =
      analytics::reportForms(cohort, groupOf, {groups.begin(), groups.end()}, attemptOf);
  printResult(o.json, "ratings", {{"forms", analytics::ratingsTree(reports)}}, [&](std::ostream& out) {
    if (reports.empty()) out << "no ratings\n";
    for (const analytics::FormReport& report : reports) {
      for (const analytics::ReportTable& table : analytics::ratingTables(report)) analytics::printTable(table, out);
      for (const std::string& note : analytics::ratingNotes(report)) analytics::printWrapped(note, out);
      if (report.filled > 0) out << '\n';
    }
  });
}

ExitCode storeRatingManifest(const RateOptions& o) {
  const auto find = [](const std::string& name) { return findAsset(name, "forms", "form"); };
  std::vector<Error> faults;
  const analytics::RatingManifest read = analytics::readRatingManifest(
      o.manifest, o.form, find, analytics::CohortDatabase(o.database, Access::read), o.similarNames, faults);
  if (!faults.empty()) return refuseRows(faults);
  analytics::CohortDatabase database(o.database, Access::write);
  const analytics::StoredRatings stored = analytics::storeRatings(database, read, o.force, faults);
  if (!faults.empty()) return refuseRows(faults);
  const Json row{{"manifest", o.manifest},
                 {"ratings", read.rows.size()},
                 {"added", stored.added},
                 {"unchanged", stored.unchanged},
                 {"replaced", stored.replaced}};
  printResult(
      o.json, "rate-manifest", row,
      fmt::format("{}: {}: {} added, {} unchanged, {} replaced\n", o.manifest,
                  recorder::counted(read.rows.size(), "rating"), stored.added, stored.unchanged, stored.replaced));
  return ExitCode::yes;
}

void takePackAnswers(const RateOptions& o) {
  const analytics::PackAnswers answers = analytics::readPackAnswers(
      o.taken, [&](const std::string& id) { return analytics::readRatingPack(o.database, id); });
  analytics::storePackAnswers(o.database, answers.pack, answers.rater, answers.ratings, o.force);
  fmt::print("{}: {} by {} with {} version {} stored", o.taken, recorder::counted(answers.ratings.size(), "rating"),
             answers.rater, answers.form.name, answers.form.version);
  if (answers.notJudged > 0) fmt::print(", {} films could not be judged", answers.notJudged);
  if (answers.withdrawn > 0) fmt::print(", {} films of withdrawn attempts left out", answers.withdrawn);
  std::cout << '\n';
}

/// Source of the film of an attempt.
struct FilmOrigin {
  std::string attempt;  ///< uuid
  std::filesystem::path file;
  bool isRecording = false;  ///< to be rendered
};

namespace fs = std::filesystem;
using analytics::AttemptRow;

/// True if a file is a recording of this attempt.
bool isRecordingOf(const fs::path& file, const std::string& attempt) {
  std::error_code ignored;
  if (file.extension() != ".h5" || !fs::is_regular_file(file, ignored)) return false;
  recorder::probe(file);
  return recorder::Recording(file).header().attempt == attempt;
}

/// @param recordings films do not serve
std::optional<FilmOrigin> filmIn(const fs::path& folder, const AttemptRow& attempt, bool recordings) {
  std::error_code ignored;
  const std::string stem = fs::path(attempt.fileName).stem().string();
  for (const std::string& name : {attempt.uuid, stem}) {
    if (recordings) break;
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
      const bool consented =
          std::none_of(a.leftOut.begin(), a.leftOut.end(), [](const auto& out) { return out.rule == "consent"; });
      if (!a.excluded && consented) uuids.push_back(a.uuid);
    }
  }
  return uuids;
}

std::vector<FilmOrigin> filmsInTable(const analytics::CohortDatabase& cohort, const fs::path& path,
                                     const std::vector<std::string>& chosen) {
  const analytics::ManifestTable table(readCsvTable(path.string()), {"attempt", "film"});
  std::vector<FilmOrigin> films;
  const auto filmOf = [&](const std::string& uuid) {
    return std::find_if(films.begin(), films.end(), [&](const FilmOrigin& film) { return film.attempt == uuid; });
  };
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
      uuid = analytics::attemptInTable(cohort, table.cell(row, "attempt"));
    } catch (const Error& e) {
      throw table.fault(row, "attempt", e.fault());
    }
    if (filmOf(uuid) != films.end()) throw table.fault(row, "attempt", "has a film in a row before; remove one");
    films.push_back({uuid, film, isRecordingOf(film, uuid)});
  }
  if (chosen.empty()) return films;
  std::vector<FilmOrigin> found;
  for (const std::string& uuid : attemptsOf(cohort, chosen)) {
    const auto at = filmOf(uuid);
    if (at == films.end())
      throw Error(ErrorKind::damaged, Where{path.string()}, fmt::format("has no film of attempt {}", uuid));
    found.push_back(*at);
  }
  return found;
}

/// Films of attempts.
/// @param films a folder, in which a film has the uuid or the name of the recording or motion file (`.mp4`, `.mkv`,
/// `.webm`, `.mov`), and recordings without a film are rendered; or a CSV table with the columns `attempt` and `film`
/// @param chosen uuids or their beginnings; empty: every attempt that is neither excluded nor without consent, or every
/// row of the table
/// @param doublets recordings alone, of attempts whose critical view was scored
/// @throws calot::Error (damaged) for an attempt without film, or a wrong row; (refused) for an attempt that is not
/// there
std::vector<FilmOrigin> findFilms(const analytics::CohortDatabase& cohort, const fs::path& films,
                                  const std::vector<std::string>& chosen, bool doublets) {
  std::error_code ignored;
  if (!fs::is_directory(films, ignored)) return filmsInTable(cohort, films, chosen);
  std::vector<FilmOrigin> found;
  for (const std::string& uuid : attemptsOf(cohort, chosen)) {
    const std::vector<analytics::CheckpointValue> values = cohort.values(uuid);
    if (doublets &&
        std::none_of(values.begin(), values.end(), [](const auto& v) { return v.name == "critical-view" && v.value; }))
      continue;
    const std::optional<FilmOrigin> film = filmIn(films, *cohort.attempt(uuid), doublets);
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

struct PackOptions {
  std::string database, form, films, output;
  std::vector<std::string> attempts, raters;
};

/// Raters' pseudonyms are names of folders.
void checkRaters(const std::vector<std::string>& raters) {
  constexpr const char* letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  std::set<std::string> seen;
  for (const std::string& rater : raters) {
    const bool plain = !rater.empty() && rater.size() <= 64 && rater.front() != '.' &&
                       rater.find_first_not_of(letters) == std::string::npos;
    if (!plain || !seen.insert(rater).second) {
      throw Error(
          ErrorKind::invalid,
          fmt::format("rate: --raters: \"{}\": different pseudonyms of letters, digits, - and _ are expected", rater));
    }
  }
}

void writeFilmTo(const fs::path& target, const FilmOrigin& origin, bool doublet) {
  gui::FilmSettings settings;
  settings.blinded = true;
  if (doublet) {
    settings.size = {1600, 600};
    settings.quality = gui::Quality::film;
    if (!origin.isRecording || !gui::writeDoublet(origin.file, target, settings))
      throw Error(ErrorKind::refused, Where{origin.file.string()},
                  "is no recording with a clip: its critical view cannot be shown");
    return;
  }
  if (!origin.isRecording) {
    gui::copyCleanFilm(origin.file, target);
    return;
  }
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

void packForRaters(const PackOptions& o) {
  checkRaters(o.raters);
  const analytics::RatingForm form = analytics::readRatingForm(findAsset(o.form, "forms", "form"));
  if (!form.ofAttempts) throw Error(ErrorKind::invalid, fmt::format("rate: form {} is not about attempts", form.name));
  const std::vector<FilmOrigin> films =
      findFilms(analytics::CohortDatabase(o.database, Access::read), o.films, o.attempts, form.ofDoublets);
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
    Progress progress("Packing", false, "films");
    std::map<std::string, fs::path> first;  // each is encoded once
    std::size_t done = 0;
    for (const analytics::PackedRater& rater : pack.raters) {
      const fs::path folder = output.folder() / rater.rater / "films";
      fs::create_directories(folder);
      for (const analytics::PackedFilm& film : rater.films) {
        progress.show(done++, pack.raters.size() * films.size());
        const fs::path target = folder / (film.name + (form.ofDoublets ? ".png" : ".mp4"));
        if (const auto [at, isNew] = first.emplace(film.attempt, target); isNew) {
          writeFilmTo(target, *originOf.at(film.attempt), form.ofDoublets);
        } else {
          fs::copy_file(at->second, target);
        }
      }
      analytics::RatingPage page{pack.id, rater.rater, form, {}};
      for (const analytics::PackedFilm& film : rater.films) page.films.push_back(film.name);
      output.add(rater.rater + "/rate.html", analytics::ratingPageHtml(page));
    }
  }
  levelTimes(output.folder());
  // The key before the pack: a pack without one could not be taken back.
  analytics::storeRatingPack(o.database, pack);
  analytics::recordExport(o.database, "rating-pack", o.output, attempts);
  output.finish();
  fmt::print(
      "{}: {} {} for {} rater{} with {} version {}; give each the folder of their name, and "
      "store what comes back with calot rate {} --take answers-RATER.json\n",
      o.output, films.size(), (form.ofDoublets ? "doublet" : "film") + std::string(films.size() == 1 ? "" : "s"),
      o.raters.size(), o.raters.size() == 1 ? "" : "s", form.name, form.version, o.database);
}

ExitCode rate(const RateOptions& o) {
  const bool one = !(o.attempt + o.rater + o.participant + o.answersFile).empty() || !o.answers.empty();
  const bool byFile = !o.manifest.empty() || !o.taken.empty();
  if (!o.forms && o.database.empty()) fail("name a cohort database, or ask for --forms");
  if (!o.forms && byFile && (one || (!o.manifest.empty() && !o.taken.empty()) || (!o.taken.empty() && !o.form.empty())))
    fail("--manifest and --take say themselves what was rated, by whom and how");
  if (o.forms) {
    listForms(o);
  } else if (!o.described.empty()) {
    describeRater(o);
  } else if (!o.manifest.empty()) {
    return storeRatingManifest(o);
  } else if (byFile) {
    takePackAnswers(o);
  } else if (!o.form.empty()) {
    storeAnswers(o);
  } else if (one) {
    fail("name the form that was filled in with --form");
  } else {
    showRatings(o);
  }
  return ExitCode::yes;
}

}  // namespace

void addRate(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"rate", "Store and summarise what raters and participants judge, by forms", "calot rate --forms",
                  "calot rate c.db --form osats --attempt 3f2a --rater R1 --answers osats.json"},
                 rate);
  addCohortOption(*command, o->database);
  command->add_flag("--forms", o->forms, "List the forms that come with the program");
  command->add_option("--form", o->form, "The form that was filled in: its name (calot rate --forms), or a JSON file");
  command->add_option("--attempt", o->attempt, "Uuid of the attempt that was rated");
  command->add_option("--rater", o->rater, "Pseudonym of who rated it")->transform(CLI::Validator(pseudonymForm, ""));
  command->add_option("--participant", o->participant, "Pseudonym of the participant who filled in a questionnaire")
      ->transform(CLI::Validator(pseudonymForm, ""));
  addList(*command, "--answer", o->answers,
          "ITEM=SCORE for each item, - where it was left blank: A=4,B=- or one option each");
  command->add_option("--answers", o->answersFile, "The same as a JSON object of items and scores, null for blank");
  CLI::Option* manifest = command->add_option(
      "--manifest", o->manifest,
      "A CSV table of completed forms: attempt, file or participant, rater, and one column an item");
  addSimilarNames(*command, o->similarNames)->needs(manifest);
  command->add_option("--take", o->taken, "The answers to a pack as the rater's page saved them");
  command
      ->add_option("--describe", o->described,
                   "CRITERION=TEXT of a rater: experience, training and independence; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--force", o->force, "Replace what the same rater or participant has given before");
  command->add_flag("--json", o->json, "Print JSON");

  const auto [pack, p] = addCommand(
      *command, run,
      {"pack", "Pack films and a form for raters, under random names and in random order; the key stays in the cohort",
       "calot rate pack c.db --form goals --films films --raters R1,R2 -o pack"},
      packForRaters);
  addCohortOption(*pack, p->database)->required();
  pack->add_option("--form", p->form, "The form to fill in: its name, or a file")->required();
  pack->add_option("--films", p->films,
                   "A folder with the attempts' films or recordings, or a CSV table with columns attempt and film")
      ->required();
  addList(*pack, "--raters", p->raters, "Pseudonyms of the raters: R1,R2")->required();
  addList(*pack, "--attempts", p->attempts, "Uuids, U1,U2 (default: all that are not excluded, or the table's)");
  pack->add_option("-o,--output", p->output, "The pack's folder, which must not exist")->required();
}

}  // namespace calot::apps
