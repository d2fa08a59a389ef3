// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>

#include "gui/attempt/long_work.h"
#include "gui/dashboard/page_parts.h"

class QFormLayout;
class QMenuBar;
class QSpinBox;

namespace calot::gui {

/// Every key that the dashboard knows: those of the menus, then those of the pages.
using KeyList = std::vector<std::pair<QString, QString>>;  ///< key, what it does
[[nodiscard]] KeyList keysOf(const QMenuBar& menus);

/// Shows the keys in a dialog, until it is closed.
void showKeys(const KeyList& keys, QWidget* parent);

/// Makes a norm of two groups, as `calot norm create` does, and says what that says of it: whom its rule lets through,
/// what it may be used for, and every warning.
class NormDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param selected uuids of the attempts that are selected on the page
  NormDialog(std::shared_ptr<const CohortDocument> document, std::vector<std::string> selected,
             QWidget* parent = nullptr);

 signals:
  void made();     ///< a norm was stored
  void refused();  ///< and why stands in the dialog

 private:
  QFormLayout* buildForm();
  void make();
  void allow(bool ready);

  std::shared_ptr<const CohortDocument> document_;
  std::vector<std::string> selected_;
  LongWork work_;
  QLineEdit *name_, *by_;
  GroupFields fields_;  ///< first: the competent
  QComboBox *attempts_, *rule_;
  QSpinBox* least_;
  QCheckBox* first_;
  QLabel* result_;
  QPushButton* make_;
  WorkStrip* strip_;
};

}  // namespace calot::gui
