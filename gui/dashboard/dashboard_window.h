// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QMainWindow>

#include "gui/dashboard/cohort_document.h"

class QLabel;
class QStackedWidget;
class QTabWidget;

namespace calot::gui {

class AttemptsPage;
class ComparePage;
class GreetingPage;

/// The dashboard: a cohort's attempts and checkpoints, and one checkpoint over groups. It only puts pages together;
/// what they show is decided by models that know no window. Nothing is ever written to a database.
class DashboardWindow : public QMainWindow {
  Q_OBJECT
 public:
  explicit DashboardWindow(QWidget* parent = nullptr);
  ~DashboardWindow() override;

  /// Shows an open document. @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  /// Opens a database. On failure says why in one line on the window, keeps what was open, and returns false.
  bool openDatabase(const QString& path);
  /// Reads the open database again.
  void reload();
  /// Writes a PNG of each page into a folder that exists: attempts.png and compare.png (or greeting.png).
  /// @throws calot::Error (failure) if one cannot be written.
  void savePictures(const QString& folder);

 public slots:
  void askForDatabase();
  void showProblem(const QString& message);

 private:
  void buildMenus();

  std::shared_ptr<const CohortDocument> document_;
  QLabel* problem_;
  QStackedWidget* stack_;
  GreetingPage* greeting_;
  QTabWidget* tabs_;
  AttemptsPage* attempts_;
  ComparePage* compare_;
};

}  // namespace calot::gui
