// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/pack_answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::JsonPlace;
using recorder::shown;

constexpr std::size_t maxAnswerBytes = std::size_t{4} << 20U, maxAnswerWord = 80, maxPackFilms = 10000;

constexpr TextRule answerWord{maxAnswerWord};

struct Answers {
  std::string pack, rater;

  static std::vector<Field> fields() {
    using S = Answers;
    return {object("", "Answers to a pack"),
            fileFormat("calot-answers"),
            fileFormatVersion(),
            {"pack", at<S, &S::pack>, answerWord, "Pack"},
            {"rater", at<S, &S::rater>, answerWord, "Rater"},
            {"films", unchecked, "Films"},
            optional("seal", unchecked, "Of pages that earlier versions made")};
  }
};

struct FilmAnswers {
  std::string film;

  static std::vector<Field> fields() {
    return {object("film", "Answers to a film"),
            {"film", at<FilmAnswers, &FilmAnswers::film>, answerWord, "Film"},
            {"scores", unchecked, "Scores by item"}};
  }
};

using Scores = std::vector<std::pair<std::string, std::string>>;  ///< item and score, in the form's order

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
  throw Error(ErrorKind::refused, Where{file}, what);
}

Scores scoresOf(const JsonPlace& place, const RatingForm& form) {
  const std::vector<FormItem> items = form.items();
  std::vector<Field> rows{object("scores", "Scores by item")};
  for (const FormItem& item : items) rows.emplace_back(item.key.c_str(), unstored<std::string>, answerWord, "Score");
  recorder::readRecord(place, Record(rows, nullptr), nullptr);
  Scores scores;
  for (const FormItem& item : items) scores.emplace_back(item.key, place.at(item.key).text(answerWord));
  return scores;
}

RatingForm formOf(const RatingPack& pack) {
  return parseRatingForm(std::as_bytes(std::span(pack.form.text)), "form " + pack.form.name);
}

}  // namespace

PackAnswers readPackAnswers(const std::filesystem::path& file,
                            const std::function<std::optional<RatingPack>(const std::string& id)>& find) {
  const std::string name = file.filename().string();
  const nlohmann::json json = recorder::parseStrictJson(recorder::readFileBytes(file, name, maxAnswerBytes), name);
  const JsonPlace root(json, name);
  Answers given;
  recorder::readRecord(root, given);
  const std::string& id = given.pack;
  std::optional<RatingPack> pack = find(id);
  if (!pack) refuse(name, fmt::format("answers to a pack ({}) that was not made from this cohort", shown(id)));

  PackAnswers answers;
  answers.form = formOf(*pack);
  answers.rater = given.rater;
  const auto rater = std::find_if(pack->raters.begin(), pack->raters.end(),
                                  [&](const PackedRater& r) { return r.rater == answers.rater; });
  if (rater == pack->raters.end()) refuse(name, fmt::format("no rater \"{}\" has this pack", shown(answers.rater)));

  std::vector<std::pair<std::string, Scores>> films;
  for (const JsonPlace& place : root.at("films").list(1, maxPackFilms)) {
    FilmAnswers film;
    recorder::readRecord(place, film);
    films.emplace_back(film.film, scoresOf(place.at("scores"), answers.form));
  }

  std::map<std::string, std::string> attemptOf;
  for (const PackedFilm& film : rater->films) attemptOf[film.name] = film.attempt;
  std::set<std::string> seen;
  for (const auto& [film, scores] : films) {
    if (!seen.insert(film).second) refuse(name, fmt::format("film {} is there twice", shown(film)));
    const auto at = attemptOf.find(film);
    if (at == attemptOf.end()) {
      ++answers.withdrawn;
      continue;
    }
    Rating rating{answers.form.name, answers.form.version, at->second, answers.rater, "", {}, ""};
    attemptOf.erase(at);
    if (std::all_of(scores.begin(), scores.end(), [](const auto& s) { return s.second == "-"; })) {
      ++answers.notJudged;
      continue;
    }
    rating.answers = answersOf(answers.form, scores);
    answers.ratings.push_back(std::move(rating));
  }
  if (!attemptOf.empty()) refuse(name, fmt::format("{} films of the pack have no answers", attemptOf.size()));
  answers.pack = std::move(*pack);
  return answers;
}

}  // namespace calot::analytics
