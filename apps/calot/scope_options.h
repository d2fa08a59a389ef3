// SPDX-License-Identifier: GPL-3.0-or-later
// An endoscope that moves: the options of every command with a source of its own.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "recorder/sources/devices/window_input.h"
#include "recorder/sources/scope/scope_skill.h"
#include "recorder/sources/source.h"
#include "sim/scene/description.h"

namespace calot::apps {

struct ScopeOptions {
  std::optional<double> optic;  ///< degrees between shaft and view; none: the camera is fixed
  std::string device;           ///< that holds the endoscope; empty: keys, or an assistant who follows
  std::shared_ptr<recorder::ScopeInput> keys = nullptr;  ///< of a window; null: there is none

  [[nodiscard]] bool moves() const { return optic.has_value(); }
};

/// --scope and --scope-device. @param options outlives the parsing.
void addScope(CLI::App& command, ScopeOptions& options);

/// @throws Error (invalid) where a device is to hold an endoscope that is fixed
void refuseScope(const ScopeOptions& options);

/// The source's hands, and the endoscope: held by the device, else by the keys of a window, else by an assistant who
/// follows the instruments. @param seed of the assistant @pre options.moves() @throws Error as openDevice
std::unique_ptr<recorder::SampleSource> withScope(std::unique_ptr<recorder::SampleSource> source,
                                                  const ScopeOptions& options, const SceneDescription& scene,
                                                  const recorder::ScopeSkill& assistant, std::uint64_t seed);

}  // namespace calot::apps
