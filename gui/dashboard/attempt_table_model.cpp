// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_table_model.h"

#include <QFont>

#include "gui/attempt/words.h"

namespace calot::gui {
namespace {

QString cellText(const analytics::AttemptRow& attempt, int column) {
  switch (column) {
    case AttemptTableModel::attemptColumn:
      return QString::fromStdString(attempt.uuid).left(8);
    case AttemptTableModel::operatorColumn:
      return operatorText(attempt);
    case AttemptTableModel::groupColumn:
      return QString::fromStdString(attempt.group);
    case AttemptTableModel::sceneColumn:
      return QString::fromStdString(attempt.scene);
    case AttemptTableModel::modeColumn:
      return modeText(attempt.mode);
    case AttemptTableModel::outcomeColumn:
      return outcomeText(attempt.outcome) + (attempt.excluded ? ", excluded" : "");
    case AttemptTableModel::startColumn:
      return startText(attempt.startUtc);
    case AttemptTableModel::verificationColumn:
      return badgeText(attempt.verification.verdict);
    case AttemptTableModel::syntheticColumn:
      return attempt.synthetic ? QStringLiteral("synthetic") : QString();
    default:
      return {};
  }
}

QString searchText(const analytics::AttemptRow& attempt) {
  QString text = QString::fromStdString(attempt.uuid) + '\n' + QString::fromStdString(attempt.profile) + '\n' +
                 QString::fromStdString(attempt.fileName);
  for (int c = 0; c < AttemptTableModel::columnTotal; ++c) text += '\n' + cellText(attempt, c);
  return text.toLower();
}

}  // namespace

void AttemptTableModel::setAttempts(std::vector<analytics::AttemptRow> attempts) {
  beginResetModel();
  attempts_ = std::move(attempts);
  endResetModel();
}

int AttemptTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(attempts_.size());
}
int AttemptTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : columnTotal; }

QVariant AttemptTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount() || index.column() >= columnTotal) return {};
  const analytics::AttemptRow& row = attempt(index.row());
  switch (role) {
    case Qt::DisplayRole:
      return cellText(row, index.column());
    case sortRole:
      if (index.column() == startColumn) return QString::fromStdString(row.startUtc);
      return cellText(row, index.column());
    case searchRole:
      return searchText(row);
    case verdictRole:
      return static_cast<int>(row.verification.verdict);
    case syntheticRole:
      return row.synthetic;
    case uuidRole:
      return QString::fromStdString(row.uuid);
    case Qt::ForegroundRole:
      if (index.column() == verificationColumn) return badgeOf(row).colour;
      return {};
    case Qt::FontRole: {
      QFont font;
      if (index.column() == verificationColumn) font.setBold(true);
      if (index.column() == syntheticColumn) font.setItalic(true);
      return font;
    }
    case Qt::ToolTipRole:
      if (index.column() == attemptColumn) return QString::fromStdString(row.uuid);
      if (index.column() == verificationColumn) return badgeOf(row).explanation;
      if (index.column() == syntheticColumn && row.synthetic) return "Made by a performer, not by a person.";
      if (index.column() == outcomeColumn && row.excluded) return QString::fromStdString(row.exclusionReason);
      return {};
    default:
      return {};
  }
}

QVariant AttemptTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  static constexpr const char* titles[columnTotal] = {
      "Attempt", "Participant or profile", "Group", "Scene", "Mode", "Outcome", "Start", "Verification", "Synthetic"};
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section < 0 || section >= columnTotal) return {};
  return QString(titles[section]);
}

}  // namespace calot::gui
