// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/scope_options.h"

#include <utility>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/open_device.h"
#include "recorder/sources/devices/scope_device.h"
#include "recorder/sources/scope/scope_assistant.h"
#include "recorder/sources/scope/scope_source.h"

namespace calot::apps {
namespace {

constexpr double maxOpticDegrees = 70.0;
constexpr double degree = recorder::Endoscope::maxOptic / maxOpticDegrees;

std::unique_ptr<recorder::ScopeDriver> driverOf(const ScopeOptions& options, const recorder::Endoscope& endoscope,
                                                const recorder::ScopeSkill& assistant, std::uint64_t seed) {
  if (!options.device.empty()) {
    return std::make_unique<recorder::ScopeDevice>(
        recorder::openDevice(options.device, {"", "ScopeTool"}, nullptr, Hand::right), *options.optic <= 0.0);
  }
  if (options.keys) return std::make_unique<recorder::ScopeKeys>(options.keys);
  return std::make_unique<recorder::ScopeAssistant>(endoscope, assistant, seed);
}

}  // namespace

void addScope(CLI::App& command, ScopeOptions& options) {
  command
      .add_option("--scope", options.optic,
                  "the endoscope moves: degrees between its shaft and its view, 0 or 30 as a rule")
      ->check(CLI::Range(0.0, maxOpticDegrees));
  command.add_option("--scope-device", options.device,
                     "device that holds the endoscope, as for --device; without one, an assistant follows the "
                     "instruments");
}

void refuseScope(const ScopeOptions& options) {
  if (options.device.empty()) return;
  if (!options.moves())
    throw Error(ErrorKind::invalid, "--scope-device: the endoscope is fixed; --scope 0 or --scope 30 lets it move");
  if (recorder::isCombination(options.device))
    throw Error(ErrorKind::invalid, "--scope-device: one device is wanted, without left= and right=");
}

std::unique_ptr<recorder::SampleSource> withScope(std::unique_ptr<recorder::SampleSource> source,
                                                  const ScopeOptions& options, const SceneDescription& scene,
                                                  const recorder::ScopeSkill& assistant, std::uint64_t seed) {
  const recorder::Endoscope endoscope(scene, degree * *options.optic);
  return std::make_unique<recorder::ScopeSource>(std::move(source), endoscope,
                                                 driverOf(options, endoscope, assistant, seed));
}

}  // namespace calot::apps
