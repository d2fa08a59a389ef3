// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "gui/dashboard/comparison.h"
#include "gui/dashboard/figures_page.h"

class QCheckBox;
class QComboBox;

namespace calot::gui {

class PlotView;

/// One checkpoint over attempts by group, within one comparability key.
class ComparePage : public FiguresPage {
  Q_OBJECT
 public:
  explicit ComparePage(QWidget* parent = nullptr);

 protected:
  void takeValues() override;

 private:
  void redraw();

  std::vector<std::string> keys_;
  QComboBox* figure_ = nullptr;
  QComboBox* groupBy_ = nullptr;
  QComboBox* key_ = nullptr;
  QCheckBox* synthetic_ = nullptr;
  PlotView* chart_ = nullptr;
};

}  // namespace calot::gui
