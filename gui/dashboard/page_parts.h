// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the dashboard's pages.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <QCheckBox>
#include <QHeaderView>
#include <QKeySequence>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTableWidget>
#include <QTreeView>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/cohort_document.h"

namespace calot::gui {

/// A table to look at: whole rows are selected, nothing is edited, Tab leaves it and arrows move in it.
/// @param name of the object; @param spokenName for screen readers
QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName);
/// The same with texts of its own, a column for each title.
QTableWidget* makeTextTable(const QStringList& titles, const char* name, const char* spokenName);
/// Texts of a row's first columns. @param key data (Qt::UserRole) of its first cell
void setTexts(QTableWidget& table, int row, const QStringList& texts, const std::string& key = {});
/// Words that a column is too narrow for go on in the next line instead of being cut: rows are as high as they need,
/// and stay so when the model is reset or a column gets another width.
void wrapWords(QTableView& table);

/// A tree whose rows are chosen whole.
QTreeView* makeTree(QAbstractItemModel& model, const char* name, const char* spokenName);

/// Widths of the first columns (pixels, for letters of the usual size).
template <class View>
void setWidths(View& view, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) view.setColumnWidth(column++, theme::inType(width));
}

/// Widgets that share a space, each with its stretch factor; none can be closed.
QSplitter* makeSplitter(Qt::Orientation orientation, const std::vector<std::pair<QWidget*, int>>& parts);

/// Gives a choice other entries, quietly. The chosen one stays so where it is among them; else it is `other`.
void refill(QComboBox& choice, const QStringList& entries, int other = 0);

/// Calls `action` on a key while the widget or one of its children has the focus.
void onKey(QWidget& widget, const QKeySequence& key, std::function<void()> action);

/// Fields of studies and norms: two groups, and which attempts count. Their owner names and places them.
struct GroupFields {
  QComboBox *by, *first, *second, *key;
  QCheckBox *synthetic, *practice;

  /// Offers what the attempts have. Chosen are study groups of people, or profiles where no attempt has a group;
  /// assessments, or practice where there is none. Quiet.
  void offer(const std::vector<analytics::AttemptRow>& attempts) const;
  void offerGroups(const std::vector<analytics::AttemptRow>& attempts) const;
  [[nodiscard]] analytics::StudyOptions options() const;
};

/// A page over the open cohort. What it shows is read when it is seen for the first time since a cohort was set.
class CohortPage : public QWidget {
  Q_OBJECT
 public:
  /// @pre not null
  virtual void setDocument(std::shared_ptr<const CohortDocument> document);
  using Taker = std::function<void(const analytics::ReportDocument&)>;
  /// Makes what the page shows into a document for paper, and hands it over, now or later.
  /// @return false: there is nothing to print
  virtual bool makeDocument(const Taker& /*take*/) { return false; }
  /// Puts the keyboard where one begins. No focus proxy: Tab would pass over what stands before it.
  void focusBegin();

 signals:
  /// Something could not be read or written: one line for the user.
  void problem(const QString& message);
  /// The attempt is to be opened.
  void attemptActivated(const QString& uuid);

 protected:
  void showEvent(QShowEvent* event) override;
  /// Shows what the document holds. @pre document_ is not null
  virtual void read() = 0;
  /// The page is out of date: read() follows, at once or when the page is seen next.
  void outdate();
  /// Calls, and reports a fault as a problem. @return false if there was one
  bool tryTo(const std::function<void()>& call);

  std::shared_ptr<const CohortDocument> document_;
  QWidget* begin_ = nullptr;  ///< that one begins with; null: the page

 private:
  bool outdated_ = false;
};

/// Identity of an attempt, its verification badge, and whether a performer made it. Stands over everything that is
/// shown of one attempt.
class AttemptBanner : public QWidget {
  Q_OBJECT
 public:
  AttemptBanner();
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
