// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <QString>
#include <QStringList>

namespace calot::gui {

/// How the program that assesses recordings is called, and how it answers. The application knows its command line.
struct AssessProgram {
  /// Arguments for one recording, with its report as JSON. @param file an absolute path
  std::function<QStringList(const QString& file, const QString& database, int threads)> arguments;
  /// True if an exit code blames the recording: damaged, or in conflict with the cohort.
  std::function<bool(int exitCode)> refused;
  /// Command line that assesses a recording into this database.
  std::function<QString(const QString& database)> typed;
};

}  // namespace calot::gui
