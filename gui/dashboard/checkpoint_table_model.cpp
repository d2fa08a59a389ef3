// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/checkpoint_table_model.h"

#include <QColor>

#include "analytics/checkpoints/registry.h"
#include "gui/dashboard/words.h"

namespace calot::gui {

void CheckpointTableModel::setValues(std::vector<analytics::CheckpointValue> values) {
  beginResetModel();
  values_ = std::move(values);
  endResetModel();
}

int CheckpointTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(values_.size());
}
int CheckpointTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : columnTotal; }

QVariant CheckpointTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const analytics::CheckpointValue& value = values_[static_cast<std::size_t>(index.row())];
  const analytics::CheckpointDefinition* const definition = analytics::findCheckpoint(value.name);
  if (role == Qt::DisplayRole) switch (index.column()) {
      case nameColumn:
        return figureTitle(value.name, {});
      case subjectColumn:
        return value.subject.empty() ? QStringLiteral("attempt") : QString::fromStdString(value.subject);
      case valueColumn:
        return valueText(value) + (value.note.empty() ? "" : " *");
      case directionColumn:
        return directionText(value);
      case windowColumn:
        return definition != nullptr ? QString::fromStdString(definition->window) : QString();
      case originColumn:
        return originText(value.origin);
      case versionColumn:
        return static_cast<int>(value.version);
      default:
        return {};
    }
  if (role == Qt::TextAlignmentRole && index.column() == valueColumn)
    return QVariant::fromValue(Qt::Alignment(Qt::AlignVCenter | (value.value ? Qt::AlignRight : Qt::AlignLeft)));
  if (role == Qt::ForegroundRole && index.column() == valueColumn && !value.value) return QColor(0x50, 0x50, 0x50);
  if (role == Qt::ToolTipRole) {
    QString tip = QString::fromStdString(value.name);
    if (definition != nullptr) tip += ": " + QString::fromStdString(definition->definition);
    if (!value.filter.empty()) tip += "\nFilter: " + QString::fromStdString(value.filter);
    if (!value.note.empty()) tip += "\n* " + QString::fromStdString(value.note);
    return tip;
  }
  return {};
}

QVariant CheckpointTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  static constexpr const char* titles[columnTotal] = {"Checkpoint", "Of",     "Value",  "Direction",
                                                      "Window",     "Origin", "Version"};
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section < 0 || section >= columnTotal) return {};
  return QString(titles[section]);
}

}  // namespace calot::gui
