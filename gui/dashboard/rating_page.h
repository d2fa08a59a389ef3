// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QWidget>

#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/rating_draft.h"

class QButtonGroup;
class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QScrollArea;
class QVBoxLayout;

namespace calot::gui {

class AttemptBanner;

/// Forms to be filled in: raters judge the attempt that is selected, participants what they took part in. Nothing is
/// stored before every item is answered or left blank on purpose.
class RatingPage : public QWidget {
  Q_OBJECT
 public:
  explicit RatingPage(QWidget* parent = nullptr);
  void setForms(KnownForms forms);
  void chooseForm(const QString& name);
  /// @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  void setAttempt(const analytics::AttemptRow& attempt);

 signals:
  void problem(const QString& message);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  void connectParts();
  void readPeople();
  void showForm();
  void addItem(QVBoxLayout& layout, const analytics::FormItem& item);
  void showSubject();
  void showEarlier();
  void showState();
  void store();
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
};

}  // namespace calot::gui
