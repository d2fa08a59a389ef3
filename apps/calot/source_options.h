// SPDX-License-Identifier: GPL-3.0-or-later
// Who acts: options that every command with a source of its own has.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "apps/calot/device_options.h"
#include "apps/calot/scope_options.h"
#include "recorder/sources/source.h"
#include "sim/scene/description.h"

namespace calot::apps {

struct SourceOptions {
  std::string performer, kinematics;
  DeviceOptions device;
  ScopeOptions scope;
  recorder::Mode mode = recorder::Mode::practice;  ///< what a device may be used for
};

/// Adds the group of options of which one must be given. @param options outlives the parsing.
CLI::Option_group* addSource(CLI::App& command, SourceOptions& options);

/// Opens what was chosen. @param seed of a performer. @throws Error
std::unique_ptr<recorder::SampleSource> makeSource(const SourceOptions& options, const SceneDescription& scene,
                                                   std::uint64_t seed);

}  // namespace calot::apps
