// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/source_options.h"

#include <utility>

#include "apps/calot/environment.h"
#include "apps/calot/stop_request.h"
#include "recorder/sources/kinematics_source.h"
#include "recorder/sources/performer.h"
#include "recorder/sources/performer_profile.h"

namespace calot::apps {

CLI::Option_group* addSource(CLI::App& command, SourceOptions& options) {
  auto* source = command.add_option_group("source", "who acts");
  source->add_option("--performer", options.performer,
                     "profile of a synthetic operator: skilled, intermediate, unskilled, or a file");
  source->add_option("--kinematics", options.kinematics, "two-handed motion file, 76 columns at 30 Hz");
  source->add_option("--device", options.device.name, recorder::deviceUsage() + " (list them: calot devices)");
  source->require_option(1);
  addTools(command, options.device);
  command.add_option("--calibration", options.device.calibration, "of the device; an assessment needs one");
  addScope(command, options.scope);
  return source;
}

std::unique_ptr<recorder::SampleSource> makeSource(const SourceOptions& options, const SceneDescription& scene,
                                                   std::uint64_t seed) {
  std::unique_ptr<recorder::SampleSource> source;
  recorder::ScopeSkill assistant;
  refuseScope(options.scope);
  if (!options.device.name.empty()) {
    source = makeDeviceSource(options.device, scene, options.mode, &stopRequested());
  } else if (!options.kinematics.empty()) {
    source = std::make_unique<recorder::KinematicsSource>(options.kinematics, scene);
  } else {
    const recorder::PerformerProfile profile =
        recorder::loadPerformer(recorder::findPerformer(options.performer, assetFolders()));
    source = recorder::makePerformer(profile, scene, seed);
    assistant = profile.scope;
  }
  return options.scope.moves() ? withScope(std::move(source), options.scope, scene, assistant, seed)
                               : std::move(source);
}

}  // namespace calot::apps
