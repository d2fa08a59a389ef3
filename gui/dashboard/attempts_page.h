// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QWidget>
#include <vector>

#include "gui/dashboard/attempt_table_model.h"
#include "gui/dashboard/checkpoint_table_model.h"
#include "gui/dashboard/cohort_document.h"

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
