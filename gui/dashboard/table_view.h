// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>

class QAbstractItemModel;
class QTableView;
class QTreeView;

namespace calot::gui {

/// A table to look at: whole rows are selected, nothing is edited, Tab leaves it and arrows move in it.
/// @param name of the object; @param spokenName for screen readers
QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName);
/// Widths of the first columns (pixels).
void setWidths(QTableView& table, std::initializer_list<int> widths);
void setWidths(QTreeView& tree, std::initializer_list<int> widths);
/// Words that a column is too narrow for go on in the next line instead of being cut: rows are as high as they need,
/// and stay so when the model is reset or a column gets another width.
void wrapWords(QTableView& table);

/// A tree whose rows are chosen whole.
QTreeView* makeTree(QAbstractItemModel& model, const char* name, const char* spokenName);

}  // namespace calot::gui
