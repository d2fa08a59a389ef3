// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/settings.h"

#include <algorithm>
#include <QCoreApplication>
#include <QFileInfo>
#include <QSettings>
#include <QStandardPaths>

namespace calot::gui::settings {
namespace {

constexpr int maxFolders = 20;
constexpr const char* foldersKey = "recordings/folders";
constexpr const char* programKey = "import/program";
constexpr const char* threadsKey = "import/threads";
constexpr const char* personKey = "person";
constexpr const char* coloursKey = "look/colours";
constexpr const char* typeKey = "look/type";
constexpr const char* columnsKey = "attempts/hidden-columns";

QSettings store() { return {QSettings::IniFormat, QSettings::UserScope, "calot", "dashboard"}; }

}  // namespace

QStringList recordingFolders() { return store().value(foldersKey).toStringList(); }

std::vector<std::filesystem::path> recordingPlaces() {
  std::vector<std::filesystem::path> places;
  for (const QString& folder : recordingFolders()) places.emplace_back(folder.toStdString());
  return places;
}

void setRecordingFolders(const QStringList& folders) { store().setValue(foldersKey, folders.mid(0, maxFolders)); }

void rememberRecordingFolder(const QString& folder) {
  QStringList folders = recordingFolders();
  folders.removeAll(folder);
  folders.prepend(folder);
  setRecordingFolders(folders);
}

QString chosenCalotProgram() { return store().value(programKey).toString(); }

QString calotProgram() {
  if (const QString chosen = chosenCalotProgram(); !chosen.isEmpty()) return chosen;
  const QString beside = QCoreApplication::applicationDirPath() + "/calot";
  if (QFileInfo(beside).isExecutable()) return beside;
  return QStandardPaths::findExecutable("calot");
}

void setCalotProgram(const QString& file) { store().setValue(programKey, file); }

int importThreads() { return std::clamp(store().value(threadsKey, 1).toInt(), 1, 64); }
void setImportThreads(int threads) { store().setValue(threadsKey, std::clamp(threads, 1, 64)); }

theme::Choice colours() { return theme::choiceOf(store().value(coloursKey).toString()); }
void setColours(theme::Choice choice) { store().setValue(coloursKey, theme::wordOf(choice)); }
int type() {
  return std::clamp(store().value(typeKey, theme::usualType).toInt(), theme::usualType, theme::largestType);
}
void setType(int percent) { store().setValue(typeKey, std::clamp(percent, theme::usualType, theme::largestType)); }

QStringList hiddenColumns() { return store().value(columnsKey).toStringList(); }
void setHiddenColumns(const QStringList& titles) { store().setValue(columnsKey, titles); }

QString person() { return store().value(personKey).toString(); }
void setPerson(const QString& name) { store().setValue(personKey, name); }

}  // namespace calot::gui::settings
