// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "apps/calot/command.h"
#include "recorder/base/files.h"
#include "recorder/compliance_cache.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "sim/scene/version.h"

int main(int argc, char** argv) {
  using namespace calot;
  CLI::App app("Records, replays and assesses virtual laparoscopic cholecystectomy training.", "calot");
  app.set_version_flag("--version", recorder::softwareName() + " (" + recorder::buildName() + "), simulation version " +
                                        std::to_string(simulationVersion));
  app.require_subcommand(1);
  app.formatter(apps::helpForm());
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  apps::lookForCohort(words);
  apps::fitTerminal();
  apps::Run run;
#define CALOT_ADD_COMMAND(name) apps::add##name(app, run);
  CALOT_COMMAND_LIST(CALOT_ADD_COMMAND)
#undef CALOT_ADD_COMMAND
  app.footer("calot COMMAND --help has the options of each command, and an example.");
  return apps::runProgram(
      app, argc, argv,
      [&run] {
        recorder::useComplianceCache(recorder::userCacheFolder());
        const recorder::ProgramFiles files = recorder::ProgramFiles::ofThisProgram();
        recorder::useEngines(recorder::userEnginePlaces(files.programs(), files.assetRoots()));
        return run();
      },
      [&](const CLI::ParseError& e) { return apps::wrongWord(app, words, e); });
}
