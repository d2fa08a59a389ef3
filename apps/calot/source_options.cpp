// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/source_options.h"

#include <fmt/format.h>
#include <cstdlib>
#include <utility>

#include "apps/calot/environment.h"
#include "recorder/base/counted.h"
#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/sources/devices/open_device.h"
#include "recorder/sources/devices/scope_device.h"
#include "recorder/sources/kinematics_source.h"
#include "recorder/sources/performer.h"
#include "recorder/sources/performer_profile.h"
#include "recorder/sources/scope/scope_source.h"
#ifdef CALOT_BULLET
#include "sim/bullet/bullet_tree.h"
#endif

namespace calot::apps {
void addTools(CLI::App& command, DeviceOptions& options) {
  command.add_option("--tools", options.tools, "names of an OpenIGTLink server's tools: LEFT,RIGHT; - for none")
      ->delimiter(',')
      ->capture_default_str();
}

std::array<std::string, handCount> toolsOf(const DeviceOptions& options) {
  if (options.tools.size() != handCount) throw Error(ErrorKind::invalid, "--tools: two names are expected: LEFT,RIGHT");
  std::array<std::string, handCount> out;
  for (std::size_t h = 0; h < handCount; ++h) out[h] = options.tools[h] == "-" ? "" : options.tools[h];
  return out;
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

void printDevice(recorder::SampleSource& source) {
  const auto* device = source.device();
  if (device == nullptr) return;
  const recorder::DeviceCounts& counts = device->counts();
  fmt::print("{}: {}, {} invalid, gone {}\n", device->provenance().device, recorder::counted(counts.samples, "sample"),
             counts.invalid, recorder::counted(counts.losses, "time"));
  for (const std::string& line : counts.told) fmt::print("  {}\n", line);
  const std::array<recorder::ForceStatistics, handCount> forces = device->forceStatistics();
  for (std::size_t h = 0; h < handCount; ++h) {
    const recorder::ForceStatistics& s = forces[h];
    if (s.sent == 0) continue;
    fmt::print(
        "  force on the {} hand: {} wrenches, at most {:.2f} N, changes of at most {:.3f} N, {} softened to stay "
        "passive, round trip at most {:.1f} ms\n",
        handNames[h], s.sent, s.maxForce, s.maxChange, s.softened, 1e-6 * static_cast<double>(s.maxRoundTrip));
  }
}

namespace {

/// Opens the device, takes its calibration, waits for its first samples.
/// @throws Error: invalid, for names, and for an assessment without calibration; refused, for a calibration that is not
/// to be used; damaged, for files; failure, where the device is not there or says nothing.
std::unique_ptr<recorder::DeviceSource> makeDeviceSource(const DeviceOptions& options, const SceneDescription& scene,
                                                         recorder::Mode mode) {
  constexpr double patience = 10.0;  // s
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
  source->waitForFirst(patience, &stopRequested());
  return source;
}

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
    throw Error(ErrorKind::invalid, "--scope-device: one device is expected, without left= and right=");
}

std::unique_ptr<recorder::SampleSource> withScope(std::unique_ptr<recorder::SampleSource> source,
                                                  const ScopeOptions& options, const SceneDescription& scene,
                                                  const recorder::ScopeSkill& assistant, std::uint64_t seed) {
  const recorder::Endoscope endoscope(scene, degree * *options.optic);
  return std::make_unique<recorder::ScopeSource>(std::move(source), endoscope,
                                                 driverOf(options, endoscope, assistant, seed));
}

void addSource(CLI::App& command, SourceOptions& options) {
  auto* source = command.add_option_group("source", "who acts");
  source->add_option("--performer", options.performer,
                     "profile of a synthetic operator: skilled, intermediate, unskilled, or a file");
  source->add_option("--kinematics", options.kinematics, "two-handed motion file, 76 columns at 30 Hz");
  source->add_option("--device", options.device.name, recorder::deviceUsage() + " (list them: calot devices)");
  source->require_option(1);
  addTools(command, options.device);
  command.add_option("--calibration", options.device.calibration, "of the device; an assessment needs one");
  addScope(command, options.scope);
}

std::unique_ptr<recorder::SampleSource> makeSource(const SourceOptions& options, const SceneDescription& scene,
                                                   std::uint64_t seed) {
  std::unique_ptr<recorder::SampleSource> source;
  recorder::ScopeSkill assistant;
  refuseScope(options.scope);
  if (!options.device.name.empty()) {
    source = makeDeviceSource(options.device, scene, options.mode);
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

void addStationKey(CLI::App& command, std::string& file) {
  command.add_option("--station-key", file, "key file to sign with (calot station init); default: CALOT_STATION_KEY");
}

std::optional<recorder::StationKey> stationKeyOf(const std::string& file) {
  const char* set = std::getenv("CALOT_STATION_KEY");
  const std::string name = file.empty() && set != nullptr ? set : file;
  if (name.empty()) return std::nullopt;
  return recorder::readStationKey(name);
}

std::string stationOf(const std::string& named, const std::optional<recorder::StationKey>& key) {
  if (!key) return named;
  if (!named.empty() && named != key->station)
    throw Error(ErrorKind::invalid, fmt::format("--station {}: the key is that of station {}", named, key->station));
  return key->station;
}

CLI::Option* addBroadPhase(CLI::App& command, std::string& name) {
  return command
      .add_option("--broad-phase", name,
                  "finds pairs that may touch: by the program's own grid, or by Bullet's trees; the result is the same")
      ->check(CLI::IsMember({"grid", "bullet"}))
      ->capture_default_str();
}

MakeBroadPhase broadPhaseOf(const std::string& name) {
  if (name == "grid") return nullptr;
#ifdef CALOT_BULLET
  return &BulletTree::make;
#else
  throw Error(ErrorKind::invalid, "--broad-phase bullet: this program was built without Bullet");
#endif
}

}  // namespace calot::apps
