// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QAbstractTableModel>
#include <QSortFilterProxyModel>

#include "gui/dashboard/checkpoint_table_model.h"
#include "gui/dashboard/page_parts.h"

namespace calot::gui {

/// The attempts of a cohort as a table, one row each.
class AttemptTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  using enum AttemptLines::Column;
  enum Role {
    sortRole = Qt::UserRole,  ///< int: what a column is ordered by
    uuidRole,                 ///< QString
  };

  using QAbstractTableModel::QAbstractTableModel;
  /// @pre not null
  void setLines(std::shared_ptr<const AttemptLines> lines);
  /// @pre 0 <= row < rowCount()
  [[nodiscard]] const analytics::AttemptRow& attempt(int row) const {
    return lines_->attempts()[static_cast<std::size_t>(row)];
  }
  /// All that the search box looks through, in small letters.
  [[nodiscard]] const QString& search(int row) const { return lines_->search(row); }

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  /// A participant's group can be edited.
  [[nodiscard]] Qt::ItemFlags flags(const QModelIndex& index) const override;
  /// Asks for the change by groupEdited(), and shows it when the cohort was read again.
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  [[nodiscard]] bool isLatest(int row) const { return lines_->isLatest(row); }

 signals:
  void groupEdited(const QString& participant, const QString& group);

 private:
  std::shared_ptr<const AttemptLines> lines_;
};

/// Filter and order of the attempts in the table.
class AttemptFilter : public QSortFilterProxyModel {
  Q_OBJECT
 public:
  struct Criteria {
    QString search = {};   ///< every word of it must be found somewhere in the row; case does not matter
    std::string tag = {};  ///< empty: any, or none
    std::optional<analytics::Verdict> verdict = {};
    std::optional<bool> synthetic = {};
    bool latest = false;  ///< AttemptLines::isLatest() alone
    bool operator==(const Criteria&) const = default;
  };

  AttemptFilter();
  /// Lays the whole table out again: rows that go one by one, as invalidateFilter() has them, take seconds of
  /// thousands.
  void set(const Criteria& wanted);

 protected:
  [[nodiscard]] bool filterAcceptsRow(int sourceRow, const QModelIndex& sourceParent) const override;

 private:
  Criteria wanted_;
  QStringList words_;  ///< of the search
};

/// The attempts of a cohort as a roster with search and filters, and the checkpoints of the selected one.
class AttemptsPage : public CohortPage {
  Q_OBJECT
 public:
  AttemptsPage();
  /// Shows a document at once; the first attempt is selected.
  void setDocument(std::shared_ptr<const CohortDocument> document) override;
  void focusSearch();
  /// All that are selected, in the table's order.
  [[nodiscard]] std::vector<analytics::AttemptRow> selectedAll() const;
  [[nodiscard]] std::vector<std::string> selectedUuids() const;
  [[nodiscard]] const analytics::AttemptRow* selected() const;  ///< or null
  /// Selects an attempt; filters that hide it are taken away.
  void select(const QString& uuid);
  /// Actions of the table's context menu.
  void offer(const QList<QAction*>& actions);
  void editGroup();  ///< of the current row
  /// The rows and columns that are shown, titles first.
  [[nodiscard]] std::vector<std::vector<std::string>> shownCells() const;
  bool makeDocument(const Taker& take) override;

 signals:
  void selectionChanged();
  /// A figure of the selected attempt is to be shown.
  void figureActivated(const QString& checkpoint, const QString& subject);
  /// A participant is to be of another group.
  void groupEdited(const QString& participant, const QString& group);

 private:
  void read() override {}
  QLayout* buildFilters();
  QWidget* buildColumns();
  void filter();
  void showCount();
  void fillTags();
  void showSelected();
  [[nodiscard]] int rowOf(const QString& uuid) const;  ///< in the filtered table; -1: not there

  AttemptTableModel attempts_;
  AttemptFilter filter_;
  CheckpointTableModel checkpoints_;
  QLineEdit* search_;
  QComboBox *which_, *verdict_, *operators_, *tag_;
  QLabel* count_;
  QTableView* table_;
  AttemptBanner* banner_;
  QTableView* details_;
};

}  // namespace calot::gui
