// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/page_parts.h"

#include <QAbstractItemModel>
#include <QHeaderView>
#include <QTableView>
#include <QTimer>
#include <QTreeView>

#include "gui/attempt/theme.h"
#include "gui/attempt/widget_parts.h"

namespace calot::gui {

QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* table = parts::named(name, new QTableView);
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

QTreeView* makeTree(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* tree = parts::named(name, new QTreeView);
  tree->setAccessibleName(spokenName);
  tree->setModel(&model);
  tree->setSelectionBehavior(QAbstractItemView::SelectRows);
  tree->setEditTriggers(QAbstractItemView::NoEditTriggers);
  tree->setAlternatingRowColors(true);
  tree->setUniformRowHeights(true);
  tree->header()->setStretchLastSection(true);
  tree->header()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return tree;
}

void setWidths(QTableView& table, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) table.setColumnWidth(column++, theme::inType(width));
}

void setWidths(QTreeView& tree, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) tree.setColumnWidth(column++, theme::inType(width));
}

void wrapWords(QTableView& table) {
  table.setWordWrap(true);
  table.verticalHeader()->setMinimumSectionSize(table.verticalHeader()->defaultSectionSize());
  // Once for all columns that change together, when they have changed.
  auto* later = new QTimer(&table);
  later->setSingleShot(true);
  later->setInterval(0);
  QObject::connect(later, &QTimer::timeout, &table, &QTableView::resizeRowsToContents);
  QObject::connect(table.model(), &QAbstractItemModel::modelReset, &table, &QTableView::resizeRowsToContents);
  QObject::connect(table.horizontalHeader(), &QHeaderView::sectionResized, later, [later] { later->start(); });
}

}  // namespace calot::gui
