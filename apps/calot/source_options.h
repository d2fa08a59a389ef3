// SPDX-License-Identifier: GPL-3.0-or-later
// Who acts: options that every command with a source of its own has.
// A device as the source of an attempt: the options of every command that takes one.
// An endoscope that moves: the options of every command with a source of its own.
// The station that records: its name and its key.
#pragma once

#include <array>
#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/loop.h"
#include "recorder/recording/station_key.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/open_device.h"
#include "recorder/sources/devices/window_input.h"
#include "recorder/sources/scope/scope_source.h"
#include "recorder/sources/source.h"
#include "sim/contact/broad_phase.h"
#include "sim/scene/description.h"

namespace calot::apps {

struct DeviceOptions {
  std::string name, calibration;
  std::vector<std::string> tools{"LeftTool", "RightTool"};
};

/// --tools, which commands share. @param options outlives the parsing.
void addTools(CLI::App& command, DeviceOptions& options);

/// Left and right; "-" stands for none. @throws Error (invalid) unless there are two.
std::array<std::string, handCount> toolsOf(const DeviceOptions& options);

/// If the source is a device: runs it at the pace of the clock if it lives in real time, and gives its motors
/// the forces. @param source outlives the run.
void driveDevice(recorder::SampleSource& source, recorder::RunSettings& run);

/// If the source is a device: its raw samples go into the recording. @param firstTick as
/// RecordingWriter::takeRawSamples. Source and writer outlive the run.
void recordDevice(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick = 0);

/// If the source is a device: prints its counts on stdout.
void printDevice(recorder::SampleSource& source);

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

struct SourceOptions {
  std::string performer, kinematics;
  DeviceOptions device;
  ScopeOptions scope;
  recorder::Mode mode = recorder::Mode::practice;  ///< what a device may be used for
};

/// Adds the group of options of which one must be given. @param options outlives the parsing.
void addSource(CLI::App& command, SourceOptions& options);

/// Opens what was chosen. @param seed of a performer. @throws Error
std::unique_ptr<recorder::SampleSource> makeSource(const SourceOptions& options, const SceneDescription& scene,
                                                   std::uint64_t seed);

/// Adds --station-key. @param file outlives the parsing.
void addStationKey(CLI::App& command, std::string& file);

/// The key of the option, or else of the environment (CALOT_STATION_KEY); none where neither names a file.
/// @throws Error as recorder::readStationKey
std::optional<recorder::StationKey> stationKeyOf(const std::string& file);

/// The station that a recording names. @throws Error (invalid) where the key is another station's.
std::string stationOf(const std::string& named, const std::optional<recorder::StationKey>& key);

/// `--broad-phase grid|bullet`: which broad phase computes the steps. Recordings and results are the same bits.
CLI::Option* addBroadPhase(CLI::App& command, std::string& name);

/// @param name as the option has it @return null: SortedGrid
/// @throws Error (invalid) where this build has no Bullet
MakeBroadPhase broadPhaseOf(const std::string& name);

}  // namespace calot::apps
