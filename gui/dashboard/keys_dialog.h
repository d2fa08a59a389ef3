// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <utility>
#include <vector>

class QMenuBar;

namespace calot::gui {

/// Every key that the dashboard knows: those of the menus, then those of the pages.
using KeyList = std::vector<std::pair<QString, QString>>;  ///< key, what it does
[[nodiscard]] KeyList keysOf(const QMenuBar& menus);

/// A list of keys to look at.
class KeysDialog : public QDialog {
  Q_OBJECT
 public:
  explicit KeysDialog(const KeyList& keys, QWidget* parent = nullptr);
};

}  // namespace calot::gui
