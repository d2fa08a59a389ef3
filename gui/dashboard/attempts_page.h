// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QAbstractTableModel>
#include <QSortFilterProxyModel>
#include <QStringList>
#include <QWidget>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/dashboard/checkpoint_table_model.h"
#include "gui/dashboard/cohort_document.h"

namespace calot::gui {

/// The attempts of a cohort as a table, one row each.
class AttemptTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  using enum AttemptLines::Column;
  enum Role {
    sortRole = Qt::UserRole,  ///< int: what a column is ordered by
    searchRole,               ///< QString: all that the search box looks through, lower case; same for every column
    verdictRole,              ///< int: analytics::Verdict
    syntheticRole,            ///< bool
    uuidRole,                 ///< QString
  };

  using QAbstractTableModel::QAbstractTableModel;
  /// @pre not null
  void setLines(std::shared_ptr<const AttemptLines> lines);
  /// @pre 0 <= row < rowCount()
  [[nodiscard]] const analytics::AttemptRow& attempt(int row) const {
    return lines_->attempts()[static_cast<std::size_t>(row)];
  }

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::shared_ptr<const AttemptLines> lines_;
};

/// Filter and order of the attempts in the table.
class AttemptFilter : public QSortFilterProxyModel {
  Q_OBJECT
 public:
  enum class Operators { all, people, synthetic };

  explicit AttemptFilter(QObject* parent = nullptr);
  /// Every word of the text must be found somewhere in the row; case does not matter.
  void setSearch(const QString& text);
  void setVerdict(std::optional<analytics::Verdict> verdict);
  void setOperators(Operators operators);
  void setTag(const QString& tag);  ///< empty: any, or none

 protected:
  [[nodiscard]] bool filterAcceptsRow(int sourceRow, const QModelIndex& sourceParent) const override;

 private:
  /// The whole table is laid out anew: rows that go one by one, as invalidateFilter() has them, take seconds of
  /// thousands.
  void refilter() { invalidate(); }

  QStringList words_;
  std::string tag_;
  std::optional<analytics::Verdict> verdict_;
  Operators operators_ = Operators::all;
};

}  // namespace calot::gui

class QBoxLayout;
class QComboBox;
class QLabel;
class QLineEdit;
class QTableView;

namespace calot::gui {

class AttemptBanner;

/// The attempts of a cohort with search and filters, and the checkpoints of the selected one.
class AttemptsPage : public QWidget {
  Q_OBJECT
 public:
  explicit AttemptsPage(QWidget* parent = nullptr);
  /// Shows a document; the first attempt is selected. @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  void focusSearch();
  void selectNext();  ///< the row below
  /// All that are selected, in the table's order.
  [[nodiscard]] std::vector<analytics::AttemptRow> selectedAll() const;
  [[nodiscard]] const analytics::AttemptRow* selected() const;  ///< or null
  /// Selects an attempt; filters that hide it are taken away.
  void select(const QString& uuid);

 signals:
  /// Something could not be read: one line for the user.
  void problem(const QString& message);
  void selectionChanged();
  /// The selected attempt is to be opened.
  void attemptActivated();
  /// So is one of its figures.
  void figureActivated(const QString& checkpoint, const QString& subject);

 private:
  void buildFilters(QBoxLayout& layout);
  void buildDetails(QBoxLayout& layout);
  void buildColumns(QBoxLayout& layout);
  void showCount();
  void afterFilter();
  void fillTags();
  void showSelected();
  [[nodiscard]] int rowOf(const QString& uuid) const;  ///< in the filtered table; -1: not there

  std::shared_ptr<const CohortDocument> document_;
  AttemptTableModel attempts_;
  AttemptFilter filter_;
  CheckpointTableModel checkpoints_;
  QLineEdit* search_ = nullptr;
  QComboBox* verdict_ = nullptr;
  QComboBox* operators_ = nullptr;
  QComboBox* tag_ = nullptr;
  QLabel* count_ = nullptr;
  QTableView* table_ = nullptr;
  AttemptBanner* banner_ = nullptr;
  QTableView* details_ = nullptr;
};

}  // namespace calot::gui
