// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/device_options.h"

#include <fmt/format.h>

#include <utility>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/sources/scope/scope_source.h"

namespace calot::apps {
namespace {
constexpr double patience = 10.0;  // s
}

void addTools(CLI::App& command, DeviceOptions& options) {
  command.add_option("--tools", options.tools, "names of an OpenIGTLink server's tools: LEFT,RIGHT; - for none")
      ->delimiter(',')
      ->capture_default_str();
}

std::array<std::string, handCount> toolsOf(const DeviceOptions& options) {
  if (options.tools.size() != handCount) throw Error(ErrorKind::invalid, "--tools: two names are wanted: LEFT,RIGHT");
  std::array<std::string, handCount> out;
  for (std::size_t h = 0; h < handCount; ++h) out[h] = options.tools[h] == "-" ? "" : options.tools[h];
  return out;
}

std::unique_ptr<recorder::DeviceSource> makeDeviceSource(const DeviceOptions& options, const SceneDescription& scene,
                                                         recorder::Mode mode, const std::atomic<bool>* stop) {
  if (mode == recorder::Mode::assessment && options.calibration.empty()) {
    throw Error(ErrorKind::invalid,
                "--device: an assessment needs --calibration (calot devices calibrate measures one)");
  }
  recorder::DeviceSourceSettings settings;
  settings.mode = mode;
  if (!options.calibration.empty()) settings.calibration = recorder::readCalibration(options.calibration);
  recorder::OpenedDevice opened =
      recorder::openDevice(options.name, toolsOf(options), settings.calibration ? &*settings.calibration : nullptr);
  settings.tickClock = opened.tickClock;
  if (settings.calibration) {
    recorder::checkCalibration(*settings.calibration, opened.device->info(), mode, recorder::presentDate(),
                               options.calibration);
  }
  auto source = std::make_unique<recorder::DeviceSource>(std::move(opened.device), scene, std::move(settings));
  source->waitForFirst(patience, stop);
  return source;
}

void driveDevice(recorder::SampleSource& source, recorder::RunSettings& run) {
  if (const auto* const scope = source.scope(); scope != nullptr) run.paced = run.paced || scope->realTime();
  auto* device = source.device();
  if (device == nullptr) return;
  const recorder::DeviceCapabilities& can = device->deviceInfo().capabilities;
  run.paced = run.paced || can.realTime;
  if (can.actuated == 0) return;
  run.feedback = [device](const recorder::TickOutcome& tick) {
    std::array<recorder::Wrench, handCount> wrench;
    for (std::size_t h = 0; h < handCount; ++h) wrench[h] = {tick.hand[h].force, tick.hand[h].torque};
    device->feedback(wrench);
  };
}

void recordDevice(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick) {
  if (auto* device = source.device(); device != nullptr) writer.takeRawSamples(device->rawSamples(), firstTick);
}

void tellDevice(recorder::SampleSource& source) {
  const auto* device = source.device();
  if (device == nullptr) return;
  const recorder::DeviceCounts& counts = device->counts();
  fmt::print("{}: {} samples, {} invalid, gone {} times\n", device->provenance().device, counts.samples, counts.invalid,
             counts.losses);
  for (const std::string& line : counts.told) fmt::print("  {}\n", line);
  for (const std::string& line : device->deviceReport()) fmt::print("  {}\n", line);
}

}  // namespace calot::apps
