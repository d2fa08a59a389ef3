// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFileInfo>

#include "apps/common/program.h"
#include "gui/dashboard/import_queue.h"

namespace calot::apps {

/// `calot assess`, for the dashboard.
inline gui::AssessProgram assessProgram() {
  gui::AssessProgram program;
  program.arguments = [](const QString& file, const QString& database, int threads) {
    return QStringList{"assess", file, "--cohort", database, "--threads", QString::number(threads), "--json"};
  };
  program.branch = [](const gui::BranchRequest& request) {
    return QStringList{"branch",      request.parent,
                       "--at",        QString::number(request.time, 'f', 3),
                       "--seconds",   QString::number(request.seconds),
                       "--performer", request.profile,
                       "-o",          request.file};
  };
  program.goOn = [](const QString& recording, double time, const QString& database) {
    return QStringList{"--branch", recording, "--at", QString::number(time, 'f', 3),
                       "--cohort", database,  "-o",   QFileInfo(recording).absolutePath()};
  };
  program.refused = [](int exitCode) {
    return exitCode == static_cast<int>(ExitCode::damaged) || exitCode == static_cast<int>(ExitCode::no);
  };
  return program;
}

}  // namespace calot::apps
