// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/keys_dialog.h"

#include <QAction>
#include <QBoxLayout>
#include <QDialogButtonBox>
#include <QHeaderView>
#include <QMenu>
#include <QMenuBar>
#include <QTableWidget>

#include "gui/attempt/theme.h"

namespace calot::gui {

KeyList keysOf(const QMenuBar& menus) {
  KeyList keys;
  for (const QAction* menu : menus.actions()) {
    if (menu->menu() == nullptr) continue;
    for (const QAction* action : menu->menu()->actions()) {
      if (action->shortcut().isEmpty()) continue;
      QString text = action->text().remove('&').remove(QString::fromUtf8(" …")).trimmed();
      keys.emplace_back(action->shortcut().toString(QKeySequence::NativeText), text);
    }
  }
  keys.insert(keys.end(), {{"Tab, Shift+Tab", "Next field, last field"},
                           {"Alt and a letter", "The field whose letter is underlined"},
                           {"Arrows", "Rows of a table; dots of a plot; events of a timeline"},
                           {"Left, Right", "In a tree: fold, unfold"},
                           {"Enter", "Open what is chosen; its worst moment, then the next one"},
                           {"Space", "Play or pause the replay"},
                           {", and .", "One step back, one step forward"},
                           {"Ctrl+Return", "Store a rating and go to the next attempt"}});
  return keys;
}

KeysDialog::KeysDialog(const KeyList& keys, QWidget* parent) : QDialog(parent) {
  setWindowTitle("Keys");
  auto* table = new QTableWidget(static_cast<int>(keys.size()), 2);
  table->setObjectName("keys");
  table->setAccessibleName("Keys and what they do");
  table->setHorizontalHeaderLabels({"Key", "What it does"});
  table->verticalHeader()->hide();
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setTabKeyNavigation(false);
  table->horizontalHeader()->setStretchLastSection(true);
  table->setColumnWidth(0, theme::inType(160));
  int row = 0;
  for (const auto& [key, what] : keys) {
    table->setItem(row, 0, new QTableWidgetItem(key));
    table->setItem(row++, 1, new QTableWidgetItem(what));
  }
  auto* close = new QDialogButtonBox(QDialogButtonBox::Close);
  connect(close, &QDialogButtonBox::rejected, this, &QDialog::reject);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(table, 1);
  layout->addWidget(close);
  resize(theme::inType(520), theme::inType(420));
}

}  // namespace calot::gui
