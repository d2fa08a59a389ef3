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

QString person() { return store().value(personKey).toString(); }
void setPerson(const QString& name) { store().setValue(personKey, name); }

}  // namespace calot::gui::settings
