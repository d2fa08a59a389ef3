// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/help.h"
#include "apps/common/help_json.h"
#include "apps/common/program.h"
#include "recorder/attempt.h"
#include "recorder/compliance_cache.h"
#include "recorder/prepared_scene.h"
#include "sim/scene/version.h"

int main(int argc, char** argv) {
  using namespace calot;
  CLI::App app("Records, replays and assesses virtual laparoscopic cholecystectomy training.", "calot");
  app.set_version_flag("--version", recorder::softwareName() + " (" + recorder::buildName() + "), simulation version " +
                                        std::to_string(simulationVersion));
  app.require_subcommand(1);
  apps::Run run;
  for (const auto add :
       {apps::addRecord,  apps::addReplay,      apps::addEngine,  apps::addBranch,      apps::addInspect,
        apps::addRecover, apps::addExport,      apps::addState,   apps::addDiff,        apps::addImport,
        apps::addAssess,  apps::addVerify,      apps::addStudy,   apps::addProtocol,    apps::addPower,
        apps::addRate,    apps::addNorm,        apps::addGrade,   apps::addParticipant, apps::addAttempt,
        apps::addRegrade, apps::addCohort,      apps::addStation, apps::addRender,      apps::addMesh,
        apps::addScenes,  apps::addCheckpoints, apps::addDevices, apps::addGolden,      apps::addCache}) {
    add(app, run);
  }
  apps::dressHelp(app);
  apps::addHelpJson(app);
  const auto isCommand = [&app](const std::string& word) {
    return !app.get_subcommands([&word](const CLI::App* command) { return command->get_name() == word; }).empty();
  };
  if (argc > 1 && argv[1][0] != '-' && !isCommand(argv[1])) {
    return apps::endWith(apps::ExitCode::usage, "calot",
                         std::string("there is no command '") + argv[1] + "' (try: calot --help)");
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    std::string name = "calot";
    for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
      at = at->get_subcommands().front();
      name += " " + at->get_name();
    }
    return apps::endWith(apps::ExitCode::usage, "calot", std::string(e.what()) + " (try: " + name + " --help)");
  }
  recorder::useComplianceCache(recorder::userCacheFolder());
  recorder::useEngines(apps::enginePlaces());
  return apps::runProgram("calot", run);
}
