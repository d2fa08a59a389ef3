// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <QElapsedTimer>
#include <QObject>
#include <QProcess>
#include <QString>
#include <QStringList>
#include <QWidget>

#include "gui/dashboard/continuation.h"

class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;
class QTimer;

namespace calot::gui {

/// How the program that assesses recordings is called, and how it answers. The application knows its command line.
struct AssessProgram {
  /// Arguments for one recording, with its report as JSON. @param file an absolute path
  std::function<QStringList(const QString& file, const QString& database, int threads)> arguments;
  /// Arguments that make a branch by a performer.
  std::function<QStringList(const BranchRequest& request)> branch;
  /// Arguments with which the trainer goes on with a recording, from a time (s).
  std::function<QStringList(const QString& recording, double time, const QString& database)> goOn;
  /// True if an exit code blames the recording: damaged, or in conflict with the cohort.
  std::function<bool(int exitCode)> refused;
};

/// Result for one recording.
struct ImportResult {
  enum class Kind {
    stored,   ///< it is an attempt of the cohort, whatever its verdict
    refused,  ///< damaged, in conflict with the cohort, or of no use: nothing was stored
    failed,   ///< the program that assesses crashed, could not be started or was stopped
  };
  QString file;
  Kind kind = Kind::failed;
  QString text;  ///< "✓ verified, new in the cohort"; or why not
};

/// Parses the program's JSON result for one file. @param crashed true if it did not end by itself
ImportResult importResultOf(const AssessProgram& program, const QString& file, int exitCode, bool crashed,
                            const QByteArray& output, const QByteArray& errors);

/// The recordings behind what was dropped or chosen: files as they are, of folders the *.h5 in them, by name.
QStringList recordingsIn(const QStringList& paths);

/// Assesses recordings into a cohort, one after the other, each by the assessing program in a process of its own:
/// whatever a file does to the program that reads it, the window stays.
class ImportQueue : public QObject {
  Q_OBJECT
 public:
  /// @param how the program is called
  explicit ImportQueue(AssessProgram how);
  ~ImportQueue() override;

  /// Sets program and database for the next recordings. @pre not busy()
  void configure(const QString& program, const QString& database, int threads);
  /// Puts recordings behind those that wait; starts.
  void add(const QStringList& files);
  /// The same for a performer's continuation, whose recording is made first.
  void addBranch(const BranchRequest& request);
  /// Stops the one that is being assessed (the cohort keeps nothing of it) and drops the others.
  void cancel();

  [[nodiscard]] bool busy() const { return process_.state() != QProcess::NotRunning || !waiting_.isEmpty(); }
  [[nodiscard]] int done() const { return done_; }
  [[nodiscard]] int total() const { return total_; }
  [[nodiscard]] QString current() const { return current_; }
  [[nodiscard]] bool making() const { return making_.has_value(); }  ///< the current one is being made
  [[nodiscard]] qint64 seconds() const { return current_.isEmpty() ? 0 : clock_.elapsed() / 1000; }  ///< of the current

 signals:
  void progressed();
  void fileDone(const calot::gui::ImportResult& result);
  void allDone();

 private:
  void startNext();
  void finishCurrent(ImportResult result);
  void collect();

  AssessProgram how_;
  QString program_, database_;
  int threads_ = 1;
  struct Item {
    QString file;
    std::optional<BranchRequest> branch = {};  ///< to be made before it is assessed
  };
  void run();

  QList<Item> waiting_;
  QString current_;
  std::optional<BranchRequest> making_;  ///< the branch that the process makes
  int done_ = 0, total_ = 0;
  bool cancelled_ = false;
  QByteArray output_, errors_;
  QElapsedTimer clock_;
  QProcess process_;
};

/// How an import goes: progress, a line for each recording, and a button that stops it.
class ImportPanel : public QWidget {
  Q_OBJECT
 public:
  /// @param queue outlives the panel
  explicit ImportPanel(ImportQueue& queue);

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

/// Page shown without a database, or with an empty one. Greets and says what to do.
class GreetingPage : public QWidget {
  Q_OBJECT
 public:
  GreetingPage();
  void explainNoDatabase();
  void explainEmptyDatabase(const QString& fileName);

 signals:
  void openRequested();
  void newRequested();
  void importRequested();

 private:
  QLabel* title_;
  QLabel* text_;
  QPushButton* import_;
};

}  // namespace calot::gui
