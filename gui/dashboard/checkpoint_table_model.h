// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractItemModel>
#include <QAbstractTableModel>
#include <QStandardItemModel>
#include <QStyledItemDelegate>
#include <vector>

#include "analytics/assessment/moments.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/uncertainty/value_interval.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/replay_player.h"

namespace calot::gui {

/// The moment that made most of a figure. @pre there is one
const analytics::Moment& worstOf(const std::vector<analytics::Moment>& moments);

/// The checkpoints of one attempt, with where they stand in a norm and when they came about. A value that is missing
/// says why; what a value declares stands beside it.
class CheckpointTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column {
    nameColumn,
    subjectColumn,
    valueColumn,
    intervalColumn,  ///< of the simulation
    normColumn,      ///< drawn by a BandDelegate
    momentColumn,    ///< when it got worst
    directionColumn,
    windowColumn,
    originColumn,
    versionColumn,
    columnTotal
  };

  enum Role {
    standingRole = Qt::UserRole,  ///< const FigureStanding*, of normColumn; or null
  };

  using QAbstractTableModel::QAbstractTableModel;
  /// Standings and moments of former values are gone.
  void setValues(std::vector<analytics::CheckpointValue> values, std::vector<analytics::ValueInterval> intervals = {});
  void setStandings(std::vector<FigureStanding> standings);
  void setMoments(std::vector<analytics::FigureMoments> moments);
  /// Text of momentColumn while moments are searched for, or the reason why there are none.
  void setMomentsText(const QString& text);

  /// @pre 0 <= row < rowCount()
  [[nodiscard]] const analytics::CheckpointValue& value(int row) const {
    return values_[static_cast<std::size_t>(row)];
  }
  [[nodiscard]] const FigureStanding* standing(int row) const;           ///< or null
  [[nodiscard]] const analytics::FigureMoments* moments(int row) const;  ///< or null

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  [[nodiscard]] QString text(int row, int column) const;
  [[nodiscard]] QString toolTip(int row, int column) const;

  [[nodiscard]] const analytics::ValueInterval* interval(int row) const;  ///< or null

  std::vector<analytics::CheckpointValue> values_;
  std::vector<analytics::ValueInterval> intervals_;
  std::vector<FigureStanding> standings_;
  std::vector<analytics::FigureMoments> moments_;
  QString momentsText_;
};

/// Draws where a figure stands in a norm: the competent members' 10th to 90th percentile as a pale bar, their quartiles
/// as a darker one, median as a line, the cut as a dashed line, the attempt's value as a diamond; the text beside it.
/// Figures without a band show their text alone.
class BandDelegate : public QStyledItemDelegate {
  Q_OBJECT
 public:
  using QStyledItemDelegate::QStyledItemDelegate;
  void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override;
};

/// Puts what happened in an attempt into a tree: its errors, the gravest first, at their worst moments, with their
/// occasions where there are several; then other events in groups. Each says when, to what and by which hand.
void listEvents(QStandardItemModel& tree, const std::vector<TrackEvent>& events,
                const std::vector<analytics::ErrorLine>& errors);
inline constexpr int eventSecondsRole = Qt::UserRole;  ///< double; of a group its first event's

/// The checkpoints of a table, folded by family and sorted within one. Leaves out what the scene has nothing for.
class FamilyTreeModel : public QStandardItemModel {
  Q_OBJECT
 public:
  /// @param source outlives this
  explicit FamilyTreeModel(const CheckpointTableModel& source);

  /// The source's row, or -1 of a family.
  [[nodiscard]] int sourceRow(const QModelIndex& index) const;
  /// Position of a row of the source; invalid if it is left out.
  [[nodiscard]] QModelIndex indexOf(int sourceRow) const;
  [[nodiscard]] int leftOut() const { return leftOut_; }  ///< checkpoints that the scene has nothing for

  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  void multiData(const QModelIndex& index, QModelRoleDataSpan roles) const override {
    QAbstractItemModel::multiData(index, roles);  // by data(): items hold no cells
  }
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  [[nodiscard]] Qt::ItemFlags flags(const QModelIndex&) const override {
    return Qt::ItemIsEnabled | Qt::ItemIsSelectable;
  }
  /// Families keep their order. Values go by size within one figure's kind, missing ones last. @param column -1: as in
  /// the source
  void sort(int column, Qt::SortOrder order) override;

 private:
  class Entry;
  void fill();
  [[nodiscard]] bool isBefore(int a, int b) const;  ///< rows of the source

  const CheckpointTableModel& source_;
  int leftOut_ = 0;
  int sortColumn_ = -1;
  Qt::SortOrder sortOrder_ = Qt::AscendingOrder;
};

}  // namespace calot::gui
