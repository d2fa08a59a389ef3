// SPDX-License-Identifier: GPL-3.0-or-later
// Where the keyboard begins on a page. No focus proxy: Tab would pass over what stands before it.
#pragma once

#include <initializer_list>
#include <QVariant>
#include <QWidget>

#include "analytics/cohort/cohort_database.h"

class QAbstractItemModel;
class QTableView;
class QTreeView;

namespace calot::gui {

/// A table to look at: whole rows are selected, nothing is edited, Tab leaves it and arrows move in it.
/// @param name of the object; @param spokenName for screen readers
QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName);
/// Widths of the first columns (pixels).
void setWidths(QTableView& table, std::initializer_list<int> widths);
void setWidths(QTreeView& tree, std::initializer_list<int> widths);
/// Words that a column is too narrow for go on in the next line instead of being cut: rows are as high as they need,
/// and stay so when the model is reset or a column gets another width.
void wrapWords(QTableView& table);

/// A tree whose rows are chosen whole.
QTreeView* makeTree(QAbstractItemModel& model, const char* name, const char* spokenName);

/// Property of a page: the widget (QObject*) that one begins with.
inline constexpr const char* beginProperty = "begin";

inline void focusBegin(QWidget& page) {
  auto* begin = qobject_cast<QWidget*>(page.property(beginProperty).value<QObject*>());
  (begin != nullptr ? begin : &page)->setFocus(Qt::OtherFocusReason);
}

}  // namespace calot::gui

class QLabel;

namespace calot::gui {

/// Who and what an attempt is, its verification badge, and whether a performer made it. Stands over everything that is
/// shown of one attempt.
class AttemptBanner : public QWidget {
  Q_OBJECT
 public:
  explicit AttemptBanner(QWidget* parent = nullptr);
  void showAttempt(const analytics::AttemptRow& attempt);
  /// For half a window: the mark of performers in one word.
  void makeNarrow();
  void showText(const QString& text);  ///< no attempt

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void colourBadge();

  analytics::Verdict verdict_ = analytics::Verdict::notChecked;
  QLabel* watermark_;
  QLabel* identity_;
  QLabel* badge_;
};

}  // namespace calot::gui
