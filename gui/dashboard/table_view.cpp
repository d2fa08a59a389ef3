// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/table_view.h"

#include <QHeaderView>
#include <QTableView>

namespace calot::gui {

QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* table = new QTableView;
  table->setObjectName(name);
  table->setAccessibleName(spokenName);
  table->setModel(&model);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setAlternatingRowColors(true);
  table->setTabKeyNavigation(false);
  table->setWordWrap(false);
  table->verticalHeader()->hide();
  table->verticalHeader()->setDefaultSectionSize(table->fontMetrics().height() + 9);
  table->horizontalHeader()->setStretchLastSection(true);
  table->horizontalHeader()->setHighlightSections(false);
  table->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return table;
}

void setWidths(QTableView& table, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) table.setColumnWidth(column++, width);
}

}  // namespace calot::gui
