// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QScrollArea>
#include <string>
#include <utility>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "gui/dashboard/rating_queue.h"

class QButtonGroup;
class QVBoxLayout;

namespace calot::gui {

/// A form to be filled in: its sections and items, the words of each anchor at its point of the scale, and a choice to
/// leave an item blank. A digit answers the item that has the keyboard, else the first without an answer, `-` leaves it
/// blank; the next item follows.
class RatingFormView : public QScrollArea {
  Q_OBJECT
 public:
  RatingFormView();
  /// Nothing is answered. @param form outlives what is shown; null: none
  void setForm(const analytics::RatingForm* form);
  void setAnswers(const FormAnswers& answers);  ///< scores of another scale are left out
  [[nodiscard]] const FormAnswers& answers() const { return answers_; }
  [[nodiscard]] bool complete() const { return !items_.empty() && answers_.size() == items_.size(); }
  [[nodiscard]] std::size_t items() const { return items_.size(); }

 signals:
  void answered();  ///< by a person

 protected:
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void addItem(QVBoxLayout& layout, const analytics::FormItem& item, const analytics::RatingForm& form);

  std::vector<std::pair<std::string, QButtonGroup*>> items_;
  FormAnswers answers_;
};

}  // namespace calot::gui
