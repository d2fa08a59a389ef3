// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/assessment/rating_form.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
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

constexpr std::size_t maxSections = 20, maxItems = 60, maxScores = 101;

std::vector<Field> scaleFields() {
  using S = RatingForm;
  return {
      object("scale", "Whole numbers; the larger the better"),
      {"least", at<S, &S::least>, "", within(0, 1), "Smallest score"},
      {"most", at<S, &S::most>, "", within(1, 100), "Largest score"},
      optional("words", at<S, &S::words>, anyText, "Names of the scores, from the smallest").items(2, maxScores),
  };
}

template <bool expert>
constexpr Access publishedMean() {
  Access access = unstored<double>;
  access.get = [](void* item) -> void* {
    return &static_cast<FormItem*>(item)->published[expert ? "expert" : "novice"];
  };
  return access;
}

std::vector<Field> publishedFields() {
  return {
      object("published", "Published means, for reference only"),
      {"expert", publishedMean<true>(), "", within(0, 100), "Mean of experts"},
      {"novice", publishedMean<false>(), "", within(0, 100), "Mean of novices"},
  };
}

/// Do the words fit the scale's scores? @throws Error (damaged) where their number differs
void checkWords(const JsonPlace& place, const RatingForm& form) {
  const std::size_t scores = static_cast<std::size_t>(form.most) - static_cast<std::size_t>(form.least) + 1;
  static_cast<void>(place.list(scores, scores));
}

}  // namespace

std::vector<Field> FormItem::fields() {
  using S = FormItem;
  return {
      object("item", "Item of a form"),
      {"key", at<S, &S::key>, plainName, "Key as it is typed and stored; once in a form"},
      {"text", at<S, &S::text>, anyText, "Wording"},
      optional("primaryGroup", at<S, &S::primaryGroup>, anyName,
               "The study group whose judgement of this item counts first"),
      optional("anchors", at<S, &S::anchors>, anyText, "The site's wording of each score, from the smallest")
          .items(2, maxScores),
      optional("published", keyGroup<S, publishedFields>, "Published means, for reference only"),
  };
}

std::vector<Field> FormSection::fields() {
  using S = FormSection;
  return {
      object("section", "Items under a heading"),
      {"name", at<S, &S::name>, anyText, "Heading"},
      Field("items", at<S, &S::items>, "Items").items(1, maxItems),
  };
}

std::vector<Field> FormSubscale::fields() {
  using S = FormSubscale;
  return {
      object("subscale", "Items whose scores are added up"),
      {"name", at<S, &S::name>, anyText, "Name"},
      Field("items", at<S, &S::items>, anyName, "Keys of items of the form").items(1, maxItems),
  };
}

std::vector<Field> RatingForm::fields() {
  using S = RatingForm;
  return {
      object("", "A questionnaire, or a scale by which raters judge attempts"),
      fileFormat("calot-form"),
      fileFormatVersion(),
      {"name", at<S, &S::name>, plainName, "Name: letters, digits, points, hyphens, underscores"},
      {"version", at<S, &S::version>, "", within(1, 1000000),
       "A changed form, and one to which a site adds its wording, has a higher version or another name"},
      {"title", at<S, &S::title>, anyText, "Title"},
      {"source", at<S, &S::source>, anyText, "Source of the items"},
      {"about", at<S, &S::ofAttempts>, FieldWords{{"attempt", 1}, {"simulator", 0}},
       "attempt: a rater judges an attempt. simulator: a participant judges what they took part in"},
      optional("shows", at<S, &S::ofDoublets>, FieldWords{{"film", 0}, {"doublet", 1}},
               "film: raters are shown the attempt's film. doublet: photographs of its critical view, front and back"),
      {"scale", keyGroup<S, scaleFields>, "Scale of the scores"},
      Field("sections", at<S, &S::sections>,
            "Items under their headings. Of a questionnaire, Cronbach's alpha is over each")
          .items(1, maxSections),
      optional("subscales", at<S, &S::subscales>,
               "Items whose scores are added up, by their keys; an item may be in several, or in none. All items "
               "together are reported in any case")
          .items(1, maxSections),
  };
}

std::vector<FormItem> RatingForm::items() const {
  std::vector<FormItem> all;
  for (const FormSection& section : sections) all.insert(all.end(), section.items.begin(), section.items.end());
  return all;
}

RatingForm readRatingForm(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseRatingForm(recorder::readFileBytes(file, name, 1U << 20U), name);
}

RatingForm parseRatingForm(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json json = recorder::parseStrictJson(bytes, file);
  const JsonPlace root(json, file);
  RatingForm form;
  recorder::readRecord(root, form);
  keepText(bytes, file, form);
  const JsonPlace scale = root.at("scale");
  if (form.least >= form.most) scale.fail("\"least\" is not below \"most\"");
  if (scale.has("words")) checkWords(scale.at("words"), form);
  std::set<std::string> keys;
  for (std::size_t s = 0; s < form.sections.size(); ++s) {
    for (std::size_t i = 0; i < form.sections[s].items.size(); ++i) {
      const JsonPlace item = root.at("sections").at(s).at("items").at(i);
      if (item.has("anchors")) checkWords(item.at("anchors"), form);
      if (!keys.insert(form.sections[s].items[i].key).second) item.fail("an item of this key stands above already");
    }
  }
  std::set<std::string> names;
  for (std::size_t s = 0; s < form.subscales.size(); ++s) {
    const FormSubscale& subscale = form.subscales[s];
    const JsonPlace place = root.at("subscales").at(s);
    if (!names.insert(subscale.name).second) place.fail("a subscale of this name stands above already");
    std::set<std::string> seen;
    for (std::size_t i = 0; i < subscale.items.size(); ++i) {
      const JsonPlace item = place.at("items").at(i);
      if (keys.count(subscale.items[i]) == 0) item.fail("no item of the form has this key");
      if (!seen.insert(subscale.items[i]).second) item.fail("named twice");
    }
  }
  return form;
}

std::map<std::string, int> answersOf(const RatingForm& form,
                                     const std::vector<std::pair<std::string, std::string>>& given) {
  const std::vector<FormItem> items = form.items();
  std::map<std::string, int> answers;
  std::set<std::string> seen;
  const auto fail = [&](const std::string& key, const std::string& what) {
    throw Error(ErrorKind::invalid, fmt::format("form {}: item \"{}\": {}", form.name, shown(key), what));
  };
  for (const auto& [key, score] : given) {
    if (std::none_of(items.begin(), items.end(), [&k = key](const FormItem& item) { return item.key == k; })) {
      std::string known;
      for (const FormItem& item : items) known += (known.empty() ? "" : ", ") + item.key;
      fail(key, "the form has no such item; it has " + known);
    }
    if (!seen.insert(key).second) fail(key, "answered twice");
    if (score == "-") continue;
    std::string fault;
    const double value = recorder::readFiniteNumber(score, fault);  // spreadsheets write 4.0
    if (!fault.empty() || value < form.least || value > form.most || value != std::floor(value))
      fail(key, fmt::format("\"{}\" is not a whole number from {} to {} (- where it was left blank)", shown(score),
                            form.least, form.most));
    answers[key] = static_cast<int>(value);
  }
  for (const FormItem& item : items) {
    if (seen.count(item.key) == 0) fail(item.key, "not answered (- where it was left blank)");
  }
  if (answers.empty()) throw Error(ErrorKind::invalid, fmt::format("form {}: every item was left blank", form.name));
  return answers;
}

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
