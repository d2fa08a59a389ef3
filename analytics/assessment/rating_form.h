// SPDX-License-Identifier: GPL-3.0-or-later
// Forms that people fill in: questionnaires of participants, and scales by which raters judge attempts
// (schemas/form.schema.json); and the answers to a pack of films.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/assessment/declared_document.h"
#include "analytics/cohort/blinding.h"

namespace calot::analytics {

struct FormItem {
  std::string key, text;
  std::string primaryGroup;                 ///< the study group whose judgement of it counts first, or empty
  std::vector<std::string> anchors;         ///< wording of each score, from the least; empty: the site supplies it
  std::map<std::string, double> published;  ///< published means by group, for reference

  static std::vector<Field> fields();
};

struct FormSection {
  std::string name;
  std::vector<FormItem> items;

  static std::vector<Field> fields();
};

/// Items whose scores are added up.
struct FormSubscale {
  std::string name;
  std::vector<std::string> items;  ///< keys

  static std::vector<Field> fields();
};

struct RatingForm : DeclaredDocument {
  std::string source;
  bool ofAttempts = true;   ///< raters judge attempts; else participants judge what they took part in
  bool ofDoublets = false;  ///< raters are shown front and back of the critical view, not the film
  int least = 1, most = 5;
  std::vector<std::string> words;  ///< of the scores, from the least; or empty
  std::vector<FormSection> sections;
  std::vector<FormSubscale> subscales;  ///< as declared; or none

  [[nodiscard]] std::vector<FormItem> items() const;  ///< of all sections
  static std::vector<Field> fields();
};

/// @throws Error (damaged) naming file and place.
RatingForm readRatingForm(const std::filesystem::path& file);
RatingForm parseRatingForm(std::span<const std::byte> bytes, const std::string& file);

/// A score for every item, none where it was left blank. @throws Error (invalid) naming the item: unknown, not
/// answered, no whole number of the scale, given twice, or all blank.
/// @param given pairs of key and score; the score of one that was left blank is "-"
std::map<std::string, int> answersOf(const RatingForm& form,
                                     const std::vector<std::pair<std::string, std::string>>& given);

/// Answers saved by a rater's page, with the films' names resolved.
struct PackAnswers {
  RatingPack pack;
  RatingForm form;
  std::string rater;
  std::vector<Rating> ratings;
  std::size_t notJudged = 0;  ///< films without an item that the rater could judge
  std::size_t withdrawn = 0;  ///< films of attempts that were withdrawn since
};

/// Reads and checks the file that a rating page saved: {"format": "calot-answers", "formatVersion": 1, "pack", "rater",
/// "films": [{"film", "scores": {ITEM: "SCORE" or "-"}}]}; a "seal", which earlier pages wrote, is not read.
/// @param find the pack of that id, if there is one
/// @throws Error (damaged) for a malformed file; (refused) for a pack or rater that is not known, a film that is
/// missing or there twice.
PackAnswers readPackAnswers(const std::filesystem::path& file,
                            const std::function<std::optional<RatingPack>(const std::string& id)>& find);

}  // namespace calot::analytics
