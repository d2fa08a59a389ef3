// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <QMainWindow>
#include <vector>

#include "gui/attempt/long_work.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/decisions.h"
#include "gui/dashboard/import_queue.h"

class QAction;
class QDockWidget;
class QLabel;
class QMenu;
class QStackedWidget;
class QTabWidget;
class QTimer;

namespace calot::gui {

class AttemptPage;
class AttemptsPage;
class ComparePage;
class CoursePage;
class GreetingPage;
class PairPage;
class RatingPage;
class StudyPage;
class TraineePage;

/// The dashboard: pages over one cohort database. It only puts pages together; what they show is decided by models that
/// know no window. The database is written by imports, norms and decisions alone, and decisions can be undone.
class DashboardWindow : public QMainWindow {
  Q_OBJECT
 public:
  /// @param program what imports recordings
  /// @param assetFolders that may hold forms and courses (recorder::ProgramFiles)
  explicit DashboardWindow(const AssessProgram& program, const std::vector<std::filesystem::path>& assetFolders = {});
  ~DashboardWindow() override;

  /// Makes ready what draws attempts: for when nothing else is to be done.
  void prepare();
  /// Shows an open document. @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  /// Opens a database, one of an older schema after it was brought up to date. On failure says why in one line on the
  /// window, keeps what was open, and returns false.
  bool openDatabase(const QString& path);
  /// The same, read on another thread: a large one takes longer than the window may be kept from answering.
  void openLater(const QString& path);
  /// Makes an empty database, or opens the one that is there.
  bool createDatabase(const QString& path);
  /// Reads the open database again, in the background.
  void reload();
  /// Puts recordings (files, and folders with such) into the import's queue. @pre a database is open
  void importRecordings(const QStringList& paths);
  /// The same with those beside the cohort and in the folders of recordings whose names the cohort does not know.
  void importNew();
  /// Has a performer go on with an attempt's recording; both are shown side by side when the branch is in the cohort.
  /// @pre a cohort is open
  void addBranch(const BranchRequest& request, const QString& parentUuid);
  /// Shows an attempt as soon as the open database has it; imports its recording where it has not.
  /// @pre a database is open
  void showRecording(const QString& file, const QString& uuid);
  /// Excludes the selected attempts from studies, or takes them in again where the current one is excluded. Can be
  /// undone.
  void excludeOrInclude(const QString& reason, const QString& by);
  /// Puts a tag on the selected attempts, or takes it off. Can be undone. @pre tag as analytics::checkTag()
  void tagSelected(const QString& tag, bool add, const QString& by);
  /// Gives a participant another group. Can be undone.
  void changeGroup(const QString& participant, const QString& group);
  /// Shows a norm that was just stored. Its making can be undone.
  void keepNorm(const analytics::Norm& norm);
  /// Writes the list of attempts as it is shown, as CSV.
  void exportList(const QString& file);
  /// Simulates the selected attempts' recordings again; progress as of an import.
  void verifySelected();
  /// Puts two selected attempts side by side.
  void pairSelected();

  [[nodiscard]] ImportQueue& imports() { return imports_; }
  /// Writes a PNG of each page into a folder that exists, after what it shows has been read: attempts.png, attempt.png,
  /// compare.png, study.png, trainee.png, pair.png, ratings.png, course.png, norm.png and settings.png (or
  /// greeting.png).
  /// @throws calot::Error (failure) if one cannot be written.
  void savePictures(const QString& folder);

 public slots:
  void askForDatabase();
  void showProblem(const QString& message);

 signals:
  void documentShown();

 protected:
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  static constexpr int noticeFor = 8000;  ///< ms that the status bar shows a notice
  void buildMenus();
  void buildImport();
  void connectPages();
  void focusPage();  ///< puts the keyboard where the page begins
  void openAttempt(const QString& uuid);
  struct Opened;
  static Opened openOrUpgrade(const std::string& path);  ///< any thread @throws Error
  void takeOpened(const Opened& opened);
  bool tryTo(const std::function<void()>& call);  ///< shows a fault as a problem @return false if there was one
  void askForNewDatabase();
  void askForRecordings();
  void askForExclusion();
  void askForTag(bool add);
  void askForNorm();
  void askForContinuation(const QString& recording, double time);
  void showBranch();
  void askForList();
  void decide(const Decision& decision);
  void print();  ///< what the page shows
  void showManual();
  void fillRecent();
  [[nodiscard]] std::vector<analytics::AttemptRow> chosenAttempts() const;  ///< selected, or the current one

  std::shared_ptr<const CohortDocument> document_;
  QString awaited_;  ///< uuid of the attempt to show when the database has it
  QLabel* problem_;
  QStackedWidget* stack_;
  GreetingPage* greeting_;
  QTabWidget* tabs_;
  AttemptsPage* attempts_;
  AttemptPage* attempt_;
  ComparePage* compare_;
  StudyPage* study_;
  TraineePage* trainee_;
  PairPage* pair_;
  RatingPage* rating_;
  CoursePage* course_;
  Decisions* decisions_;  ///< what Ctrl+Z takes back
  QAction* exclude_ = nullptr;
  QMenu* recent_ = nullptr;
  std::vector<std::filesystem::path> assetFolders_;
  QDockWidget* importDock_ = nullptr;
  QTimer* refresh_ = nullptr;  ///< while an import runs
  AssessProgram program_;
  ImportQueue imports_;
  std::string branched_, branchName_;  ///< the parent's uuid and the branch's file name: to be shown side by side
  Background loader_;                  ///< reads again what is open
  Background opener_;                  ///< opens another
  Background finder_;                  ///< looks for recordings
};

}  // namespace calot::gui
