// SPDX-License-Identifier: GPL-3.0-or-later
// The work of a rater: films in an order of their own, the seconds of a film that they saw, and answers that
// are not stored yet. Knows no window.
#pragma once

#include <map>
#include <optional>
#include <QString>
#include <string>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// Uuids of the attempts that can be rated, in an order that depends on rater and uuid alone: neither time nor person
/// shows in it. Left out are imported motion, which has no film, attempts that are excluded, and those of people
/// without consent to research where the cohort records it, as in packs of films. @param only these; empty: all
std::vector<std::string> filmQueue(const std::vector<analytics::AttemptRow>& attempts, const std::string& rater,
                                   const std::vector<std::string>& only = {});

/// Seconds of a film that were on the screen while it ran. Where it was only jumped to, it was not seen.
class SeenFilm {
 public:
  static constexpr double enough = 0.8;  ///< share of the film that a rating takes

  SeenFilm() = default;
  /// @param seconds as kept() gave them
  explicit SeenFilm(const QString& seconds) : seconds_(seconds.toStdString()) {}
  /// The film's length is known (s). @pre > 0
  void setLength(double seconds);
  /// A picture of the running film was shown. @param time end of its step (s)
  void show(double time);
  [[nodiscard]] double share() const;  ///< of the film's seconds; 0 before its length is known
  [[nodiscard]] bool suffices() const { return share() >= enough; }
  [[nodiscard]] QString kept() const { return QString::fromStdString(seconds_); }

 private:
  std::string seconds_;  ///< '1' of each second that was seen, else '0'
  bool known_ = false;   ///< the length
};

using FormAnswers = std::map<std::string, std::optional<int>>;  ///< by item; none: left blank

/// Identity of a completed form: attempt and rater of a form about attempts, the participant of the others.
struct RatingSubject {
  std::string database, form;
  std::uint32_t formVersion = 1;
  std::string attempt, rater, participant;
};

/// The rating of these answers. @throws Error (invalid) for an item without answer, all blank, or a missing name
analytics::Rating ratingOf(const analytics::RatingForm& form, const RatingSubject& subject, const FormAnswers& answers);

}  // namespace calot::gui

/// Kept among the user's settings, apart from those of the dashboard: a rater who is called away goes on where they
/// were. No name stands there but the rater's, which no other page reads.
namespace calot::gui::drafts {

FormAnswers answers(const RatingSubject& subject);  ///< empty without a draft
void keepAnswers(const RatingSubject& subject, const FormAnswers& answers);
void dropAnswers(const RatingSubject& subject);
SeenFilm seen(const RatingSubject& subject);
void keepSeen(const RatingSubject& subject, const SeenFilm& film);
/// Uuid of the film that the rater had before them last; or empty.
std::string film(const RatingSubject& subject);
void keepFilm(const RatingSubject& subject);
QString rater();  ///< the last one's pseudonym, or empty
void keepRater(const QString& name);
QString form();  ///< name of the one that was filled in last, or empty
void keepForm(const std::string& name);

}  // namespace calot::gui::drafts
