// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractTableModel>
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

}  // namespace calot::gui
