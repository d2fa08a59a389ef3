// SPDX-License-Identifier: GPL-3.0-or-later
// Commands of `calot`: each adds its subcommand with its options to the application and, when chosen, sets `run` to
// what main() shall call; `run` returns the exit code or throws calot::Error.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace calot::apps {

using Run = std::function<int()>;

void addRecord(CLI::App& app, Run& run);
void addEngine(CLI::App& app, Run& run);
void addReplay(CLI::App& app, Run& run);
void addBranch(CLI::App& app, Run& run);
void addInspect(CLI::App& app, Run& run);
void addRecover(CLI::App& app, Run& run);
void addExport(CLI::App& app, Run& run);
void addState(CLI::App& app, Run& run);
void addDiff(CLI::App& app, Run& run);
void addMesh(CLI::App& app, Run& run);
void addCache(CLI::App& app, Run& run);
void addRender(CLI::App& app, Run& run);
void addImport(CLI::App& app, Run& run);
void addAssess(CLI::App& app, Run& run);
void addVerify(CLI::App& app, Run& run);
void addStudy(CLI::App& app, Run& run);
void addProtocol(CLI::App& app, Run& run);
void addPower(CLI::App& app, Run& run);
void addRate(CLI::App& app, Run& run);
void addNorm(CLI::App& app, Run& run);
void addGrade(CLI::App& app, Run& run);

void addParticipant(CLI::App& app, Run& run);
void addAttempt(CLI::App& app, Run& run);
void addRegrade(CLI::App& app, Run& run);
void addCohort(CLI::App& app, Run& run);
void addStation(CLI::App& app, Run& run);
void addScene(CLI::App& app, Run& run);
void addScenes(CLI::App& app, Run& run);
void addCheckpoints(CLI::App& app, Run& run);
void addDevices(CLI::App& app, Run& run);
void addGolden(CLI::App& app, Run& run);

}  // namespace calot::apps
