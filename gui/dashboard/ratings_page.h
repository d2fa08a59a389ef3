// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <QStringListModel>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gui/dashboard/decisions.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/rating_queue.h"
#include "gui/dashboard/recording_view.h"

class QListView;

namespace calot::gui {

class RatingFormView;

/// Forms to be filled in. A rater goes through a queue of films: each is watched, judged beside it and stored, and the
/// next one follows. Who acted is hidden unless it is asked for; films have numbers, in an order of the rater's own.
/// Participants fill in what they took part in. What is not stored yet is kept as a draft (drafts). A rating is stored
/// when every item is answered or left blank on purpose, and enough of the film was seen (SeenFilm::enough).
class RatingPage : public CohortPage {
  Q_OBJECT
 public:
  RatingPage();
  /// True if the replay stands where it was sent to, or there is none.
  [[nodiscard]] bool settled() const { return film_->settled(); }
  [[nodiscard]] const SeenFilm& seenFilm() const { return seen_; }  ///< by the rater, of the film that is shown
  /// Offers the forms in `forms/` of these folders, best first (recorder::ProgramFiles).
  void readForms(const std::vector<std::filesystem::path>& folders);
  void chooseForm(const QString& name);
  /// Attempts that are selected elsewhere: the queue can be limited to them. @param uuids none: all
  void setSelected(std::vector<std::string> uuids);

 signals:
  /// A form was completed and is to be stored.
  void decided(const calot::gui::Decision& decision);

 protected:
  void hideEvent(QHideEvent* event) override;

 private:
  void read() override;
  QBoxLayout* buildHead();
  void connectParts();
  void setRater();
  void showForm();
  void fillQueue();
  void markRated();
  void goTo(const std::string& uuid);
  void goToNext();
  void openFilm();
  void takePicture(double time);
  void keepSeen();
  void showSubject();
  void showAnswers();
  void showState();
  void store(bool goOn);
  void dropStored();
  [[nodiscard]] const analytics::RatingForm* form() const;        ///< or null
  [[nodiscard]] RatingSubject subject() const;                    ///< @pre form() is not null
  [[nodiscard]] std::optional<analytics::Rating> stored() const;  ///< of the subject @pre form() is not null
  [[nodiscard]] bool ofFilms() const { return form() == nullptr || form()->ofAttempts; }
  [[nodiscard]] int number() const;  ///< of the film in the queue, from 1; 0: it is not there

  std::vector<analytics::RatingForm> forms_;
  QString fault_;                                                     ///< why one of the forms cannot be read
  std::vector<analytics::Rating> ratings_;                            ///< of the cohort, and what was decided since
  std::vector<std::pair<RatingSubject, analytics::Rating>> waiting_;  ///< decided and not read back yet
  std::vector<std::string> selected_, queue_;
  std::set<std::string> rated_;  ///< of the queue
  std::string current_;          ///< uuid of the film that is rated, or empty
  std::string shown_;            ///< uuid whose film was opened
  QString name_;                 ///< of the rater
  SeenFilm seen_;
  bool ran_ = false;  ///< the film ran at the picture before

  QComboBox* choice_;
  QLabel* raterLabel_;
  QLineEdit* rater_;
  QLabel* participantLabel_;
  QComboBox* participant_;
  QLabel* whichLabel_;
  QComboBox* which_;
  QCheckBox* reveal_;
  QLabel* progress_;
  QStringListModel films_;
  QListView* list_;
  QWidget* left_;  ///< the queue
  AttemptBanner* banner_;
  RecordingView* film_;
  QWidget* middle_;  ///< the film
  QLabel* source_;
  RatingFormView* view_;
  QLabel* state_;
  QPushButton *store_, *next_;
};

}  // namespace calot::gui
