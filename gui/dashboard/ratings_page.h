// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QWidget>

#include "gui/attempt/replay_transport.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/rating_draft.h"

class QButtonGroup;
class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QScrollArea;
class QVBoxLayout;

namespace calot::gui {

class AttemptBanner;
class ScenePictureWidget;

/// Forms to be filled in: raters judge the attempt that is selected, beside its replay, participants what they took
/// part in. Who acted is hidden unless it is asked for. What is not stored yet is kept as a draft. Nothing is stored
/// before every item is answered or left blank on purpose.
class RatingPage : public QWidget {
  Q_OBJECT
 public:
  explicit RatingPage(QWidget* parent = nullptr);
  ~RatingPage() override;
  [[nodiscard]] quint64 replayShown() const;  ///< pictures so far
  [[nodiscard]] bool settled() const;         ///< the replay stands where it was sent to, or there is none
  void setForms(KnownForms forms);
  void chooseForm(const QString& name);
  /// @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  void setAttempt(const analytics::AttemptRow& attempt);

 signals:
  void problem(const QString& message);
  /// The rating is stored: the next attempt is wanted.
  void nextWanted();

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  void connectParts();
  void readPeople();
  void showForm();
  void addItem(QVBoxLayout& layout, const analytics::FormItem& item);
  void showSubject();
  void showEarlier();
  void showState();
  bool store();
  QWidget* buildForm();
  QWidget* buildReplay();
  void openReplay();
  [[nodiscard]] DraftSubject draftSubject() const;
  [[nodiscard]] const analytics::RatingForm* form() const;

  std::shared_ptr<const CohortDocument> document_;
  std::optional<analytics::AttemptRow> attempt_;
  KnownForms forms_;
  std::optional<RatingDraft> draft_;
  bool read_ = false;      ///< who is in the cohort
  bool replaces_ = false;  ///< who fills it in has filled it in before

  QComboBox* choice_ = nullptr;
  QLabel* source_ = nullptr;
  AttemptBanner* banner_ = nullptr;
  QLabel* raterLabel_ = nullptr;
  QLineEdit* rater_ = nullptr;
  QLabel* participantLabel_ = nullptr;
  QComboBox* participant_ = nullptr;
  QScrollArea* area_ = nullptr;
  std::vector<std::pair<std::string, QButtonGroup*>> groups_;
  QLabel* state_ = nullptr;
  QPushButton* store_ = nullptr;
  QPushButton* next_ = nullptr;
  QCheckBox* reveal_ = nullptr;
  QWidget* replayPart_ = nullptr;
  ScenePictureWidget* picture_ = nullptr;
  bool opening_ = false;  ///< the replay
  std::string shown_;     ///< uuid whose replay was opened
  std::unique_ptr<Replay> replay_;
};

}  // namespace calot::gui
