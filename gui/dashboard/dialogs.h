// SPDX-License-Identifier: GPL-3.0-or-later
// Dialogs of the dashboard, and its settings, kept from run to run. None changes a figure.
#pragma once

#include <filesystem>
#include <QDialog>
#include <QString>
#include <QStringList>
#include <vector>

#include "gui/attempt/widget_parts.h"

class QListWidget;
class QMenuBar;
class QSpinBox;

namespace calot::gui {

/// Every key that the dashboard knows: those of the menus, then those of the pages.
using KeyList = std::vector<std::pair<QString, QString>>;  ///< key, what it does
[[nodiscard]] KeyList keysOf(const QMenuBar& menus);

/// Shows the keys in a dialog, until it is closed.
void showKeys(const KeyList& keys, QWidget* parent);

/// Folders of recordings, the program that imports them and its number of threads, the person at the desk,
/// and how the dashboard looks.
class SettingsDialog : public QDialog {
  Q_OBJECT
 public:
  explicit SettingsDialog(QWidget* parent = nullptr);
  void accept() override;  ///< stores what is shown

 private:
  QListWidget* folders_;
  QLineEdit* program_;
  QSpinBox* threads_;
  QLineEdit* person_;
  QComboBox* colours_;
  QSpinBox* type_;
};

}  // namespace calot::gui

namespace calot::gui::settings {

/// Folders in which recordings are looked for, beside the database's own; the newest first.
[[nodiscard]] QStringList recordingFolders();
[[nodiscard]] std::vector<std::filesystem::path> recordingPlaces();
void setRecordingFolders(const QStringList& folders);
/// Puts a folder first; adds it where it is new.
void rememberRecordingFolder(const QString& folder);

/// Cohorts that were opened, the newest first.
[[nodiscard]] QStringList recentCohorts();
void rememberCohort(const QString& file);

/// The program that assesses recordings: as set; else `calot` beside this program; else on the search path; else empty.
[[nodiscard]] QString calotProgram();
void setCalotProgram(const QString& file);   ///< empty: looked for as said
[[nodiscard]] QString chosenCalotProgram();  ///< as set, or empty

/// Threads of an import's simulation: 1 to 64.
[[nodiscard]] int importThreads();
void setImportThreads(int threads);

/// Light or dark, and how large letters are (per cent).
[[nodiscard]] theme::Choice colours();
void setColours(theme::Choice choice);
[[nodiscard]] int type();
void setType(int percent);

/// Columns of the list of attempts that are not shown.
[[nodiscard]] QStringList hiddenColumns();
void setHiddenColumns(const QStringList& titles);

/// File of the course that was chosen last, or empty.
[[nodiscard]] QString course();
void setCourse(const QString& file);
[[nodiscard]] bool courseSynthetic();  ///< performers' attempts count in it, too
void setCourseSynthetic(bool counts);

/// The person who excludes, includes, tags and makes norms: a pseudonym, or empty.
[[nodiscard]] QString person();
void setPerson(const QString& name);

}  // namespace calot::gui::settings
