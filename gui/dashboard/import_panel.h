// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QWidget>

#include "gui/dashboard/import_queue.h"

class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;
class QTimer;

namespace calot::gui {

/// How an import goes: progress, a line for each recording, and a button that stops it.
class ImportPanel : public QWidget {
  Q_OBJECT
 public:
  /// @param queue outlives the panel
  explicit ImportPanel(ImportQueue& queue, QWidget* parent = nullptr);

 private:
  void showProgress();
  void addResult(const ImportResult& result);

  ImportQueue& queue_;
  QLabel* text_;
  QProgressBar* bar_;
  QPushButton* stop_;
  QListWidget* results_;
  QTimer* tick_;
  QElapsedTimer clock_;  ///< since the queue last began
};

}  // namespace calot::gui
